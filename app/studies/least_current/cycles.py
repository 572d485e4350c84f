"""Load cycles with a run current, on the axis or on its twin; lost steps are mended after each."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

import numpy as np

from ...clock import Clock
from ...devices.core.capabilities import PositionFromEncoder
from ...devices.core.device import Device
from ..document import LeastCurrent, StudyDocument
from ..moves import MeasuredMoves, MoveFigures, worst_of
from ..record import Figures, Held, Trial
from ..search import Asked, Told
from ..set_once import Apply, apply_to
from ..twins.on_twin import OnTwin
from .cool_search import CHANNELS, Cycled
from .cycle import Cycle
from .plan import Ground, look

NAME = "run current scale"
BAND_FULLSTEPS = 2.0


class LoadCycles:
    """Does load cycles with the registers that it is told."""

    def __init__(self, device: Device, axis: int, clock: Clock, ground: Ground, seed: int, apply: Apply) -> None:
        self._device, self._axis, self._clock, self._ground, self._apply = device, axis, clock, ground, apply
        self._random = random.Random(seed)
        beside = [] if ground.cool is None else [f"{name}.{axis}" for name in CHANNELS]
        self.moves = MeasuredMoves(device, axis, clock, ground.full_step, BAND_FULLSTEPS, beside)
        self.before: Sequence[Held] = [*ground.current.before, *ground.space.before]
        """What goes back before lost steps are mended."""
        self.ran: Callable[[], None] = lambda: None
        """Called after each cycle."""
        self.left: Callable[[float, float], None] = lambda _left_s, _done: None
        """Told how long many cycles take yet, with the gentler ones that follow [s], and which share is done."""
        self.mark: Callable[[str], None] = lambda _: None
        """Told what begins now."""
        self.spent: Callable[[], bool] = lambda: False
        """Whether the budget is used up."""

    async def once(self, cycle: Cycle) -> Cycled:
        """There and back from a place of the electrical period that is drawn anew. Lost steps are mended."""
        ground = self._ground
        begin = ground.start + cycle.way * self._random.randrange(ground.period)
        moves: list[MoveFigures] = []
        beside = []
        try:
            await self.moves.go(begin)
            for target in (begin + cycle.distance, begin):
                moves.append(await self.moves.measured(target))
                if self.moves.last is not None:
                    beside.append(self.moves.last.beside)
                if moves[-1].lost_fullsteps:
                    break
        finally:
            self.ran()
        held = not any(move.lost_fullsteps for move in moves)
        if not held:
            await self._mend()
        rows = np.concatenate(beside)
        moving = rows[np.isfinite(rows).all(axis=1) & (rows[:, 0] != 0)] if ground.cool is not None else rows
        return Cycled(held, 1, worst_of(moves) or 0.0, moving)

    async def some(self, registers: Sequence[Held], words: str, count: int, cycle: Cycle) -> Cycled:
        """So many with those registers; it ends with the first that loses a step, or with the budget."""
        await self._apply(registers, words)
        self.mark(words)
        seen, began_s, cycles = list[Cycled](), self._clock.now(), self._ground.cycles
        before = cycles.index(cycle) * count if cycle in cycles else 0
        every = count * len(cycles) if cycle in cycles else count
        while len(seen) < count and not self.spent():
            seen.append(await self.once(cycle))
            if not seen[-1].held:
                break
            if count > 1:
                done = before + len(seen)
                self.left((self._clock.now() - began_s) / len(seen) * (every - done), done / every)
        return Cycled(
            len(seen) == count and all(one.held for one in seen),
            len(seen),
            max((one.worst for one in seen), default=0.0),
            np.concatenate([one.beside for one in seen]) if seen else np.empty((0, len(CHANNELS))),
        )

    async def at(self, scale: int, count: int, cycle: Cycle) -> Cycled:
        """So many at a run current scale."""
        registers = [*self._ground.scaled(scale), *self._ground.ramp(cycle)]
        return await self.some(registers, f"run current {scale + 1}/32", count, cycle)

    async def _mend(self) -> None:
        self.mark("steps lost: the position is taken from the encoder")
        await self._apply(self.before, "current and ramp before the study")
        await self._device.need(PositionFromEncoder).position_from_encoder(self._axis)
        await self.moves.go(self._ground.start)


async def _on_twin(device: Device, axis: int, clock: Clock, document: StudyDocument, asked: Asked) -> Trial:
    """A run current scale, by the hardest of the load cycles."""
    wanted = document.wanted(LeastCurrent)
    ground = (await look(device, axis, wanted)).required()
    load = LoadCycles(device, axis, clock, ground, document.seed + asked.number, apply_to(device))
    await load.moves.fall_into_step(ground.start, ground.cycle.way)
    scale = round(asked.values[NAME])
    seen = await load.at(scale, wanted.repeats, ground.cycles[0])
    return Trial(
        number=asked.number,
        setting={NAME: float(scale)},
        registers=ground.scaled(scale),
        state="feasible" if seen.held else "infeasible",
        figures=Figures(deviation_fullsteps=seen.worst, runs=seen.done),
        why="" if seen.held else "steps lost",
    )


def _told(_document: StudyDocument, trial: Trial) -> Told:
    return Told([trial.setting[NAME] + 1], -1.0 if trial.state == "feasible" else 1.0)


ON_TWIN = OnTwin(_on_twin, _told)
