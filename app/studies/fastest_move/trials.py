"""A setting of the fastest move tried: there and back with it, with its margin first. On the axis, or on its twin."""

from __future__ import annotations

import math
import random
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Literal

from ...clock import Clock
from ...devices.core.capabilities import PositionFromEncoder
from ...devices.core.device import Device
from ...errors import SoftLimit, WrongState
from ...number_text import plain
from ...procedures.procedure import Failed
from ..document import FastestMove, StudyDocument
from ..moves import MeasuredMoves, MoveFigures, Sampled, worst_of
from ..ramp_settings import SPEED, UNITS
from ..record import Figures, Held, MoveCurve, Trial
from ..search import Asked, Told
from ..set_once import Apply, SetOnce, apply_to
from ..switch_edge import SLOW_FULLSTEPS, SwitchEdge
from ..twins.on_twin import OnTwin
from .ranges import Ranges, look, ramps_s

CURVE_POINTS = 120
BEFORE, TRIED = "the setting before the study", "the setting that is tried"
Run = Sequence[MoveFigures]
"""A move by each distance and back, one after the other; up to the one that lost steps."""


class MoveTrials:
    """Moves there and back with a setting; lost steps are mended after each."""

    def __init__(
        self, device: Device, axis: int, clock: Clock, wanted: FastestMove, ranges: Ranges, seed: int, apply: Apply
    ) -> None:
        self._device, self._axis, self._wanted, self._ranges = device, axis, wanted, ranges
        self._apply = SetOnce(apply)
        self._random = random.Random(seed)
        by_switch = ranges.switch is not None
        self.moves = MeasuredMoves(
            device, axis, clock, ranges.microsteps, wanted.band_fullsteps, has_encoder=not by_switch
        )
        self._edge = (
            None
            if ranges.switch is None
            else SwitchEdge(device, axis, clock, ranges.switch, self.moves, ranges.microsteps, ranges.far, self._slowly)
        )
        self._wished: Sequence[Held] = ranges.space.before
        """The setting that is tried."""
        self.there: Sampled | None = None
        """The latest move to the far end, by the greatest distance."""
        self.ran: Callable[[], None] = lambda: None
        """Called after each move there and back."""
        self.losing: Callable[[], None] = lambda: None
        """Called where steps were lost, before that is mended."""

    @property
    def _way(self) -> int:
        return 1 if self._wanted.distance > 0 else -1

    def place(self) -> int:
        """A place of the electrical period, drawn anew [microsteps from where the study began]."""
        return self._random.randrange(self._ranges.period)

    async def begin(self) -> None:
        """The rotor falls into step; then the edge of the switch is found, where one sees lost steps. Raises Failed,
        BenchError."""
        await self.moves.fall_into_step(self._ranges.start, self._way)
        if self._edge is not None:
            await self._edge.learn(self._ranges.near)

    async def once(self, place: int | None = None) -> Run:
        """There and back by each distance, from a place of the electrical period. Raises Failed, BenchError."""
        begin = self._ranges.start + self._way * (self.place() if place is None else place)
        moves: list[MoveFigures] = []
        for distance in self._wanted.every_distance:
            moves += await self._there_and_back(begin, distance)
            if lost(moves):
                break
        self.ran()
        return moves

    async def _there_and_back(self, begin: int, distance: int) -> list[MoveFigures]:
        await self._apply(self._wished, TRIED)
        await self.moves.go(begin)
        there = await self._moved(begin + distance)
        if distance == self._wanted.farthest:
            self.there = self.moves.last
        if there.lost_fullsteps:
            await self._mend()
            return [there]
        if self._edge is not None:
            await self._apply(self._ranges.space.before, BEFORE)
            await self.moves.go(begin + distance)
            await self._apply(self._wished, TRIED)
        back = await self._moved(begin)
        if back.lost_fullsteps:
            await self._mend()
        return [there, back]

    async def _moved(self, target: int) -> MoveFigures:
        """A half of a move, with what the switch tells of it where no encoder does: gone to with the setting before,
        and after each half, for what is lost there and back alike would cancel. Raises Failed, BenchError."""
        if self._edge is None:
            return await self.moves.measured(target)
        failure: Failed | None = None
        try:
            move = await self.moves.measured(target)
        except Failed as error:  # a rotor that runs on, out of step, may meet the switch, which stops the counter
            move, failure = MoveFigures(None, None, 0.0), error
        await self._apply(self._ranges.space.before, BEFORE)
        lost = await self._edge.lost()
        if failure is not None and not lost:
            raise failure
        return replace(move, time_s=None, lost_fullsteps=lost) if lost else move

    async def _mend(self) -> None:
        """The position as the encoder has it, and slowly back to where the study began."""
        self.losing()
        if self._edge is None:
            await self._device.need(PositionFromEncoder).position_from_encoder(self._axis)
        await self.home()

    async def home(self) -> None:
        """With the setting before to where the study began. Raises Failed, BenchError."""
        await self._apply(self._ranges.space.before, BEFORE)
        if self._edge is not None:  # who knows what was lost by what has failed
            await self._edge.lost()
            await self._apply(self._ranges.space.before, BEFORE)
        await self.moves.go(self._ranges.start)

    async def _slowly(self) -> None:
        """Set a ramp that a switch may end at once."""
        now = self._ranges.space.now()
        slow = self._ranges.trapezoid({**now, SPEED: min(now[SPEED], SLOW_FULLSTEPS * self._ranges.microsteps)})
        await self._apply(self._ranges.space.registers(slow), "slowly, into the switch")

    async def set_before(self) -> None:
        """Set the axis as it was before the study. Raises BenchError."""
        self._wished = self._ranges.space.before
        await self._apply(self._wished, BEFORE)

    async def measure(self, setting: Mapping[str, float]) -> Figures:
        """With the margin first: where that loses steps, the rest is not worth a move. Raises Failed, BenchError."""
        if self._wanted.margin:
            figures = await self.stress(setting, self._wanted.repeats)
            if figures.lost_fullsteps:
                return figures
        await self.set(setting)
        # Once shows its time; how far it deviates hangs on where in the electrical period it begins.
        once = self._wanted.margin and not self._wanted.quiet
        return figures_of([await self.once() for _ in range(1 if once else self._wanted.repeats)])

    async def stress(self, setting: Mapping[str, float], repeats: int) -> Figures:
        """As fast as the margin asks; the first lost step ends it. Raises Failed, BenchError."""
        times = 1 + self._wanted.margin
        await self.set({name: value * times for name, value in setting.items()})
        runs = []
        for _ in range(repeats):
            runs.append(await self.once())
            if lost(runs[-1]):
                break
        return figures_of(runs)

    async def set(self, setting: Mapping[str, float]) -> None:
        """Set speed, acceleration and what else makes the ramp. Raises BenchError."""
        self._wished = self._ranges.space.registers(setting)
        await self._apply(self._wished, words_of(setting))


