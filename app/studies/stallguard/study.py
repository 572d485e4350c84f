"""The study itself: find the stop, measure, choose, prove on runs that the choice has not seen."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Literal

import numpy as np

from ...clock import WallClock
from ...number_text import plain
from ...procedures.procedure import Failed
from ..document import StallGuard
from ..pieces import Pieces
from ..proof import LEVEL, rate_bound
from ..ramp_settings import ACCELERATION, SPEED
from ..ramp_settings import UNITS as RAMP_UNITS
from ..rate_proof import rate_proof
from ..record import Figures, Held, Trial
from ..run import StudyRun
from .choice import Choice, Measured, Run, alone, choices, roc
from .found import Rate, RocPoint, StallAlone, StallFound, StallOwn, StallSpeed
from .plan import MEASURED_FREE, MEASURED_STOPS, ROOM_FULLSTEPS, Ground, look
from .runs import Samples, StallRuns
from .scale import Scale
from .setting import ARMED as ARMED_FROM
from .setting import FILTER, THRESHOLD, UNITS, StallSetting

ARMED = 0.9
"""Share of the least speed from which on a stall stops the motor: a ramp's end is not cut off."""
INSIDE = (60.0, 400.0)
"""Where a free run's least value is to lie as it is measured [counts]: further down or up values may be cut."""
PROBES = 10
PROBE_STEP = 12
"""Thresholds from one look at where the values lie to the next."""
SLOPE_STEP = 6
SLOPE = (0.5, 40.0)
"""What one more of a threshold may add to a load value [counts]: anything else is no StallGuard2 that follows it."""
BINS = 24
JITTER = 4.0
"""Runs into the stop begin somewhere within so many full steps: an electrical period."""
AT_SPEED_FULLSTEPS = 60.0
"""So far at its speed before the stop."""
TOO_NEAR = "between here and the stop it does not get up to this speed: begin further away from it"
Wrong = Literal["", "false", "missed"]
KeptRun = tuple[list[float], list[float]]
At = tuple[StallSpeed, Measured]
"""A speed in the record, and what was measured there."""


class BudgetEnded(Failed):
    """The budget ended before the study did."""


@dataclass(frozen=True, slots=True)
class StallPiece:
    """What was whole at one speed when the study was cut off: measured runs, at a threshold, or, with a `setting`, the
    held-out runs of that."""

    speed_pps: float
    threshold: int = 0
    free: Sequence[KeptRun] = ()
    stops: Sequence[KeptRun] = ()
    setting: StallSetting | None = None
    missed: Rate | None = None
    false: Rate | None = None
    wrong: Wrong = ""


