from __future__ import annotations

import asyncio
from collections.abc import Callable

import numpy as np

from app.telemetry.frames import decode
from app.telemetry.reader import Body, Gap, MoveSeen, Reader, Status


def body(first: int, rows: int, oldest_s: float = 0.0) -> Body:
    time_s = np.arange(first, first + rows, dtype=float)
    return Body(time_s, time_s[:, None], oldest_s)


def test_a_slow_reader_loses_the_oldest_rows_and_they_are_counted() -> None:
    reader = Reader(columns=1, rows_max=100)
    for first in range(0, 1000, 10):
        reader.push(body(first, 10))
    assert reader.dropped == 900
    frames = []
    while (data := reader.take(0.0)) is not None:
        frames.append(decode(data))
    assert frames[0].time_s[0] == 900
    assert frames[-1].time_s[-1] == 999
    assert [frame.sequence for frame in frames] == list(range(10))
    assert {frame.dropped for frame in frames} == {900}


def test_one_body_longer_than_the_queue_is_kept_whole() -> None:
    reader = Reader(columns=1, rows_max=5)
    reader.push(body(0, 50))
    assert reader.dropped == 0
    reader.push(body(50, 1))
    assert reader.dropped == 50


def test_of_statuses_the_latest_wins_and_of_events_the_oldest_go() -> None:
    reader = Reader(columns=1, rows_max=5)
    for number in range(100):
        reader.tell(Status(float(number), 0.0, 0, 0.0))
        reader.tell(MoveSeen(0, float(number)))
    events = reader.take_events()
    assert events[-1] == Status(99.0, 0.0, 0, 0.0)
    assert [event.started_at_s for event in events if isinstance(event, MoveSeen)] == [float(n) for n in range(36, 100)]
    assert reader.take_events() == []


async def test_waiting_ends_for_rows_events_and_the_end() -> None:
    reader = Reader(columns=1, rows_max=5)
    wakes: list[Callable[[], None]] = [
        lambda: reader.push(body(0, 1)),
        lambda: reader.tell(Gap("gone")),
        lambda: reader.close("bye"),
    ]
    for wake in wakes:
        waiting = asyncio.ensure_future(reader.wait())
        await asyncio.sleep(0)
        assert not waiting.done()
        wake()
        await waiting
    assert reader.closed == "bye"


def test_the_latency_is_that_of_the_oldest_row_in_the_worst_frame() -> None:
    reader = Reader(columns=1, rows_max=50)
    reader.push(body(0, 1, oldest_s=10.0))
    reader.push(body(1, 1, oldest_s=10.5))
    reader.take(10.6)
    reader.take(10.6)
    assert round(reader.latency_s, 6) == 0.6


def test_a_reader_in_this_process_takes_the_rows_as_they_are() -> None:
    reader = Reader(columns=1, rows_max=1000)
    shared = body(0, 3)
    reader.push(shared)
    taken = reader.take_rows(1.0)
    assert taken is not None
    assert taken.time_s is shared.time_s
    assert np.shares_memory(taken.columns, shared.samples)
    assert "data" not in vars(shared), "nobody has a socket: nothing is encoded"
    assert reader.latency_s == 1.0
    assert reader.take_rows(1.0) is None
