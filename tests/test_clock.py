"""The clock that tests own, and the one that an emulator's time scale turns."""

from __future__ import annotations

import asyncio

import pytest

from app.clock import ScaledClock, VirtualClock, WallClock


async def test_sleepers_wake_in_order_and_at_their_own_time() -> None:
    clock = VirtualClock()
    woke: list[tuple[str, float]] = []

    async def sleeper(name: str, seconds: float) -> None:
        await clock.sleep(seconds)
        woke.append((name, clock.now()))

    tasks = [asyncio.create_task(sleeper("late", 2.0)), asyncio.create_task(sleeper("early", 1.0))]
    await clock.advance(1.5)
    assert woke == [("early", 1.0)]
    await clock.advance(0.5)
    assert woke == [("early", 1.0), ("late", 2.0)]
    await asyncio.gather(*tasks)


async def test_a_task_that_sleeps_again_wakes_within_one_advance() -> None:
    clock = VirtualClock()
    beats: list[float] = []

    async def beat() -> None:
        for _ in range(10):
            await clock.sleep(0.1)
            beats.append(round(clock.now(), 9))

    task = asyncio.create_task(beat())
    await clock.advance(1.0)
    await task
    assert beats == [round(0.1 * n, 9) for n in range(1, 11)]


def test_time_does_not_go_back() -> None:
    clock = VirtualClock(5.0)
    with pytest.raises(ValueError, match="back"):
        clock.set(4.0)


def test_a_time_scale_changes_the_pace_and_never_jumps() -> None:
    base = VirtualClock()
    clock = ScaledClock(base)
    base.set(1.0)
    clock.scale = 10.0
    assert clock.now() == pytest.approx(1.0)
    base.set(2.0)
    assert clock.now() == pytest.approx(11.0)
    clock.scale = 0.0
    base.set(100.0)
    assert clock.now() == pytest.approx(11.0)
    with pytest.raises(ValueError, match=r"0\.\.1000"):
        clock.scale = -1.0


def test_a_moment_of_the_base_clock_is_one_moment_of_the_scaled_one() -> None:
    """Also shortly before the latest change of scale: a sample that fell due then keeps its time."""
    base = VirtualClock()
    clock = ScaledClock(base, scale=2.0)
    base.set(10.0)
    clock.scale = 5.0
    base.set(12.0)
    assert clock.at(9.0) == pytest.approx(18.0)
    assert clock.at(10.0) == pytest.approx(20.0)
    assert clock.at(11.0) == pytest.approx(25.0)
    assert clock.now() == clock.at(12.0)


def test_the_wall_clock_runs() -> None:
    clock = WallClock()
    first = clock.now()
    while clock.now() == first:
        pass
    assert clock.now() > first