class StallGuardStudy(StudyRun):
    """Finds the threshold, the filter and the least speed by which StallGuard tells a stall from a free run."""

    _ground: Ground
    _runs: StallRuns
    _stop_at: int
    _scale: Scale
    _on_disk: Pieces[StallPiece]
    _earlier: list[StallPiece]
    """Pieces from before it was cut off that have not been taken up yet."""
    _tried: dict[tuple[float, StallSetting], tuple[Rate, Rate, Wrong]]
    """Missed stalls and false ones of what was tried on held-out runs, by the speed [pps] and the setting."""

    @property
    def wanted(self) -> StallGuard:
        return self.record.document.wanted(StallGuard)

    @property
    def found(self) -> StallFound:
        """What of it stands in the record."""
        assert self.record.stallguard is not None
        return self.record.stallguard

    async def _study(self) -> None:
        record, wanted = self.record, self.wanted
        ground = self._ground = await self.looked(look, wanted)
        self._scale = ground.stall.scale
        self._runs = StallRuns(self.device, self.axis, self.clock, ground.full_step, ground.way)
        self._runs.runs, self._runs.way_fullsteps = record.runs, record.way_fullsteps
        self._on_disk = Pieces(self.keeper.folder, StallPiece, aside=isinstance(self.clock, WallClock))
        self._earlier, self._tried = self._on_disk.read(), {}
        self._random = random.Random(record.document.seed)
        if not record.baseline:
            record.baseline = [*ground.ramp.before, *ground.stall.before]
            record.baseline_setting = ground.stall.told(ground.stall.now())
        record.units = dict(UNITS)
        record.stallguard = record.stallguard or StallFound(
            generation=ground.stall.scale.generation,
            run_fullsteps=wanted.run_fullsteps,
            push_fullsteps=wanted.push_fullsteps,
            speeds=[
                StallSpeed(speed_rps=rps, speed_pps=pps)
                for rps, pps in zip(wanted.speeds_rps, ground.speeds_pps, strict=True)
            ],
        )
        if self.found.slope:
            self._scale = replace(self._scale, slope=self.found.slope)
        await self.keeper.save(record)
        await self._find_stop()
        measured = await self._measure()
        await self._choose(measured)
        await self.back()
        await self._runs.back_to(ground.start)
        await self._on_disk.forget()

    def _taken_up(self, speed_pps: float, setting: StallSetting | None) -> StallPiece | None:
        """The first piece of that from before it was cut off; None where there is none, or none any more."""
        for piece in self._earlier:
            if (piece.speed_pps, piece.setting) == (speed_pps, setting):
                self._earlier.remove(piece)
                return piece
        return None

    def _count(self) -> None:
        """Tell how much it has moved. Raises Failed where that is more than it may."""
        self.record.runs, self.record.way_fullsteps = self._runs.runs, self._runs.way_fullsteps
        budget = self.record.document.budget
        if self.since_s > budget.time_s:
            raise BudgetEnded(f"the budget of {budget.time_s:g} s ended before anything was proved: give it more")
        if budget.distance_fullsteps is not None and self._runs.way_fullsteps > budget.distance_fullsteps:
            way = f"{budget.distance_fullsteps:g} full steps"
            raise BudgetEnded(f"the budget of {way} ended before anything was proved: give it more")

    # --- where the stop is ------------------------------------------------------------------------

    async def _find_stop(self) -> None:
        ground = self._ground
        self.tell("look", 0.0, "looking for the stop")
        self.keeper.mark("looking for the stop")
        await self._set(ground.find_pps, StallSetting(self._scale.low, filtered=False, armed_pps=ground.find_pps))
        # A rotor that stood beside its field when it was switched on falls into step with the first move.
        await self._runs.back_to(ground.start + ground.way * round(JITTER) * ground.full_step)
        await self._runs.back_to(ground.start)
        await self._runs.begin()
        at = await self._runs.find_stop(ground.limit)
        if at is None:
            raise Failed(f"nothing held the motor as far as {ground.limit}: the stop is elsewhere, or gives way")
        self._stop_at = self.found.stop_at = at
        if abs(at - ground.start) < 2 * ROOM_FULLSTEPS * ground.full_step:
            raise Failed(f"the stop at {at} is too near to where it began: begin a turn or more away from it")
        await self._runs.back_to(self._near)
        await self._runs.mend()
        await self._runs.back_to(ground.start)

    @property
    def _near(self) -> int:
        """Where free runs end before the stop."""
        return self._stop_at - self._ground.way * round(ROOM_FULLSTEPS * self._ground.full_step)

    def _approach(self, speed_pps: float) -> int | None:
        """Where a run into the stop begins, drawn anew; None where there is too little room to get up to speed."""
        ground = self._ground
        up = speed_pps**2 / (2 * ground.acceleration_pps2) + AT_SPEED_FULLSTEPS * ground.full_step
        jitter = self._random.uniform(0, JITTER) * ground.full_step
        begin = self._stop_at - ground.way * round(up + jitter)
        return begin if ground.way * (begin - ground.start) >= 0 else None

    def _behind(self, speed_pps: float) -> int:
        """As far as a run into the stop goes: so far at its speed, and what it takes to brake as hard as it can."""
        ground = self._ground
        brake = speed_pps**2 / (2 * ground.ramp.most(ACCELERATION))
        return self._stop_at + ground.way * round(self.wanted.push_fullsteps * ground.full_step + brake)

    async def _set(self, speed_pps: float, setting: StallSetting, *, stops: bool = False, hard: bool = False) -> None:
        """Hard : brake as fast as the chip can, for a run that ends behind the stop."""
        ground = self._ground
        ramp = {SPEED: speed_pps}
        # What is not the speed stays as it was before, whatever the run before this one has braked with.
        whole = {**{each.name: each for each in ground.ramp.before}, **_named(ground.ramp.registers(ramp))}
        if hard:
            whole |= _named(ground.ramp.braking_hard({**ground.ramp.now(), **ramp}))
        words = f"threshold {setting.threshold}, {plain(speed_pps)} {RAMP_UNITS[SPEED]}"
        await self.apply([*whole.values(), *ground.stall.registers(setting, stops=stops)], words)

    # --- measuring --------------------------------------------------------------------------------

    async def _measure(self) -> list[Measured]:
        measured = []
        speeds = self.found.speeds
        threshold = 0
        for index, one in enumerate(speeds):
            part, one.why = 0.05 + 0.4 * index / len(speeds), ""
            if self._approach(one.speed_pps) is None:
                one.why = TOO_NEAR
                continue
            kept = self._taken_up(one.speed_pps, None)
            if kept is not None:
                free, stops = ([_run(run) for run in runs] for runs in (kept.free, kept.stops))
                threshold = kept.threshold
                measured.append(self._seen(one, free, stops))
                continue
            self.tell("search", part, f"free runs at {plain(one.speed_rps)} turns/s")
            self.keeper.mark(f"free runs at {plain(one.speed_rps)} turns/s")
            free, threshold = await self._free_runs(one, threshold)
            if await self._runs.mend():
                one.why = "it loses steps at this speed with nothing in the way"
                await self._slowly_home()
                continue
            if sum(run.least(ARMED * one.speed_pps, filtered=False) is not None for run in free) < 2:
                one.why = TOO_NEAR
                continue
            self.tell("search", part + 0.2 / len(speeds), f"into the stop at {plain(one.speed_rps)} turns/s")
            self.keeper.mark(f"into the stop at {plain(one.speed_rps)} turns/s")
            stops = await self._stop_runs(one, threshold)
            await self._on_disk.add(
                StallPiece(one.speed_pps, threshold, [_kept(run) for run in free], [_kept(run) for run in stops])
            )
            measured.append(self._seen(one, free, stops))
            await self.keeper.save(self.record)
        self.found.slope = self._scale.slope
        return measured

    def _seen(self, one: StallSpeed, free: list[Run], stops: list[Run]) -> Measured:
        """What was measured at a speed, in the record as well."""
        of = Measured(one.speed_rps, one.speed_pps, free, stops)
        self._show(one, of, filtered=False)
        suits = alone(of, self._scale, ARMED, self.wanted.rate_max)
        one.alone = None if suits is None else StallAlone(level=self._scale.level(suits.threshold), **asdict(suits))
        return of

    async def _slowly_home(self) -> None:
        """After steps were lost at a speed that is too much: it is at rest, and the encoder has told where."""
        ground = self._ground
        await self._set(ground.find_pps, StallSetting(self._scale.low, filtered=False, armed_pps=ground.find_pps))
        await self._runs.back_to(ground.start)
        await self._runs.mend()

    async def _free_runs(self, one: StallSpeed, threshold: int) -> tuple[list[Run], int]:
        """Free runs at a threshold at which the values lie inside their range, and that threshold."""
        if self._scale.generation == 4:
            return await self._passes(one, 0, MEASURED_FREE), 0
        for _ in range(PROBES):
            least = self._least(await self._passes(one, threshold, 1), one, threshold)
            moved = threshold
            if not INSIDE[0] <= least <= INSIDE[1]:
                moved = self._scale.stricter(threshold, PROBE_STEP if least < INSIDE[0] else -PROBE_STEP)
            if moved == threshold:
                break
            threshold = moved
        if not self.found.slope:
            await self._find_slope(one, threshold)
        for _ in range(PROBES):
            runs = await self._passes(one, threshold, MEASURED_FREE)
            moved = self._scale.stricter(threshold, PROBE_STEP)
            if self._least(runs, one, threshold) > 0 or moved == threshold:
                break
            threshold = moved
        return runs, threshold

    def _least(self, runs: list[Run], one: StallSpeed, threshold: int) -> float:
        """The least load value of some runs at speed, as the chip told it at that threshold."""
        least = min(
            (value for run in runs if (value := run.least(ARMED * one.speed_pps, False)) is not None), default=0
        )
        return least - float(self._scale.at_zero(np.zeros(1), threshold)[0])

    async def _find_slope(self, one: StallSpeed, threshold: int) -> None:
        """What one more of the threshold adds to a value: by two thresholds at one speed."""
        other = self._scale.stricter(threshold, SLOPE_STEP)
        if other == threshold:
            other = self._scale.stricter(threshold, -SLOPE_STEP)
        self._scale = replace(self._scale, slope=0.0)
        means = []
        for each in (threshold, other, threshold, other):
            runs = await self._passes(one, each, 2)
            values = np.concatenate([run.values[run.speeds_pps >= ARMED * one.speed_pps] for run in runs])
            means.append(float(values.mean()))
        slope = (means[1] + means[3] - means[0] - means[2]) / 2 / (other - threshold)
        if not SLOPE[0] <= slope <= SLOPE[1]:
            raise Failed(
                f"the load value goes from {means[0]:.0f} to {means[1]:.0f} as the threshold goes from {threshold} to "
                f"{other}: StallGuard2 does not measure here. See whether the motor turns with SpreadCycle"
            )
        self._scale = replace(self._scale, slope=slope)
        self.found.slope = slope

    async def _passes(self, one: StallSpeed, threshold: int, count: int) -> list[Run]:
        """At least `count` free runs: pieces of ways between here and the stop."""
        ground, runs = self._ground, list[Run]()
        await self._set(one.speed_pps, StallSetting(threshold, filtered=False, armed_pps=ARMED * one.speed_pps))
        piece = self.wanted.run_fullsteps * ground.full_step
        for index in range(2 * count):
            self._count()
            samples = await self._runs.measured(self._near if index % 2 == 0 else ground.start, one.speed_pps)
            runs += self._pieces(samples, piece, threshold)
            if len(runs) >= count and index % 2:
                break
        return runs[: max(count, 2)] if count > 2 else runs

    def _pieces(self, samples: Samples, piece: float, threshold: int) -> list[Run]:
        way = np.abs(samples.position - samples.position[0])
        count = max(1, int(way[-1] / piece))
        at = np.minimum((way / piece).astype(int), count - 1)
        values = self._scale.at_zero(samples.load, threshold)
        return [Run(values[at == index], samples.speed_pps[at == index]) for index in range(count)]

    async def _stop_runs(self, one: StallSpeed, threshold: int) -> list[Run]:
        """Runs into the stop while no stall stops the motor, at a threshold at which the values are not cut at 0."""
        threshold = self._scale.stricter(threshold, PROBE_STEP) if self._scale.generation == 2 else 0
        runs: list[Run] = []
        probes = 0
        while len(runs) < MEASURED_STOPS:
            begin = self._approach(one.speed_pps)
            assert begin is not None
            await self._set(one.speed_pps, StallSetting(threshold, filtered=False, armed_pps=one.speed_pps), hard=True)
            while len(runs) < MEASURED_STOPS:
                self._count()
                await self._runs.back_to(begin)
                samples = await self._runs.measured(self._behind(one.speed_pps), one.speed_pps)
                await self._runs.back_to(begin)
                await self._runs.mend()
                begin = self._approach(one.speed_pps)
                assert begin is not None
                inside = (self._ground.way * (samples.position - self._stop_at) >= 0) & (
                    samples.speed_pps >= ARMED * one.speed_pps
                )
                load = samples.load[inside]
                if not len(load):
                    raise Failed(
                        f"not one load value came within {self.wanted.push_fullsteps:g} full steps of the stop"
                    )
                moved = self._scale.stricter(threshold, PROBE_STEP)
                cut = self._scale.generation == 2 and load.min() <= 0 and moved != threshold
                if cut and probes < PROBES:
                    threshold, probes, runs = moved, probes + 1, []
                    break
                runs.append(Run(self._scale.at_zero(load, threshold), samples.speed_pps[inside]))
        return runs

    def _show(self, one: StallSpeed, of: Measured, *, filtered: bool) -> None:
        """The distributions and the ROC of a speed, for whoever looks."""
        free, stops = of.least(ARMED * of.speed_pps, filtered)
        one.free, one.stops = [round(float(value), 1) for value in free], [round(float(value), 1) for value in stops]
        one.roc = [RocPoint(level=level, false=false, missed=missed) for level, false, missed in roc(free, stops)]
        values = [
            np.concatenate([run.values[run.speeds_pps >= ARMED * of.speed_pps] for run in runs])
            for runs in (of.free, of.stops)
        ]
        both = np.concatenate(values)
        edges = np.linspace(both.min(), max(both.max(), both.min() + 1), BINS + 1)
        one.values = [round(float(edge), 1) for edge in edges]
        one.free_share, one.stop_share = (
            [float(share) for share in np.histogram(each, edges)[0] / max(1, len(each))] for each in values
        )

    # --- choosing and proving ---------------------------------------------------------------------

    async def _choose(self, measured: list[Measured]) -> None:
        record, each = self.record, self.wanted.each_speed and len(measured) > 1
        record.trials, record.best = [], None
        for one in self.found.speeds:
            one.own = None
        pairs = self._of(measured)
        choice = await self._holding(pairs, (0.45, 0.7 if each else 0.95))
        if choice is not None:
            record.best = record.trials[-1].number
            proved, left = _parted(pairs, choice)
            before = await self._before(proved)
            await self._own(left)
            self._decide(choice, proved, before)
            return
        record.improved = False
        for one, of in pairs:
            one.why = self._why(one, of)
        reasons = [f"{plain(one.speed_rps)} turns/s: {one.why}" for one in self.found.speeds if one.why]
        record.verdict = f"no threshold does it here: {'; '.join(reasons)}"
        record.next = "another speed, more current, less acceleration, or a switch"

    def _of(self, measured: list[Measured]) -> list[At]:
        speeds = {one.speed_pps: one for one in self.found.speeds}
        return [(speeds[of.speed_pps], of) for of in measured]

    def _why(self, one: StallSpeed, of: Measured) -> str:
        """Why no threshold does it at one speed."""
        if not list(choices([of], self._scale, ARMED, self.wanted.rate_max)):
            return (
                f"load values of {len(of.free)} free runs and of {len(of.stops)} stalls overlap so far that any "
                f"threshold gets more than {plain(100 * self.wanted.rate_max)} % of one of them wrong"
            )
        return one.why

    async def _holding(self, pairs: Sequence[At], part: tuple[float, float]) -> Choice | None:
        """The first choice that holds, at as many of these speeds as one can. part : of its progress, from and to"""
        tried = 0
        for first in choices([of for _, of in pairs], self._scale, ARMED, self.wanted.rate_max):
            choice: Choice | None = first
            while choice is not None:
                begin, end = (part[0] + (part[1] - part[0]) * min(1.0, count / 8) for count in (tried, tried + 1))
                setting = StallSetting(choice.threshold, choice.filtered, ARMED * pairs[choice.first][1].speed_pps)
                wrong = await self._prove(pairs[choice.first : choice.last + 1], setting, (begin, end))
                if not wrong:
                    return choice
                choice, tried = choice.without(false=wrong == "false"), tried + 1
        return None

    async def _prove(self, pairs: Sequence[At], setting: StallSetting, part: tuple[float, float]) -> Wrong:
        """Try a setting on held-out runs at these speeds: what it gets wrong too often; empty where nothing."""
        record = self.record
        for one, _ in pairs:
            known = self._tried.get((one.speed_pps, setting))
            if known is not None and known[2]:
                one.missed, one.false, wrong = known
                one.why = f"threshold {setting.threshold}: {_wrong_told(one, wrong)}"
                return wrong
        trial = Trial(
            number=len(record.trials),
            setting=self._ground.stall.told(setting),
            registers=self._ground.stall.registers(setting, stops=None),
            state="failed",
            figures=Figures(),
            at_s=round(self.since_s, 3),
        )
        self.keeper.mark(f"proof of threshold {setting.threshold}")
        record.trials.append(trial)
        for index, (one, of) in enumerate(pairs):
            self.tell(
                "proof",
                part[0] + (part[1] - part[0]) * index / len(pairs),
                f"threshold {setting.threshold} at {plain(one.speed_rps)} turns/s",
            )
            self._show(one, of, filtered=setting.filtered)
            one.missed, one.false, wrong = await self._held_out(one, setting)
            trial.figures.runs += one.missed.runs + one.false.runs
            if wrong:
                trial.state, trial.why = "infeasible", _wrong_told(one, wrong)
                one.why = f"threshold {setting.threshold}: {trial.why}"
                await self.keeper.save(record)
                return wrong
            one.why = ""
            await self.keeper.save(record)
        trial.state = "feasible"
        return ""

    async def _held_out(self, one: StallSpeed, setting: StallSetting) -> tuple[Rate, Rate, Wrong]:
        """Missed stalls and false ones of a setting at one speed, and which of them is too often; those from before it
        was cut off where they are whole.

        Its runs are made once: what is tried until it passes is proved by nothing.
        """
        key = one.speed_pps, setting
        if key not in self._tried:
            kept = self._taken_up(*key)
            if kept is not None and kept.missed is not None and kept.false is not None:
                self._tried[key] = kept.missed, kept.false, kept.wrong
            else:
                missed, false, wrong = self._tried[key] = await self._run_held_out(one, setting)
                await self._on_disk.add(
                    StallPiece(one.speed_pps, setting=setting, missed=missed, false=false, wrong=wrong)
                )
        return self._tried[key]

    async def _run_held_out(self, one: StallSpeed, setting: StallSetting) -> tuple[Rate, Rate, Wrong]:
        """Missed stalls and false ones of a setting at one speed, the motor stopping by them, and which of them is too
        often; ended where that is known."""
        ground, wanted = self._ground, self.wanted
        for_stops, for_free = (rate_proof(runs, wanted.rate_max) for runs in (wanted.stops, wanted.free_runs))
        missed = stops = false = 0
        free = 0.0

        def rates(wrong: Wrong) -> tuple[Rate, Rate, Wrong]:
            return _rate(missed, stops, for_stops.level), _rate(false, int(free), for_free.level), wrong

        await self._set(one.speed_pps, setting, stops=True)
        while for_stops.shown(missed, stops) is None:
            self._count()
            begin = self._approach(one.speed_pps)
            assert begin is not None
            false += await self._runs.armed(begin)
            # A run that ends behind the stop brakes hard; a free one as its ramp does, or the load value would tell it.
            await self._set(one.speed_pps, setting, stops=True, hard=True)
            lost, before = await self._runs.into_stop(self._behind(one.speed_pps), self._stop_at)
            await self._set(one.speed_pps, setting, stops=True)
            stops, missed, false = stops + 1, missed + lost, false + before
            false += await self._runs.armed(begin)
            free += 2 * AT_SPEED_FULLSTEPS / wanted.run_fullsteps
            await self._runs.mend()
            if for_free.shown(false, 0) is False:
                return rates("false")
        if not for_stops.shown(missed, stops):
            return rates("missed")
        piece = wanted.run_fullsteps * ground.full_step
        false += await self._runs.armed(ground.start)
        a_pass = max(1, int(abs(self._near - ground.start) / piece))
        while for_free.shown(false, int(free)) is None:
            self._count()
            for target in (self._near, ground.start):
                false += await self._runs.armed(target)
                free += a_pass
        return rates("" if for_free.shown(false, int(free)) else "false")

    async def _before(self, proved: Sequence[StallSpeed]) -> str:
        """The same runs by the setting before; why it could not do any, empty where it could."""
        in_the_way = self._ground.stall.in_the_way()
        if in_the_way:
            return in_the_way[0]
        setting = self._ground.stall.now()
        for one in proved:
            self.tell("proof", self.record.progress, f"the setting before at {plain(one.speed_rps)} turns/s")
            one.missed_before, one.false_before, _ = await self._held_out(one, setting)
        return ""

    async def _own(self, left: Sequence[At]) -> None:
        """Prove, at each speed at which the choice does not do it, a threshold that does it there."""
        for one, _ in left:
            one.why = one.why or "not with a threshold that does it at the others"
        if not self.wanted.each_speed:
            return
        for index, (one, of) in enumerate(left):
            why = one.why
            begin, end = (0.7 + 0.25 * count / len(left) for count in (index, index + 1))
            # What a wider span has proved here, and not at another of its speeds, is proved here.
            tried = self._tried.items()
            known = [setting for (pps, setting), (*_, wrong) in tried if pps == of.speed_pps and not wrong]
            try:
                holds = (
                    not await self._prove([(one, of)], known[0], (begin, end))
                    if known
                    else await self._holding([(one, of)], (begin, end)) is not None
                )
            except BudgetEnded:
                one.why = why
                for late, _ in left[index:]:
                    late.why += ", and the budget ended before one of its own was proved"
                return
            if not holds:
                one.why = f"no threshold does it here: {self._why(one, of)}"
                continue
            trial = self.record.trials[-1]
            threshold = round(trial.setting[THRESHOLD])
            one.why = why
            one.own = StallOwn(
                threshold=threshold,
                filtered=bool(trial.setting[FILTER]),
                level=self._scale.level(threshold),
                from_pps=trial.setting[ARMED_FROM],
                trial=trial.number,
            )

    def _decide(self, choice: Choice, proved: list[StallSpeed], before: str) -> None:
        """Whether the choice is better than the setting before, which had the same runs to do.

        before : why that could not do any
        """
        record, found = self.record, self.found
        found.level, found.filtered = self._scale.level(choice.threshold), choice.filtered
        found.from_rps, found.to_rps = proved[0].speed_rps, proved[-1].speed_rps
        slowest, fastest = plain(found.from_rps), plain(found.to_rps)
        words = (
            f"threshold {choice.threshold}{' with the filter' if choice.filtered else ''} tells a stall "
            f"{f'at {slowest}' if slowest == fastest else f'from {slowest} to {fastest}'} turns/s: "
            f"{_told(proved, 'false')}, {_told(proved, 'missed')}"
        )
        above = [one for one in found.speeds if one.speed_rps > proved[-1].speed_rps]
        if above:
            record.next = (
                f"it is armed above {plain(found.to_rps)} turns/s too: no moves faster than that while stalls stop it"
            )
        else:
            record.next = (
                "home by it, or let a stall stop the motor (sg_stop, which stays as it is); more runs bound the rates "
                "closer: 366 without a wrong one show less than 1 %, and then some wrong ones are made up for by more"
            )
        worse = [what for what in ("false", "missed") if not before and _fewer(proved, what)]
        record.improved = bool(before or worse)
        if before:
            record.verdict = f"{words}; as it was set before it could not ({before})"
        elif worse:
            record.verdict = f"{words}; before: {_told(proved, 'false_before')}, {_told(proved, 'missed_before')}"
        else:
            record.verdict = "the setting before does as well in as many runs: it stays as it is"
        for one in found.speeds:
            record.verdict += _own_told(one)