def curve_of(move: Sampled, which: Literal["before", "best", "present"], microsteps: int) -> MoveCurve:
    """A move as it is drawn: at most `CURVE_POINTS` of it. microsteps : of a full step"""
    every = max(1, math.ceil(len(move.time_s) / CURVE_POINTS))
    way = (move.encoder[::every] - move.encoder[0]) / microsteps
    return MoveCurve(
        which=which,
        time_s=[round(float(value), 5) for value in move.time_s[::every]],
        fullsteps=[round(float(value), 3) for value in way],
    )


def words_of(setting: Mapping[str, float]) -> str:
    """A setting for people."""
    return ", ".join(f"{plain(value, 4)} {UNITS[name]}" for name, value in setting.items())


def lost(run: Run) -> bool:
    """Whether a step was lost in it."""
    return any(move.lost_fullsteps for move in run)


def figures_of(runs: Sequence[Run]) -> Figures:
    """Means over runs there and back, the times of several distances added up; the worst of what was lost."""
    moves = [move for run in runs for move in run]
    timed = [[move.time_s for move in run if move.time_s is not None] for run in runs]
    whole = len(moves) > 0 and sum(map(len, timed)) == len(moves)
    # One way by each distance, and the other way.
    sums = [sum(times[side::2]) for times in timed for side in (0, 1)] if whole else []
    pairs = range(0, len(timed[0]), 2) if whole else range(0)
    each = [statistics.fmean(time_s for times in timed for time_s in times[first : first + 2]) for first in pairs]
    return Figures(
        time_s=statistics.fmean(sums) if whole else None,
        spread_s=statistics.stdev(sums) if len(sums) > 2 else None,
        by_distance_s=each if len(each) > 1 else [],
        deviation_fullsteps=worst_of(moves),
        lost_fullsteps=max((move.lost_fullsteps for move in moves), default=0.0),
        runs=len(runs),
    )


def begun(number: int, setting: Mapping[str, float], ranges: Ranges, wanted: FastestMove, at_s: float) -> Trial:
    """The trial of a setting, before it is tried. at_s : since the study began [s]"""
    setting = ranges.space.rounded(setting)
    return Trial(
        number=number,
        setting=setting,
        registers=ranges.space.registers(setting),
        state="pruned",
        figures=Figures(),
        expected_s=ramps_s(wanted, ranges.space, setting),
        at_s=round(at_s, 3),
    )


async def tried(trials: MoveTrials, trial: Trial) -> None:
    """Try it, and write down whether it held. Raises BenchError where the device does not answer."""
    try:
        trial.figures = await trials.measure(trial.setting)
    except (Failed, SoftLimit, WrongState) as error:
        trial.state, trial.why = "failed", str(error)
        return
    figures = trial.figures
    if figures.lost_fullsteps:
        trial.state, trial.why = "infeasible", f"{figures.lost_fullsteps:g} full steps lost"
    elif figures.time_s is None:
        trial.state, trial.why = "infeasible", "it did not settle in its band"
    else:
        trial.state = "feasible"


def told(wanted: FastestMove, trial: Trial) -> Told:
    """What the search is told of a trial that held, or did not."""
    figures = trial.figures
    first = figures.time_s if trial.state == "feasible" else trial.expected_s
    assert first is not None
    values = [first, figures.deviation_fullsteps or 0.0] if wanted.quiet else [first]
    return Told(values, -1.0 if trial.state == "feasible" else figures.lost_fullsteps or 1.0)


async def _on_twin(device: Device, axis: int, clock: Clock, document: StudyDocument, asked: Asked) -> Trial:
    wanted = document.wanted(FastestMove)
    ranges = (await look(device, axis, wanted)).required()
    trials = MoveTrials(device, axis, clock, wanted, ranges, document.seed + asked.number, apply_to(device))
    trial = begun(asked.number, ranges.setting(asked.values), ranges, wanted, 0.0)
    await trials.begin()
    await tried(trials, trial)
    return trial


def _told_of_twin(document: StudyDocument, trial: Trial) -> Told:
    return told(document.wanted(FastestMove), trial)


ON_TWIN = OnTwin(_on_twin, _told_of_twin)
