"""The study itself: ways there and back at many speeds, with the setting as it is and with changes of it in turn."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...calc.signals.order_spectrum import order_spectrum
from ...clock import WallClock
from ...devices.core.capabilities import PositionFromEncoder
from ...number_text import plain
from ...procedures.procedure import Failed
from ..document import ResonanceMap
from ..fitted import estimate
from ..moves import PERIOD_FULLSTEPS, MeasuredMoves, Sampled
from ..pieces import Pieces
from ..proof import is_better, paired_effect
from ..ramp_settings import ACCELERATION, SPEED
from ..record import Figures, Finding, Held, Trial
from ..run import StudyRun
from .found import Change, ResonanceFound
from .measured import ORDERS, AtSpeed, Way, compared, mapped, resonance, tell
from .plan import COMPARED_EVERY, CROSSINGS, FINER, FINER_ORDERS, SCALE, Ground, Setting, look

RATE_HZ = 1000.0
MAP_TAKES = 0.4
"""Share of the time, where changes are compared too."""
LOST_MOST = 12
"""So often are lost steps mended: more, and something else is wrong."""
APART = 0.01
"""Speeds no further apart are one."""


class ResonanceMapStudy(StudyRun):
    """Runs, fits, compares, and puts the setting back."""

    _ground: Ground
    _moves: MeasuredMoves
    _pieces: Pieces[AtSpeed]
    _made: dict[float, AtSpeed]
    """Speeds of the map that were whole before it was cut off."""

    @property
    def wanted(self) -> ResonanceMap:
        """What is asked for."""
        return self.record.document.wanted(ResonanceMap)

    @property
    def found(self) -> ResonanceFound:
        """What of it stands in the record."""
        assert self.record.resonances is not None
        return self.record.resonances

    async def _study(self) -> None:
        record = self.record
        ground = self._ground = await self.looked(look, self.wanted)
        self._apart = 0.0
        self._moves = MeasuredMoves(self.device, self.axis, self.clock, ground.full_step, band_fullsteps=1.0)
        self._mended = 0
        self._moves.way_fullsteps = record.way_fullsteps
        record.best, record.findings, record.improved = None, [], None
        self._pieces = Pieces(self.keeper.folder, AtSpeed, aside=isinstance(self.clock, WallClock))
        if not record.baseline:
            record.baseline = ground.before
        record.resonances = record.resonances or ResonanceFound(orders=sorted(ORDERS))
        await self.keeper.save(record)
        self._touched = True
        await self._moves.fall_into_step(ground.start)
        self._apart = await self._moves.deviation()
        await self._map()
        await self._changes()
        await self._home()
        await self.back()
        self._judge()
        await self._pieces.forget()

    # --- runs -------------------------------------------------------------------------------------

    async def _there_and_back(self, at: AtSpeed, setting: Sequence[Held]) -> None:
        """Once more at this speed. Steps that are lost are mended; a run with them is none."""
        ground, start = self._ground, self._ground.start
        ramp = ground.space.registers({SPEED: at.speed_rps * ground.turn, ACCELERATION: ground.ramp[ACCELERATION]})
        await self.apply([*setting, *ramp], f"{plain(at.speed_rps, 3)} turns/s")
        lead, cruise = ground.lead(at.speed_rps), ground.cruise(at.speed_rps)
        ways: list[Way] = []
        for target, forward in ((round(start + 2 * lead + cruise), True), (start, False)):
            found = await self._moves.sampled(target, RATE_HZ)
            self.record.runs += 1
            self.record.way_fullsteps = self._moves.way_fullsteps
            if abs(found.deviation - self._apart) > PERIOD_FULLSTEPS / 2 * ground.full_step:
                at.lost += 1
                await self._mend()
                return
            ways.append(self._way(found, forward, start + lead, start + lead + cruise))
        there, back = ways
        if there.spectrum.amplitudes and back.spectrum.amplitudes:
            at.pairs.append((there, back))
        else:
            at.blind += 1

    def _way(self, found: Sampled, forward: bool, low: float, high: float) -> Way:
        """What one way shows, turned about where it goes backward. Raises Failed for too few samples."""
        ground = self._ground
        counts = np.isfinite(found.encoder) & (found.position >= low) & (found.position < high)
        time_s, position = found.time_s[counts], found.position[counts]
        rad = 2 * math.pi / (4 * ground.full_step) * (1 if forward else -1)
        deviation = (found.encoder[counts] - position) * rad
        try:
            spectrum = order_spectrum(time_s, position * rad, 2 * math.pi * position / ground.turn, deviation, ORDERS)
        except ValueError as error:
            raise Failed(f"the encoder cannot be sampled fast enough: {error}") from error
        hz = float(np.ptp(position) / np.ptp(time_s)) / (4 * ground.full_step)
        return Way(hz, forward, spectrum, float(deviation.mean()), len(time_s))

    async def _mend(self) -> None:
        self.keeper.mark("steps lost: the position is taken from the encoder")
        self._mended += 1
        if self._mended > LOST_MOST:
            raise Failed("it loses steps again and again: more current or a gentler ramp first, or fewer speeds")
        await self.apply(self.record.baseline, "the setting before the study")
        await self.device.need(PositionFromEncoder).position_from_encoder(self.axis)
        await self._moves.go(self._ground.start)
        self._apart = await self._moves.deviation()

    async def _home(self) -> None:
        await self.apply(self.record.baseline, "the setting before the study")
        await self._moves.go(self._ground.start)

    # --- the map ----------------------------------------------------------------------------------

    async def _map(self) -> None:
        """All speeds with the setting as it is, and more around what resonates."""
        self.tell("baseline", 0.0, "the map, with the setting as it is")
        speeds: list[AtSpeed] = []
        self._made = {at.speed_rps: at for at in self._pieces.read()}
        share = MAP_TAKES if self._ground.settings else 0.95
        many = len(self._ground.speeds) + FINER_ORDERS * len(FINER)
        await self._mapped(speeds, self._ground.speeds, share, many)
        tell(self.found, speeds, self._ground.periods)
        finer = self._finer(speeds)
        if finer:
            self.tell("search", self.record.progress, "more speeds around the resonances")
            await self._mapped(speeds, finer, share, len(speeds) + len(finer))
        tell(self.found, speeds, self._ground.periods)
        await self.keeper.save(self.record)

    async def _mapped(self, speeds: list[AtSpeed], more: Sequence[float], share: float, many: int) -> None:
        for speed in more:
            if speed in self._made:  # before it was cut off
                speeds.append(self._made[speed])
                continue
            if self.spent(share):
                return
            at = AtSpeed(speed)
            self.tell(
                self.record.phase, share * len(speeds) / many, f"{plain(speed, 3)} turns/s, with the setting as it is"
            )
            for _ in range(self.wanted.repeats):
                await self._there_and_back(at, ())
            speeds.append(at)
            await self._pieces.add(at)
            self.found.points = mapped(speeds, self.found.orders)
            await self.keeper.save(self.record)

    def _finer(self, speeds: Sequence[AtSpeed]) -> list[float]:
        """Speeds around those at which the strongest orders meet the resonance, as far as there is room."""
        low, high = self._ground.speeds[0], self._ground.speeds[-1]
        made = [at.speed_rps for at in speeds]
        finer = [one.speed_rps.value * times for one in self.found.crossings[:FINER_ORDERS] for times in FINER]
        return _apart([*made, *finer], low, high)[len(made) :]

    # --- changes ----------------------------------------------------------------------------------

    async def _changes(self) -> None:
        """Compare each change with the setting as it is, at some speeds and where the map has resonances."""
        ground, many = self._ground, len(self._ground.settings)
        low, high = ground.speeds[0], ground.speeds[-1]
        named = [one.speed_rps.value for one in self.found.crossings[:CROSSINGS]]
        speeds = sorted(_apart([*named, *ground.speeds[::COMPARED_EVERY]], low, high))
        for number, setting in enumerate(ground.settings, 1):
            if any(change.trial == number for change in self.found.changes):
                continue  # it was cut off after this one
            until = MAP_TAKES + (1 - MAP_TAKES) * number / many
            before, after = [AtSpeed(speed) for speed in speeds], [AtSpeed(speed) for speed in speeds]
            for index, (old, new) in enumerate(zip(before, after, strict=True)):
                if self.spent(until):
                    break
                self.tell(
                    "proof",
                    until - (1 - MAP_TAKES) / many * (1 - index / len(speeds)),
                    f"{setting.name} at {plain(old.speed_rps, 3)} turns/s, with it and without in turn",
                )
                for repeat in range(self.wanted.repeats):
                    turns = [(old, self._without(setting)), (new, setting.registers)]
                    for at, registers in turns if repeat % 2 == 0 else reversed(turns):
                        await self._there_and_back(at, registers)
            await self._compared(number, setting, before, after)

    def _without(self, setting: Setting) -> list[Held]:
        """The registers of a change as they were before."""
        names = {(each.name, each.axis) for each in setting.registers}
        return [each for each in self.record.baseline if (each.name, each.axis) in names]

    async def _compared(
        self, number: int, setting: Setting, before: Sequence[AtSpeed], after: Sequence[AtSpeed]
    ) -> None:
        record, change = self.record, Change(name=setting.name, trial=number)
        change.points = compared(before, after)
        change.lost_rps = [at.speed_rps for at in after if at.lost]
        if SCALE in setting.figures:  # with a voltage on its coils, and no current, a rotor is another pendulum
            hz, _, _ = resonance(after)
            change.resonance_hz = None if hz is None else estimate(hz)
        pairs = [
            (math.degrees(a.spectrum.ripple), math.degrees(b.spectrum.ripple))
            for old, new in zip(before, after, strict=True)
            for a, b in zip(old.ways, new.ways, strict=False)
        ]
        if len(pairs) >= 5:
            old, new = (list(side) for side in zip(*pairs, strict=True))
            effect = paired_effect(old, new, record.document.seed)
            change.before_deg = float(np.mean(old))
            change.difference_deg, change.interval_deg, change.p = effect.mean, effect.interval, effect.p
            change.quieter = not change.lost_rps and is_better(effect, change.before_deg, self.wanted.smallest_gain)
        self.found.changes.append(change)
        record.trials.append(
            Trial(
                number=number,
                setting=setting.figures,
                registers=setting.registers,
                state="infeasible" if change.lost_rps else "feasible",
                figures=Figures(runs=sum(len(at.pairs) for at in after)),
                why="steps were lost" if change.lost_rps else "",
                at_s=self.since_s,
            )
        )
        await self.keeper.save(record)

    # --- what came of it --------------------------------------------------------------------------

    def _judge(self) -> None:
        record, found = self.record, self.found
        record.findings = findings(found)
        quieter = [change for change in found.changes if change.quieter]
        record.verdict = _resonances(found)
        if found.changes:
            record.improved = bool(quieter)
            record.verdict += f"; {_changed(found.changes, quieter)}"
        if quieter:
            best = min(quieter, key=lambda change: change.difference_deg or 0.0)
            record.best = best.trial
            setting = self._ground.settings[best.trial - 1]
            record.units = dict(setting.units)
            record.baseline_setting = {name: setting.before[name] for name in setting.figures}
        record.next = (
            "keep speeds away from the named ones, or pass them quickly; least current tells how little is enough"
            if found.crossings
            else "more speeds, or a wider range of them"
        )


def _apart(speeds: Sequence[float], low: float, high: float) -> list[float]:
    """Those between both ends, without any that is as good as one before it."""
    kept: list[float] = []
    for speed in speeds:
        if low <= speed <= high and all(abs(speed / other - 1) > APART for other in kept):
            kept.append(speed)
    return kept


def _resonances(found: ResonanceFound) -> str:
    if found.resonance_hz is None:
        return "no order of the ripple meets a resonance within the speeds"
    named = ", ".join(
        f"order {one.order} at {plain(one.speed_rps.value, 3)} turns/s ({plain(one.peak_deg, 3)} deg)"
        for one in found.crossings[:CROSSINGS]
    )
    return f"the rotor swings at {plain(found.resonance_hz.value, 4)} Hz, met by {named}"


def _changed(changes: Sequence[Change], quieter: Sequence[Change]) -> str:
    if not quieter:
        return f"no change is shown to be quieter over all ({', '.join(change.name for change in changes)})"
    return ", ".join(
        f"{change.name} is quieter by {plain(100 * -(change.difference_deg or 0) / (change.before_deg or 1), 3)} %"
        for change in quieter
    )


def findings(found: ResonanceFound) -> list[Finding]:
    """As people read it."""
    told: list[Finding] = []
    if found.resonance_hz is not None:
        by = " and ".join(f"order {order}" for order in found.told_by)
        text = f"of small swings around the field, by {by}"
        told.append(
            Finding(
                name="resonance",
                text=text,
                value=found.resonance_hz.value,
                unit="Hz",
                interval=found.resonance_hz.interval,
            )
        )
    else:
        told.append(Finding(name="resonance", text="no order's ripple goes through one here", sure="cannot be told"))
    told += [
        Finding(
            name=f"order {one.order} meets it",
            text=f"{plain(one.peak_deg, 3)} deg electrical there, {plain(one.times, 3)} times of what is beside",
            value=one.speed_rps.value,
            unit="turns/s",
            interval=one.speed_rps.interval,
        )
        for one in found.crossings
    ]
    for point in found.points:
        if point.lost:
            text = f"steps were lost in {point.lost} of the runs at {plain(point.speed_rps, 3)} turns/s"
            told.append(Finding(name=f"{plain(point.speed_rps, 3)} turns/s", text=text, sure="certain"))
        if point.blind:
            text = "its samples fall on the same places of each electrical period, and show no ripple"
            told.append(Finding(name=f"{plain(point.speed_rps, 3)} turns/s", text=text, sure="cannot be told"))
    told += [_of_change(change) for change in found.changes]
    return told


def _of_change(change: Change) -> Finding:
    def at(told: str) -> str:
        return ", ".join(plain(point.speed_rps, 3) for point in change.points if point.told == told)

    said = [f"{told} at {speeds} turns/s" for told in ("quieter", "louder") if (speeds := at(told))]
    if change.lost_rps:
        said.append(f"it lost steps at {', '.join(plain(speed, 3) for speed in change.lost_rps)} turns/s")
    if change.resonance_hz is not None:
        said.append(f"the resonance is at {plain(change.resonance_hz.value, 4)} Hz with it")
    if change.difference_deg is None:
        return Finding(name=change.name, text="too few runs to compare it", sure="cannot be told")
    return Finding(
        name=change.name,
        text="; ".join(said) or "it moves the ripple of no speed",
        value=change.difference_deg,
        unit="deg electrical, mean of all speeds",
        interval=change.interval_deg,
    )