def _parted(pairs: list[At], choice: Choice) -> tuple[list[StallSpeed], list[At]]:
    """The speeds at which a choice does it, and the others."""
    own = pairs[: choice.first] + pairs[choice.last + 1 :]
    return [one for one, _ in pairs[choice.first : choice.last + 1]], own


def _own_told(one: StallSpeed) -> str:
    """What a verdict says of a speed at which the choice does not do it; empty where it does."""
    if one.own is None:
        return f"; at {plain(one.speed_rps)} turns/s: {one.why}" if one.why else ""
    return (
        f"; at {plain(one.speed_rps)} turns/s threshold {one.own.threshold}"
        f"{' with the filter' if one.own.filtered else ''}: {_told([one], 'false')}, {_told([one], 'missed')}"
    )


def _wrong_told(one: StallSpeed, wrong: Wrong) -> str:
    rate = one.false if wrong == "false" else one.missed
    assert rate is not None
    return f"{rate.wrong} of {rate.runs} stalls {wrong} at {plain(one.speed_rps)} turns/s"


def _kept(run: Run) -> KeptRun:
    return run.values.tolist(), run.speeds_pps.tolist()


def _run(kept: KeptRun) -> Run:
    values, speeds_pps = kept
    return Run(np.array(values, dtype=float), np.array(speeds_pps, dtype=float))


