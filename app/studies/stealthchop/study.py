"""The study itself: runs through all speeds, the chip's own tuning, a switch-over speed, and the proof by pairs."""

from __future__ import annotations

import asyncio
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...clock import WallClock
from ...devices.core.capabilities import PositionFromEncoder
from ...number_text import counted, plain
from ...procedures.procedure import Failed
from ..document import QuietStealthChop
from ..families import identification_of
from ..identification.coil import AmplitudeRuns
from ..moves import PERIOD_FULLSTEPS, MeasuredMoves, Sampled
from ..pieces import Pieces
from ..proof import pair_order
from ..ramp_settings import ACCELERATION, SPEED
from ..record import Figures, Trial
from ..run import StudyRun
from .decision import FASTER, Reach, decide
from .found import StealthEffect, StealthFound, StealthPair, StealthTried
from .plan import PLACES, TOP, TUNING_RUNS, Ground, between_of, look
from .seen import LEAST_SAMPLES, Amplitude, added_of, beside, jolts_of, with_speeds
from .setting import UNITS, StealthSetting

RATE_HZ = 1000.0
FULL = 255
"""The greatest amplitude as it is tuned."""
ALIKE = 0.005
"""Amplitudes that need so little more regulation than the best are as good."""
POLL_S = 0.02
CALM = 0.97
"""Of the jolt that is allowed: a setting that just holds once is not shown to hold."""
NEEDED_PARTS = 20
"""So many speeds up to the switch-over count for the line through these amplitudes."""
AMPLITUDE_MOST = 0.9
"""Of the greatest: beyond it the supply's voltage ends, and the current is not held any more."""
TUNES_FROM, TUNES_TO = 1.7, 3.6
"""An amplitude of so many times that at rest lets the chip tune what velocity adds: 1.5 to 4 (DS-TMC5160 7.2.1)."""
SEARCH_SHARE, PROOF_FROM = 0.6, 0.7


@dataclass(frozen=True, slots=True)
class Through:
    """Of runs through all speeds: worst jolt [full steps], what was added, greatest amplitude, lost full steps."""

    jolt: float
    added: float | None
    amplitude: float | None
    lost: float


@dataclass(frozen=True, slots=True)
class StealthPiece:
    """What the record does not tell: the setting of a trial by its number; number 0: the tuning, whose amplitudes were
    `needed`, of the greatest, by turns a second."""

    number: int
    setting: StealthSetting | None = None
    needed: Sequence[tuple[float, float]] = ()


