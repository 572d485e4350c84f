"""The frame log, the incidents and the wire budget: what is kept, what is forgotten, what is counted."""

from __future__ import annotations

import asyncio

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.links.arbiter import NOBODY, Arbiter, Priority
from app.links.frame_log import FrameLog
from app.links.incidents import INCIDENTS_KEPT, Incidents
from app.links.wire_budget import WireBudget
from tests.links.gate import settle


def add(log: FrameLog, frames: int, start_s: float = 0.0) -> None:
    first = log.next
    tx = [(first + n).to_bytes(4, "big") for n in range(frames)]
    log.add(Priority.SAMPLE, start_s, tx, tx, [0.001 * (n + 1) for n in range(frames)])


@given(st.lists(st.integers(0, 40), max_size=12), st.integers(0, 300), st.integers(1, 50))
def test_a_page_is_what_is_left_of_what_was_asked_for(batches: list[int], after: int, limit: int) -> None:
    log = FrameLog(kept=100)
    for frames in batches:
        add(log, frames)
    total = sum(batches)
    oldest = max(0, total - 100)
    page = log.page(after, limit)
    expected = list(range(max(after, oldest), total))[:limit]
    assert [entry.seq for entry in page.frames] == expected
    assert [int.from_bytes(entry.tx, "big") for entry in page.frames] == expected
    assert page.lost == max(0, oldest - after)
    assert page.next == (expected[-1] + 1 if expected else max(oldest, min(after, total)))
    assert len(log) == min(total, 100)


def test_reading_on_from_next_misses_nothing_and_repeats_nothing() -> None:
    log = FrameLog(kept=100)
    seen: list[int] = []
    after = 0
    for frames in (30, 0, 70, 1, 99):
        add(log, frames)
        while (page := log.page(after, 40)).frames:
            seen += [entry.seq for entry in page.frames]
            after = page.next
            assert page.lost == 0
    assert seen == list(range(200))


def test_times_of_a_batch_are_those_of_its_frames() -> None:
    log = FrameLog()
    log.add(Priority.COMMAND, 100.0, [b"a", b"b"], [b"x", b""], [0.25, 1.0], "no reply")
    first, second = log.page().frames
    assert (first.time_unix_s, first.took_s, first.error) == (100.0, 0.25, "")
    assert (second.time_unix_s, second.took_s, second.error) == (100.25, 0.75, "no reply")


def test_incidents_are_forgotten_and_still_counted() -> None:
    incidents = Incidents()
    for number in range(INCIDENTS_KEPT + 50):
        incidents.add("timeout", str(number))
    assert [incident.text for incident in incidents.list()] == [str(n) for n in range(50, INCIDENTS_KEPT + 50)]
    assert incidents.counts == {"timeout": INCIDENTS_KEPT + 50}


def test_the_budget_of_a_wire() -> None:
    now_s = 0.0
    wire = WireBudget(9600, 18, lambda: now_s)
    assert wire.calls_per_s_possible == pytest.approx(53.33, abs=0.01)
    assert wire.calls_per_s == 0
    for _ in range(40):
        now_s += 0.1
        wire.count(4, 0.1)
    assert wire.calls_per_s == pytest.approx(40)
    assert wire.share == pytest.approx(0.75)
    now_s += 3
    assert wire.calls_per_s == 0
    wire.count(100, 0.1)  # more than fits through the wire: then it is none
    assert wire.calls_per_s_possible is None
    assert wire.share is None
    assert WireBudget(None, 18).calls_per_s_possible is None


async def test_giving_way_to_somebody_who_has_gone() -> None:
    """The flag may be a moment old: whoever gives way for nobody gets the line straight back."""
    arbiter = Arbiter()
    assert arbiter.take_if_idle()
    urgent = asyncio.create_task(arbiter.wait(Priority.STOP))
    await settle()
    assert arbiter.most_urgent == Priority.STOP
    urgent.cancel()  # has not run yet, so the flag still stands
    await asyncio.wait_for(arbiter.give_way(Priority.SAMPLE), 1)
    busy = [arbiter.busy]
    assert arbiter.most_urgent == NOBODY
    arbiter.release()
    busy.append(arbiter.busy)
    await asyncio.gather(urgent, return_exceptions=True)
    assert [*busy, arbiter.busy] == [True, False, False]