def _named(registers: list[Held]) -> dict[str, Held]:
    return {each.name: each for each in registers}


def _rate(wrong: int, runs: int, level: float = LEVEL) -> Rate:
    wrong = min(wrong, runs)
    return Rate(wrong=wrong, runs=runs, most=rate_bound(wrong, runs, level))


def _sum(speeds: list[StallSpeed], name: str) -> Rate:
    rates: list[Rate] = [getattr(one, name) for one in speeds]
    return _rate(sum(rate.wrong for rate in rates), sum(rate.runs for rate in rates))


def _told(speeds: list[StallSpeed], name: str) -> str:
    rate = _sum(speeds, name)
    word = "stalls missed" if name.startswith("missed") else "free runs stopped"
    most = max(getattr(one, name).most for one in speeds)
    return f"{rate.wrong} of {rate.runs} {word} (below {100 * most:.2g} % at each speed)"


def _fewer(speeds: list[StallSpeed], name: str) -> bool:
    """Whether fewer went wrong than before: Fisher's exact test, one-sided, 5 %."""
    from scipy import stats

    now, before = _sum(speeds, name), _sum(speeds, f"{name}_before")
    table = [[now.wrong, now.runs - now.wrong], [before.wrong, before.runs - before.wrong]]
    return before.wrong > 0 and bool(stats.fisher_exact(table, alternative="less").pvalue < LEVEL)