class StealthChopStudy(StudyRun):
    """Looks for amplitudes that need no regulation, and for the fastest switch-over that does not jolt."""

    _ground: Ground
    _moves: MeasuredMoves
    _pieces: Pieces[StealthPiece]
    _trials: dict[StealthSetting, tuple[Trial, StealthTried]]
    _needed: dict[float, float]
    """Amplitudes that were regulated, by turns a second, of the greatest."""

    @property
    def wanted(self) -> QuietStealthChop:
        """What is looked for."""
        return self.record.document.wanted(QuietStealthChop)

    @property
    def found(self) -> StealthFound:
        """What of it stands in the record."""
        assert self.record.stealthchop is not None
        return self.record.stealthchop

    async def _study(self) -> None:
        record, wanted = self.record, self.wanted
        ground = self._ground = await self.looked(look, wanted)
        beside = (f"velocity.{self.axis}",)
        self._moves = MeasuredMoves(self.device, self.axis, self.clock, ground.full_step, 1.0, beside)
        self._moves.way_fullsteps = record.way_fullsteps
        record.findings, record.best, record.units = [], None, dict(UNITS)
        record.stealthchop = record.stealthchop or StealthFound(
            velocity_max_rps=ground.top_rps, jolt_max_fullsteps=wanted.jolt_max_fullsteps
        )
        self._take_up()
        if not record.baseline:
            record.baseline = [*ground.ramp.before, *ground.current.before, *ground.stealth.before]
            record.baseline_setting = ground.stealth.told(ground.stealth.now)
        await self.keeper.save(record)
        self._touched = True
        await self._baseline()
        chosen = self.found.chosen
        best = await self._search()
        if self.found.chosen != chosen:
            self.found.pairs = []
        if best is None:
            record.improved, record.best = False, None
            record.verdict = (
                f"even at {counted(ground.switches_rps[0], 'turn')} a second the switch-over jolts by more than "
                f"{plain(wanted.jolt_max_fullsteps)} full steps: it stays as it is"
            )
            record.next = "allow more of a jolt, or ask for less speed"
        elif best[1] == ground.stealth.now:
            record.improved, record.best = False, None
            record.verdict = f"{ground.stealth.words(best[1])} is the best that was found: it stays as it is"
        else:
            await self._prove(*best)
        await self.back()
        await self._moves.go(ground.start)
        trial = record.trial(record.best)
        if record.improved and wanted.keep and trial is not None:
            await self.apply(trial.registers, "the new setting of StealthChop")
            self._touched = False
        await self._pieces.forget()

    def _take_up(self) -> None:
        """What there is from before it was cut off."""
        self._pieces = Pieces(self.keeper.folder, StealthPiece, aside=isinstance(self.clock, WallClock))
        self._trials, self._needed, self._is_tuned = {}, {}, False
        for piece in self._pieces.read():
            trial = self.record.trial(piece.number)
            if piece.setting is None:
                self._needed, self._is_tuned = dict(piece.needed), True
            elif trial is not None:
                self._trials[piece.setting] = trial, self.found.tried[piece.number - 1]

    # --- runs ---------------------------------------------------------------------------------------

    async def _through(self, setting: StealthSetting, places: Sequence[int] = range(PLACES)) -> Through:
        """Runs there and back through all speeds, each from amplitudes as they are set. Lost steps are mended.

        places : of a full step, where they begin, in parts of `PLACES`
        """
        ground, stealth = self._ground, self._ground.stealth
        found: list[Through] = []
        for place in places:
            # With less current at rest the chip tunes nothing before the motor moves: so the first move of a day is.
            current = ground.current.registers(ground.current.run_scale, ground.hold_scale)
            ramp = ground.ramp.registers(ground.through)
            await self.apply([*current, *ramp, *stealth.fresh(setting)], "amplitudes as they are set")
            await self.apply(stealth.registers(setting), stealth.words(setting))
            found.append(await self._there_and_back(setting, ground.start + place * ground.full_step // PLACES))
        added = [each.added for each in found if each.added is not None]
        return Through(
            max(each.jolt for each in found),
            statistics.fmean(added) if added else None,
            max((each.amplitude for each in found if each.amplitude is not None), default=None),
            max(each.lost for each in found),
        )

    async def _there_and_back(self, setting: StealthSetting, start: int) -> Through:
        ground = self._ground
        rps = ground.stealth.switch_rps(setting) if setting.on else None
        switches = rps is not None and rps < ground.top_rps
        await self._moves.go(start)
        before = await self._moves.deviation()
        amplitudes: list[Amplitude] = []
        jolts: list[float] = []
        for target in (start + ground.length, start):
            run, seen = await self._watched(target)
            amplitudes += with_speeds(seen, run)
            if rps is not None and switches:
                jolts += jolts_of(run, rps * ground.turn, ground.full_step)
            self.record.runs += 1
        if switches and not jolts:
            raise Failed(
                f"fewer than {LEAST_SAMPLES} samples came around each moment at which the choppers change: the link is "
                "too slow, or something else holds it"
            )
        self.record.way_fullsteps = self._moves.way_fullsteps
        off = (await self._moves.deviation() - before) / ground.full_step
        lost = PERIOD_FULLSTEPS * abs(round(off / PERIOD_FULLSTEPS))
        if lost:
            await self._mend()
        return Through(
            max([*jolts, lost], default=0.0),
            self._added(setting, amplitudes),
            max((each.share for each in amplitudes), default=None),
            lost,
        )

    def _added(self, setting: StealthSetting, amplitudes: Sequence[Amplitude]) -> float | None:
        """What regulation does to the amplitude; where there is none, what it would have to do, as far as is known."""
        if self._ground.stealth.regulates(setting.frequency):
            return added_of(amplitudes)
        if self.found.offset_auto is None or not self._needed:
            return None
        rps, needed = self._needed_by_speed(self.found.offset_auto)
        return beside(amplitudes, [self._ground.turn * each for each in rps], needed)

    async def _watched(self, target: int) -> tuple[Sampled, list[Amplitude]]:
        """A move, and the amplitudes on its way."""
        seen: list[Amplitude] = []
        watching = asyncio.create_task(self._watch(seen), name=f"amplitudes {self.device.id}")
        try:
            run = await self._moves.sampled(target, RATE_HZ)
        finally:
            watching.cancel()
            await asyncio.wait({watching})
        if not watching.cancelled() and (error := watching.exception()) is not None:
            raise error
        return run, seen

    async def _watch(self, seen: list[Amplitude]) -> None:
        """Look at the amplitude as long as nobody ends it; it is 0 while SpreadCycle works."""
        places = self._ground.stealth.places
        while True:
            await self.clock.sleep(POLL_S)
            reading = await self.device.registers.read(places.amplitude, self.axis)
            share = self._share(reading.fields.get(places.now, reading.value))
            if share > 0:
                added = reading.fields.get(places.added)
                seen.append(Amplitude(self.device.device_time_s(), share, None if added is None else added / FULL))

    def _share(self, counts: float) -> float:
        return counts / self._ground.stealth.amplitude_full

    async def _mend(self) -> None:
        self.keeper.mark("steps lost: the position is taken from the encoder")
        await self.apply(self.record.baseline, "the setting before the study")
        await self.device.need(PositionFromEncoder).position_from_encoder(self.axis)
        await self._moves.go(self._ground.start)

    def _tried(self, setting: StealthSetting, seen: Through, why: str = "") -> StealthTried:
        return StealthTried(
            offset=setting.offset,
            gradient=setting.gradient,
            switch_rps=self._ground.stealth.switch_rps(setting),
            on=setting.on,
            jolt_fullsteps=seen.jolt,
            # Without regulation it tells a wrong current, not which amplitudes are the right ones.
            added_share=seen.added if self._ground.stealth.regulates(setting.frequency) else None,
            amplitude_share=seen.amplitude,
            lost_fullsteps=seen.lost,
            why=why,
        )

    # --- baseline, tuning ---------------------------------------------------------------------------

    async def _baseline(self) -> None:
        ground, found = self._ground, self.found
        self.tell("baseline", 0.0, "running with StealthChop as it is set now")
        self.keeper.mark("baseline")
        await self._moves.fall_into_step(ground.start)
        now = ground.stealth.now
        if not found.pairs:  # those are with the setting before in turn
            found.before = self._tried(now, await self._through(now), "as it was")
        await self.keeper.save(self.record)

    async def _tune(self) -> tuple[int | None, int | None]:
        """What the chip tunes by itself: the amplitude at rest, and what velocity adds; None where it does not."""
        ground = self._ground
        if not ground.turns:
            return None, None
        if self._is_tuned:
            return self.found.offset_auto, self.found.gradient_auto
        self.tell("look", 0.1, "StealthChop tunes itself")
        self.keeper.mark("StealthChop tunes itself")
        before = await self._moves.deviation()
        setting = self._with(*self._known(None, None), threshold=0)
        await self._turning_with(setting)
        found: tuple[int | None, int | None] = None, None
        try:
            found = await self._tuned()
        except Failed as error:
            self.record.next = str(error)
        await self._rest()
        if abs(await self._moves.deviation() - before) > PERIOD_FULLSTEPS / 2 * ground.full_step:
            await self._mend()
        self.found.offset_auto, self.found.gradient_auto = found
        await self._pieces.add(StealthPiece(0, needed=list(self._needed.items())))
        await self.keeper.save(self.record)
        return found

    async def _turning_with(self, setting: StealthSetting) -> None:
        """Set it afresh, with the run current also at rest, so that the chip can tune itself there."""
        current, stealth = self._ground.current, self._ground.stealth
        registers = [*current.registers(current.run_scale), *stealth.tuning(setting, begins=True)]
        await self.apply(registers, "the run current, also at rest")
        await self.apply(stealth.tuning(setting, begins=False), "StealthChop that tunes itself")

    async def _turn(self, rps: float, ramp: Mapping[str, float], way: int) -> float | None:
        """The mean amplitude of a way there and back at constant speed, of the greatest; None: nothing was seen."""
        ground = self._ground
        await self.apply(ground.ramp.registers(ramp), f"turns at {counted(rps, 'turn')} a second")
        longest_s = 2 * (way / ramp[SPEED] + ramp[SPEED] / ramp[ACCELERATION]) + 1.0
        seen = await self._turns.there_and_back(ground.start, way, longest_s)
        self._moves.way_fullsteps += 2 * way / ground.full_step
        self.record.runs += 1
        return None if seen is None else self._share(seen)

    @property
    def _turns(self) -> AmplitudeRuns:
        places = identification_of(self.device).amplitude
        assert places is not None
        return AmplitudeRuns(self.device, self.axis, self.clock, places)

    async def _tuned(self) -> tuple[int, int | None]:
        """Raises Failed where it does not come to an end."""
        ground, stealth = self._ground, self._ground.stealth
        steps = ground.current.steps
        offset = round(await self._turns.at_rest(steps - 1, steps))
        rest = self._at_rest(offset)
        for rps in ground.needed_rps:
            seen = await self._turn(rps, {**ground.through, SPEED: rps * ground.turn}, ground.needed_way)
            if seen is not None:
                self._needed[rps] = seen
        for rps, ramp in ground.turns:
            last = None
            for _ in range(TUNING_RUNS):
                seen = await self._turn(rps, ramp, ground.tuning_way)
                if seen is not None:
                    self._needed[rps] = seen
                if seen is None or not TUNES_FROM * rest <= seen <= TUNES_TO * rest:
                    break
                now = (await self.device.registers.read(stealth.places.gradient_auto, self.axis)).value
                if now == last:
                    return offset, now
                last = now
        return offset, None

    def _at_rest(self, offset: int) -> float:
        """The amplitude of the run current, of the greatest."""
        current = self._ground.current
        return offset * (current.run_scale + 1) / current.steps / FULL

    def _needs(self, offset: int | None, up_to_rps: float) -> int | None:
        """What velocity adds by the amplitudes that were regulated; None where nothing tells it.

        It is less than what the chip tunes at a greater speed: there the current stands against the back-EMF, slowly
        an unloaded motor's current and back-EMF are nearly at right angles. So it is no straight line either: the one
        is taken that is least off up to that speed, as a share of the amplitude.
        """
        if not self._needed or offset is None:
            return None
        rest, stealth = self._at_rest(offset), self._ground.stealth
        at, seen = self._needed_by_speed(offset)
        speeds = up_to_rps * (np.arange(NEEDED_PARTS) + 1) / NEEDED_PARTS
        needed = np.interp(speeds, at, seen)
        worth = np.array([stealth.places.calculator.of_velocity(rps, stealth.motor) for rps in speeds]) / FULL / needed
        gradient = float(np.sum(worth * (1 - rest / needed)) / np.sum(worth**2))
        return min(max(round(gradient), 0), FULL)

    def _needed_by_speed(self, offset: int) -> tuple[list[float], list[float]]:
        """Amplitudes that were regulated over turns a second, of the greatest, from rest on."""
        speeds = sorted(self._needed)
        return [0.0, *speeds], [self._at_rest(offset), *(self._needed[rps] for rps in speeds)]

    def _with_needs(self, setting: StealthSetting) -> StealthSetting:
        """With the gradient that it needs up to its switch-over speed, where that was seen."""
        top_rps = self._ground.top_rps
        rps = min(self._ground.stealth.switch_rps(setting) or top_rps, top_rps)
        gradient = self._needs(setting.offset, rps)
        return setting if gradient is None else replace(setting, gradient=gradient)

    def _known(self, offset: int | None, gradient: int | None) -> tuple[int | None, int | None]:
        """With what is calculated, or as it was, in place of what is not known."""
        stealth = self._ground.stealth
        of_sheet, by_torque = stealth.calculated
        offset = of_sheet if offset is None else offset
        gradient = by_torque if gradient is None else gradient
        return (
            stealth.now.offset if offset is None else offset,
            stealth.now.gradient if gradient is None else gradient,
        )

    def _with(self, offset: int | None, gradient: int | None, threshold: int) -> StealthSetting:
        return StealthSetting(offset, gradient, self._ground.stealth.frequency, threshold)

    # --- search -------------------------------------------------------------------------------------

    async def _search(self) -> tuple[Trial, StealthSetting] | None:
        """The best setting; None where every switch-over jolts."""
        offset, gradient = self._known(*await self._tune())
        self.tell("search", 0.2, "switch-over speeds")
        threshold = await self._switch(self._with(offset, gradient, 0))
        if threshold is None:
            return None
        return await self._amplitudes(offset, gradient, threshold)

    async def _switch(self, setting: StealthSetting) -> int | None:
        """The threshold of the fastest switch-over that does not jolt by more than asked; 0: none is needed."""
        ground, stealth, before = self._ground, self._ground.stealth, self.found.before
        assert before is not None
        reach = self._reach(stealth.now)
        if reach >= ground.top_rps and self._holds(before):
            return stealth.now.threshold
        held: float | None = None
        if ground.switches_rps[0] <= reach <= ground.top_rps / TOP and await self._try_switch(setting, reach):
            held = reach
        above: float | None = None
        for rps in [each for each in ground.switches_rps if held is None or each > held * FASTER]:
            if self._no_time_for(setting, rps):
                break
            if await self._try_switch(setting, rps):
                held = rps
            else:
                above = rps
                break
        while held is not None and above is not None:
            between = between_of(held, above)
            if between is None or self._no_time_for(setting, between):
                break
            if await self._try_switch(setting, between):
                held = between
            else:
                above = between
        return None if held is None else stealth.threshold(held)

    def _switching(self, setting: StealthSetting, rps: float) -> StealthSetting:
        return self._with_needs(replace(setting, threshold=self._ground.stealth.threshold(rps)))

    def _no_time_for(self, setting: StealthSetting, rps: float) -> bool:
        """Whether there is no time left to try that; what was tried before it was cut off takes none."""
        return self._switching(setting, rps) not in self._trials and self.spent(share=SEARCH_SHARE)

    async def _try_switch(self, setting: StealthSetting, rps: float) -> bool:
        setting = self._switching(setting, rps)
        part = 0.2 + 0.4 * rps / self._ground.top_rps
        self.tell("search", part, f"switching over at {counted(rps, 'turn', 3)} a second")
        return self._holds((await self._trial(setting, "switch-over"))[1])

    def _holds(self, tried: StealthTried) -> bool:
        """Whether it loses no step, jolts by less than asked, and has voltage left."""
        share = tried.amplitude_share
        calm = tried.jolt_fullsteps <= CALM * self.wanted.jolt_max_fullsteps and not tried.lost_fullsteps
        return calm and (share is None or share <= AMPLITUDE_MOST)

    async def _amplitudes(
        self, offset: int | None, gradient: int | None, threshold: int
    ) -> tuple[Trial, StealthSetting] | None:
        """At the chosen switch-over: amplitudes as it needs up to there, as they were, as tuned, and as calculated; the
        ones that need the least regulation, and of equal ones the first: a chip that tunes itself as a motor comes to
        rest makes up for any PWM_OFS, and regulation tells none apart then."""
        stealth, found = self._ground.stealth, self.found
        tuned = self._with(offset, gradient, threshold)
        calculated = self._with(*self._known(*stealth.calculated), threshold=threshold)
        needed = self._with_needs(tuned)
        wanted = {
            needed: "as it needs up to the switch-over speed",
            replace(stealth.now, threshold=threshold, frequency=stealth.frequency, on=True): "amplitudes as before",
            tuned: "as the chip has tuned",
            calculated: "calculated",
        }
        tried = []
        for setting, why in wanted.items():
            self.tell("search", 0.65, why)
            tried.append((setting, await self._trial(setting, why)))
            if setting == calculated and None not in stealth.calculated:
                found.calculated = tried[-1][1][1]
        held = [each for each in tried if self._holds(each[1][1])]
        if not held:
            return None
        told = [(each, added) for each in held if (added := each[1][1].added_share) is not None]
        least = min((added for _, added in told), default=0.0)
        near = [each for each, added in told if added <= least + ALIKE] if any(added for _, added in told) else []
        # Where nothing is regulated, which shows by nothing that is added to any, what it needs when it is, or what is
        # calculated.
        others = [each for one in (needed, calculated) for each in held if each[0] == one]
        setting, (trial, found.chosen) = [*near, *others, *held][0]
        self.record.best = trial.number
        return trial, setting

    async def _trial(self, setting: StealthSetting, why: str) -> tuple[Trial, StealthTried]:
        """Try a setting, once."""
        record, stealth = self.record, self._ground.stealth
        if setting in self._trials:
            return self._trials[setting]
        number = len(record.trials) + 1
        self.keeper.mark(f"trial {number}: {stealth.words(setting)}")
        tried = self._tried(setting, await self._through(setting), why)
        await self._pieces.add(StealthPiece(number, setting))
        self.found.tried.append(tried)
        trial = Trial(
            number=number,
            setting=stealth.told(setting),
            registers=stealth.registers(setting),
            state="feasible" if self._holds(tried) else "infeasible",
            figures=Figures(deviation_fullsteps=tried.jolt_fullsteps, lost_fullsteps=tried.lost_fullsteps, runs=PLACES),
            why=why,
            at_s=self.since_s,
        )
        record.trials.append(trial)
        self._trials[setting] = trial, tried
        await self.keeper.save(record)
        return self._trials[setting]

    def _reach(self, setting: StealthSetting) -> float:
        """Up to which speed of those that are asked for StealthChop works [turns a second]."""
        rps = self._ground.stealth.switch_rps(setting)
        return 0.0 if not setting.on else self._ground.top_rps if rps is None else min(rps, self._ground.top_rps)

    # --- proof --------------------------------------------------------------------------------------

    async def _prove(self, best: Trial, setting: StealthSetting) -> None:
        found, wanted = self.found, self.wanted
        settings = {"A": self._ground.stealth.now, "B": setting}
        self.keeper.mark(f"proof of trial {best.number}")
        for index in range(len(found.pairs), wanted.pairs):
            if self.spent():
                break
            self.tell(
                "proof",
                PROOF_FROM + (1 - PROOF_FROM) * index / wanted.pairs,
                f"pair {index + 1} of {wanted.pairs}",
                2 * (wanted.pairs - index) * self._ground.round_s,
            )
            order = pair_order(index)
            seen = {which: await self._through(settings[which], [index % PLACES]) for which in order}
            found.pairs.append(
                StealthPair(
                    baseline_jolt_fullsteps=seen["A"].jolt,
                    winner_jolt_fullsteps=seen["B"].jolt,
                    baseline_added_share=seen["A"].added,
                    winner_added_share=seen["B"].added,
                    order=order,
                )
            )
            await self.keeper.save(self.record)
        self._decide(setting)
        await self.keeper.save(self.record)

    def _decide(self, setting: StealthSetting) -> None:
        record, found, wanted, stealth = self.record, self.found, self.wanted, self._ground.stealth
        if len(found.pairs) < wanted.pairs:
            record.improved, record.best = None, None
            record.verdict = f"the budget ended after {len(found.pairs)} of {wanted.pairs} pairs: nothing is shown"
            record.next = "more time"
            return
        reach = Reach(self._reach(stealth.now), self._reach(setting))
        regulated = stealth.regulates(stealth.now.frequency)
        seed = record.document.seed
        shown = decide(found.pairs, reach, wanted.jolt_max_fullsteps, wanted.smallest_gain, seed, regulated=regulated)
        found.effects, record.improved = list(shown.effects), shown.improved
        jolt, old, new = shown.effects[0], stealth.words(stealth.now), stealth.words(setting)
        if not shown.improved:
            record.best = None
            why = "" if shown.calm else f": its jolt may be {plain(jolt.winner_interval.high, 3)} full steps"
            record.verdict = f"{new} is not shown to be better than {old}{why}; that stays"
            return
        then = "it is set" if wanted.keep else "one click takes it"
        record.verdict = f"{new} instead of {old}: {'; '.join(_told(each) for each in shown.effects)}; {then}"


def _told(effect: StealthEffect) -> str:
    """A figure before and after, for people."""
    times, unit, name = (1, "full steps", "jolt") if effect.name == "jolt" else (100, "%", "amplitude off by")
    before, after, low, high = (
        plain(times * each, 3) for each in (effect.baseline, effect.winner, effect.interval.low, effect.interval.high)
    )
    return f"{name} {before} to {after} {unit} (95 % of the difference: {low} to {high})"
