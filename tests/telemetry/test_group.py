from __future__ import annotations

import random

import numpy as np
import pytest

from app.telemetry.frames import FloatArray, decode
from app.telemetry.group import Group, Subscription
from app.telemetry.reader import Reader, Status
from app.telemetry.sampling import Block


def rows(reader: Reader) -> tuple[FloatArray, FloatArray]:
    frames = []
    while (data := reader.take(0.0)) is not None:
        frames.append(decode(data))
    if not frames:
        return np.empty(0), np.empty((0, reader.columns))
    return np.concatenate([f.time_s for f in frames]), np.concatenate([f.columns.T for f in frames])


def group_of(*channels: str, rate_hz: float, batch_hz: float = 60.0) -> tuple[Group, Reader]:
    group = Group(Subscription(channels, rate_hz, batch_hz), 0.0)
    reader = Reader(len(channels), 100_000)
    group.readers.append(reader)
    return group, reader


def block(first: int, count: int, sampled_hz: float) -> Block:
    time_s = np.arange(first, first + count) / sampled_hz
    return Block(first, time_s, np.column_stack([time_s, time_s + 100, time_s + 200]))


@pytest.mark.parametrize(
    ("rate_hz", "sampled_hz"), [(300, 1000), (1, 1000), (999, 1000), (50, 60), (1000, 1000), (7, 7)]
)
def test_decimation_is_exact_in_the_long_run_whatever_the_blocks(rate_hz: float, sampled_hz: float) -> None:
    group, reader = group_of("b", rate_hz=rate_hz)
    group.follow(("a", "b", "c"), sampled_hz)
    seconds, first = 20, 0
    blocks = random.Random(428)
    while first < seconds * sampled_hz:
        count = min(blocks.randrange(40), round(seconds * sampled_hz) - first)
        group.offer(block(first, count, sampled_hz), 0.0)
        first += count
    group.flush(0.0, at_once=True)
    time_s, samples = rows(reader)
    assert len(time_s) == seconds * rate_hz
    assert np.all(np.diff(time_s) > 0)
    assert np.diff(time_s).max() <= 1 / rate_hz + 1 / sampled_hz + 1e-9
    np.testing.assert_array_equal(samples[:, 0], time_s + 100)


def test_columns_come_in_the_order_asked_for() -> None:
    group, reader = group_of("c", "a", rate_hz=10)
    group.follow(("a", "b", "c"), 10)
    group.offer(block(0, 3, 10), 0.0)
    group.flush(0.0, at_once=True)
    time_s, samples = rows(reader)
    np.testing.assert_array_equal(samples, np.column_stack([time_s + 200, time_s]))


def test_frames_are_no_more_than_asked_for() -> None:
    group, reader = group_of("a", rate_hz=1000, batch_hz=10)
    group.follow(("a", "b", "c"), 1000)
    for beat in range(60):
        group.offer(block(beat * 17, 17, 1000), 0.0)
        group.flush((beat + 1) / 60)
    frames = 0
    while reader.take(0.0) is not None:
        frames += 1
    assert frames == 10


def test_readers_of_one_subscription_share_the_bytes() -> None:
    group, first = group_of("a", rate_hz=10)
    second = Reader(1, 100)
    group.readers.append(second)
    group.follow(("a", "b", "c"), 10)
    group.offer(block(0, 3, 10), 0.0)
    group.flush(0.0, at_once=True)
    assert first._bodies[0] is second._bodies[0]


def test_a_status_comes_once_a_second_and_tells_rate_and_jitter() -> None:
    group, reader = group_of("a", rate_hz=100)
    group.follow(("a", "b", "c"), 100)
    shaken = block(0, 100, 100)
    shaken.time_s[1::2] += 1e-3
    group.offer(shaken, 0.0)
    group.report(0.5)
    assert reader.take_events() == []
    group.report(1.0)
    (status,) = reader.take_events()
    assert isinstance(status, Status)
    assert status.achieved_rate_hz == 100
    assert status.jitter_ms == pytest.approx(1.0, rel=0.02)
    group.report(2.0)
    (status,) = reader.take_events()
    assert isinstance(status, Status)
    assert (status.achieved_rate_hz, status.jitter_ms) == (0, 0)


def test_a_gap_is_a_row_of_nan_after_the_last_sample() -> None:
    group, reader = group_of("a", "b", rate_hz=10)
    group.follow(("a", "b", "c"), 10)
    group.offer(block(0, 3, 10), 0.0)
    group.gap(0.25, 0.25)
    group.flush(0.0, at_once=True)
    time_s, samples = rows(reader)
    assert time_s[-1] == 0.25
    assert np.isnan(samples[-1]).all()
    assert not np.isnan(samples[:-1]).any()
