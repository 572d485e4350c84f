"""What is done in the background lets what is urgent go first, and comes all the same."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator

from app.clock import HELD_MAX_S, TURN_S, BackgroundClock, VirtualClock

BEAT_S = 0.02


class Sleepers:
    """Ten that beat together; `takes_s` passes on the clock with each beat."""

    def __init__(self, clock: VirtualClock, background: BackgroundClock, takes_s: float = 0.0) -> None:
        self.beats = 0
        self.most_in_a_turn = 0
        self._in_turn = 0
        self._clock, self._background, self._takes_s = clock, background, takes_s

    async def beat(self) -> None:
        while True:
            await self._background.sleep(BEAT_S)
            self.beats += 1
            if self._in_turn == 0:
                asyncio.get_running_loop().call_soon(self._end_turn)
            self._in_turn += 1
            self.most_in_a_turn = max(self.most_in_a_turn, self._in_turn)
            self._clock.set(self._clock.now() + self._takes_s)

    def _end_turn(self) -> None:
        self._in_turn = 0

    @contextlib.contextmanager
    def running(self) -> Iterator[None]:
        tasks = [asyncio.create_task(self.beat()) for _ in range(10)]
        try:
            yield
        finally:
            for task in tasks:
                task.cancel()


async def test_sleepers_come_in_time_where_nothing_is_urgent() -> None:
    clock = VirtualClock()
    background = BackgroundClock(clock)
    sleepers = Sleepers(clock, background)
    with sleepers.running():
        await clock.advance(10 * BEAT_S + 1e-6)
    assert sleepers.beats == 100


async def test_nobody_comes_while_something_is_urgent_and_all_do_behind_it() -> None:
    clock = VirtualClock()
    background = BackgroundClock(clock)
    sleepers = Sleepers(clock, background)
    with sleepers.running():
        with background.urgent():
            with background.urgent():
                await clock.advance(2 * BEAT_S)
            await clock.advance(BEAT_S)
            assert sleepers.beats == 0
        await clock.advance(0)
        assert sleepers.beats == 10


async def test_what_is_urgent_for_ever_holds_nobody_back_for_ever() -> None:
    clock = VirtualClock()
    background = BackgroundClock(clock)
    sleepers = Sleepers(clock, background)
    with sleepers.running(), background.urgent():
        await clock.advance(HELD_MAX_S / 2)
        assert sleepers.beats == 0
        await clock.advance(1.0)
        assert sleepers.beats >= 10 * int(1.0 / (BEAT_S + HELD_MAX_S))


async def test_stops_without_a_pause_hold_nobody_back_for_ever() -> None:
    clock = VirtualClock()
    background = BackgroundClock(clock)
    sleepers = Sleepers(clock, background)
    with sleepers.running(), contextlib.ExitStack() as first:
        urgent = first
        urgent.enter_context(background.urgent())
        for _ in range(1000):
            following = contextlib.ExitStack()
            following.enter_context(background.urgent())
            urgent.close()
            urgent = following
            await clock.advance(1e-3)
        urgent.close()
    assert sleepers.beats >= 10 * int(1.0 / (BEAT_S + HELD_MAX_S))


async def test_work_that_takes_long_leaves_turns_of_the_loop_to_others() -> None:
    clock = VirtualClock()
    background = BackgroundClock(clock)
    sleepers = Sleepers(clock, background, takes_s=TURN_S / 2)
    with sleepers.running():
        clock.set(1.0)  # all of them late at once
        await clock.advance(BEAT_S)
        for _ in range(40):
            await asyncio.sleep(0)
    assert sleepers.beats >= 10
    assert sleepers.most_in_a_turn <= 3


async def test_a_sleeper_that_is_cancelled_is_in_nobodys_way() -> None:
    clock = VirtualClock()
    background = BackgroundClock(clock)
    with background.urgent():
        gone, stays = (asyncio.create_task(background.sleep(BEAT_S)) for _ in range(2))
        await clock.advance(BEAT_S)
        gone.cancel()
    await clock.advance(0)
    assert stays.done()


async def test_who_does_not_sleep_asks_for_a_turn() -> None:
    clock = VirtualClock()
    background = BackgroundClock(clock)
    with background.urgent():
        waits = asyncio.create_task(background.turn())
        await clock.advance(HELD_MAX_S / 2)
        assert not waits.done()
    await clock.advance(0)
    assert waits.done()
    await background.turn()
