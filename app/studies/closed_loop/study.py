"""The study itself: rings without regulation, gains for the worst plant that they leave open, and steps that show it.

Gains are set while nothing regulates: each change switches the loop off, and on again.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...calc.motors.position_loop import Gains, Margins, Plant, gains_for, open_loop_curves, step_answer, worst
from ...calc.motors.ring_down import Fitted, RingDown, fit_ring_downs
from ...calc.signals.step_response import score
from ...clock import WallClock
from ...devices.core.capabilities import VelocityJumps
from ...devices.core.results import MoveStarted
from ...number_text import plain
from ...procedures.procedure import Failed
from ...telemetry.sampling import FloatArray
from ..document import ClosedLoop
from ..fitted import estimate, ringing
from ..moves import PERIOD_FULLSTEPS, MeasuredMoves, deviation_of
from ..pieces import Pieces
from ..proof import compared_pairs, mean_interval, pair_order
from ..ramp_settings import ACCELERATION
from ..record import Figures, Held, Trial
from ..ringing import BEFORE_S, HOPS, RATE_HZ, ring_after
from ..run import StudyRun
from ..sampled import sampling
from .found import LoopCurves, LoopEffect, LoopFound, LoopLoad, LoopStep
from .grade import graded, worst_mark
from .plan import SHOWN, STEP_S, Ground, look
from .setting import INTEGRAL, PROPORTIONAL, UNITS

DELAY_S = 2e-4
"""What regulation, driver and coils take at most."""
LEAST_DAMPING = 0.003
BAND = 0.05
"""A step has settled within this share of it."""
REST_S = 0.3
OVERSHOOT_SHARE, OVERSHOOT_LEAST = 0.1, 0.02
"""A loop does as asked where its overshoot is as expected within this share of it, or of the step."""
NEW = 1
"""The number of the one trial: the new gains."""
SHOWN_POINTS = 300
PEAK_POINTS = 4000
"""Of an expected step whose overshoot is looked for."""
PLACES = (0.0, 0.25, 0.5, 0.75)
"""Steps end in turn at these shares of a full step: its detent torque, the same at each, would be in all of them alike,
and another study, begun elsewhere, would find another overshoot."""


@dataclass(frozen=True, slots=True)
class Stepped:
    """A step as it was recorded, over its size; overshoot and count, the least that the encoder tells, are shares of
    it; settling_s is None where it did not."""

    time_s: FloatArray
    encoder: FloatArray
    overshoot: float
    count: float
    settling_s: float | None


@dataclass(frozen=True, slots=True)
class LoopPiece:
    """Steps that were whole when the study was cut off: two with the new gains, or a pair.

    with_new : time [s], encoder, overshoot, count and settling [s] of
    each with the new gains, as `Stepped` has them; before_s : how long the one with the old gains took to settle
    """

    with_new: Sequence[tuple[list[float], list[float], float, float, float | None]]
    before_s: float | None = None

    @property
    def steps(self) -> list[Stepped]:
        """Those with the new gains."""
        return [
            Stepped(np.array(time_s), np.array(encoder), overshoot, count, settling_s)
            for time_s, encoder, overshoot, count, settling_s in self.with_new
        ]


class ClosedLoopStudy(StudyRun):
    """Measures, works out, and proves."""

    _ground: Ground
    _moves: MeasuredMoves
    _pieces: Pieces[LoopPiece]
    _made: list[LoopPiece]
    """Steps from before it was cut off."""
    _gains: Gains
    _plant: Plant
    _friction: float
    """By how much the field leads the rotor before it turns, as a share of a step."""

    @property
    def wanted(self) -> ClosedLoop:
        """What is asked for."""
        return self.record.document.wanted(ClosedLoop)

    async def _study(self) -> None:
        record, wanted = self.record, self.wanted
        ground = self._ground = await self.looked(look, wanted)
        self._moves = MeasuredMoves(self.device, self.axis, self.clock, ground.full_step, band_fullsteps=1.0)
        record.findings, record.units = [], UNITS
        self._pieces = Pieces(self.keeper.folder, LoopPiece, aside=isinstance(self.clock, WallClock))
        self._made = self._pieces.read()
        now = ground.loop.now
        record.baseline_setting = {PROPORTIONAL: now.proportional, INTEGRAL: now.integral}
        if not record.baseline:
            record.baseline, record.switched = [*ground.moving, *ground.loop.before], ground.loop.switched
        await self.keeper.save(record)
        if record.loop is None:
            gains, found = await self._worked_out(await self._rings())
            record.loop = found
        else:
            gains, found = self._taken_up(record.loop), record.loop
        registers = ground.loop.registers(gains, ground.most_pps, wanted.tolerance_microsteps)
        setting = {PROPORTIONAL: gains.proportional, INTEGRAL: gains.integral}
        record.trials = [
            Trial(
                number=NEW, setting=setting, registers=registers, state="feasible", figures=Figures(), why="new gains"
            )
        ]
        record.best = NEW
        await self.keeper.save(record)
        await (self._prove(found) if ground.loop.on else self._show(found))
        if record.improved:
            await self._load(found, registers)
        found.grades = graded(found)
        found.grade = worst_mark(found.grades)
        await self.back()
        await self.device.need(VelocityJumps).stand_ready(self.axis)
        await self._moves.go(ground.start)
        if record.improved and wanted.keep:
            await self._regulate(registers)
            self._touched = False
        await self._pieces.forget()

    async def back(self) -> None:
        """Gains as before the study, and what regulated then. Raises BenchError."""
        loop = self._ground.loop
        self._touched = True
        await loop.switch(loop.open)
        await self.apply(self.record.baseline, "the setting before the study")
        await loop.switch(loop.mode)
        self._touched = False

    async def _regulate(self, registers: Sequence[Held]) -> None:
        """Set gains, and let the loop regulate by them."""
        loop = self._ground.loop
        self._touched = True
        await loop.switch(loop.open)
        await self.apply(registers, "gains of a position loop")
        await loop.switch(loop.alone)

    # --- the plant ----------------------------------------------------------------------------------

    async def _rings(self) -> RingDown:
        ground = self._ground
        self.keeper.mark("hops without regulation")
        self._touched = True
        await ground.loop.switch(ground.loop.open)
        jumps = self.device.need(VelocityJumps)
        before = deviation_of(await self._moves.state())

        async def hop(to: int) -> None:
            await jumps.move_in_steps(self.axis, to, velocity_pps=ground.jump_pps)

        rings, place = [], ground.start
        for index in range(2 * (self.wanted.hops // 2)):
            self.tell("baseline", 0.5 * index / self.wanted.hops, f"hop {index + 1} of {self.wanted.hops}")
            by = round(HOPS[index % (self.wanted.hops // 2) % len(HOPS)] * ground.full_step)
            place += by if index < self.wanted.hops // 2 else -by
            rings.append(await ring_after(hop, self.device, self.axis, self.clock, place, ground.full_step, index))
            self._count(by)
        lost = (deviation_of(await self._moves.state()) - before) / ground.full_step
        if abs(lost) > PERIOD_FULLSTEPS / 2:
            raise Failed(f"the hops lost {plain(abs(lost), 3)} full steps: too heavy a load, or too little current")
        try:
            return await self.aside(fit_ring_downs, rings)
        except ValueError as error:
            raise Failed(f"the rotor's resonance cannot be told: {error}") from error

    async def _worked_out(self, rings: RingDown) -> tuple[Gains, LoopFound]:
        """Gains as the chip holds them, and the loop that they make."""
        w, half = rings.resonance_hz.value * 2 * math.pi, rings.resonance_hz.half * 2 * math.pi
        plants = [
            Plant(w + at * half, max(rings.damping.value + by * rings.damping.half, LEAST_DAMPING), DELAY_S)
            for at in (-1, 0, 1)
            for by in (-1, 0, 1)
        ]
        best = await self.aside(gains_for, plants, self.wanted.gain_margin, self.wanted.phase_margin_deg)
        gains = self._ground.loop.rounded(best)
        if gains.proportional <= 0 or gains.integral <= 0:
            raise Failed("no gains keep these margins: ask for smaller ones")
        margins: Margins = worst(gains, plants)
        middle = plants[4]
        frequency_hz, gain_db, phase_deg = open_loop_curves(gains, middle, SHOWN_POINTS)
        time_s = np.linspace(0.0, STEP_S, PEAK_POINTS)
        self._gains = gains
        self._loop_of(middle, rings.friction.value)
        found = LoopFound(
            resonance_hz=estimate(rings.resonance_hz),
            damping_ratio=estimate(rings.damping),
            friction_share=estimate(rings.friction),
            delay_s=DELAY_S,
            ringing=ringing(rings),
            alike=rings.alike,
            proportional_per_s=gains.proportional,
            integral_per_s2=gains.integral,
            gain_margin=margins.gain,
            phase_margin_deg=margins.phase_deg,
            bandwidth_hz=margins.bandwidth_hz,
            open_loop=LoopCurves(
                frequency_hz=frequency_hz.tolist(), gain_db=gain_db.tolist(), phase_deg=phase_deg.tolist()
            ),
            expected_overshoot=float(np.max(self._expected(time_s))) - 1,
            captures=self.record.runs,
        )
        return gains, found

    def _taken_up(self, found: LoopFound) -> Gains:
        """The gains of a loop that was worked out before the study was cut off."""
        self._gains = Gains(found.proportional_per_s, found.integral_per_s2)
        damping = max(found.damping_ratio.value, LEAST_DAMPING)
        self._loop_of(Plant(found.resonance_hz.value * 2 * math.pi, damping, found.delay_s), found.friction_share.value)
        return self._gains

    def _loop_of(self, plant: Plant, friction_share: float) -> None:
        """friction_share : of the holding torque, for which the field leads by as many radians"""
        self._plant = plant
        lead_fullsteps = max(0.0, friction_share) / (math.pi / 2)
        self._friction = lead_fullsteps * self._ground.full_step / self._ground.step

    def _expected(self, time_s: FloatArray) -> FloatArray:
        """A step of 1 of the loop that was worked out, at times that are evenly apart."""
        return step_answer(self._gains, self._plant, time_s, self._friction)

    # --- steps ----------------------------------------------------------------------------------------

    async def _step(self, target: int) -> Stepped:
        """A step to `target` with the loop as it is set."""
        await self.clock.sleep(REST_S)
        start, times_s, position, encoder = await self._sampled(target, by_ramp=False)
        size = float(target - start)
        known = np.isfinite(position) & np.isfinite(encoder)
        before = encoder[known & (times_s < 0)]
        if not len(before) or size == 0:
            raise Failed("a step without samples before it is none")
        scored = score(times_s, float(target), position, encoder, BAND * abs(size), size)
        after = known & (times_s >= 0)
        self._count(size)
        return Stepped(
            times_s[after],
            (encoder[after] - start) / size,
            max(0.0, scored.overshoot / abs(size)),
            float(np.min(np.diff(np.unique(encoder[known])), initial=abs(size))) / abs(size),
            scored.settling_s,
        )

    async def _show(self, found: LoopFound) -> None:
        """Steps where nothing regulated before: the loop is good where it does as was asked."""
        ground = self._ground
        await self._regulate(self.record.trials[0].registers)
        steps = [step for piece in self._made for step in piece.steps]
        for index in range(len(self._made), SHOWN // 2):
            self.tell("proof", 0.5 + index / SHOWN, f"steps {2 * index + 1} and {2 * index + 2} of {SHOWN}")
            self.keeper.mark("steps with the new gains")
            if index:
                await self._return(self._place(2 * index - 1))  # where it is already, unless it was cut off
            made = [
                await self._step(self._place(2 * index, ground.step)),
                await self._step(self._place(2 * index + 1)),
            ]
            await self._keep(made)
            steps += made
        self._tell_steps(found, steps)
        self._decide(found, as_asked=self._as_asked(found))

    async def _prove(self, found: LoopFound) -> None:
        """The new gains against the old ones, step by step."""
        ground, wanted = self._ground, self.wanted
        sets = {"A": ground.loop.before, "B": self.record.trials[0].registers}
        steps = [step for piece in self._made for step in piece.steps]
        settled = {"A": [piece.before_s or 0.0 for piece in self._made], "B": [_settled_s(step) for step in steps]}
        for index in range(len(self._made), wanted.pairs):
            self.tell("proof", 0.5 + 0.5 * index / wanted.pairs, f"pair {index + 1} of {wanted.pairs}")
            self.keeper.mark(f"pair {index + 1} of {wanted.pairs}")
            target, away = self._place(index, ground.step), self._place(index)
            if index % 2:
                target, away = away, target
            made = {}
            for which in pair_order(index):
                await self._regulate(sets[which])
                await self._return(away)
                made[which] = await self._step(target)
                settled[which].append(_settled_s(made[which]))
            await self._keep([made["B"]], settled["A"][-1])
            steps.append(made["B"])
        self._tell_steps(found, steps)
        shown = compared_pairs(settled["A"], settled["B"], wanted.smallest_gain, self.record.document.seed)
        effect, old, new, better = shown.effect, shown.old, shown.new, shown.better
        found.effect = LoopEffect(
            pairs=wanted.pairs,
            baseline_s=old,
            winner_s=new,
            difference_s=effect.mean,
            interval_s=effect.interval,
            p=effect.p,
            significant=better,
        )
        self._decide(found, as_asked=self._as_asked(found), better=better)

    async def _load(self, found: LoopFound, registers: Sequence[Held]) -> None:
        """The new gains against the torque of an acceleration: ramps there and back, as far as the hops went."""
        ground = self._ground
        self.tell("proof", 0.95, "ramps with the new gains")
        self.keeper.mark("ramps with the new gains")
        await self.device.need(VelocityJumps).stand_ready(self.axis)
        await self._regulate(registers)
        moved = [await self._ramp(target) for target in (ground.start + ground.span, ground.start)]
        found.load = LoopLoad(
            acceleration_pps2=ground.ramp.now()[ACCELERATION],
            deviation_fullsteps=max(deviation for deviation, _ in moved),
            lost_fullsteps=max(lost for _, lost in moved),
        )
        found.captures = self.record.runs
        if found.load.lost_fullsteps:
            self.record.improved, self.record.best = False, None
            self.record.verdict = (
                f"the loop does as was asked in steps, and lost {plain(found.load.lost_fullsteps)} full steps as the "
                "axis accelerated by its ramp: it stays as it was"
            )
            self.record.next = "a gentler ramp, or more current"

    async def _ramp(self, target: int) -> tuple[float, float]:
        """A move by the ramp: how far the encoder was off the position, and steps that it lost [full steps]."""
        start, _, position, encoder = await self._sampled(target, by_ramp=True)
        state = await self._moves.state()
        if state.moving or state.position != target:
            raise Failed(f"a ramp to {target} with the new gains stands at {state.position}: by a switch, or too slow")
        off = (encoder - position) / self._ground.full_step
        self._count(target - start)
        lost = PERIOD_FULLSTEPS * round(deviation_of(state) / self._ground.full_step / PERIOD_FULLSTEPS)
        return float(np.nanmax(np.abs(off))), abs(lost)

    async def _sampled(self, target: int, *, by_ramp: bool) -> tuple[int, FloatArray, FloatArray, FloatArray]:
        """Go to `target`: where it began, times since the command [s], position and encoder [microsteps].

        It is given its time, and not waited for: with a loop a chip counts as arrived only where the encoder is.
        """
        names = [f"position.{self.axis}", f"encoder_position.{self.axis}"]
        with sampling(self.device, names, RATE_HZ, self.clock) as samples:
            await self.clock.sleep(BEFORE_S)
            start = (await self._moves.state()).position
            started = await (self.device.motion.move(self.axis, target) if by_ramp else self._jump(target))
            ramp_s = (started.predicted_duration_s or STEP_S) if by_ramp else 0.0
            await self.clock.sleep(ramp_s + STEP_S)
            samples.take()
        times_s, rows = samples.all()
        position, encoder = rows.T
        return start, times_s - started.started_at_s, position, encoder

    async def _jump(self, target: int) -> MoveStarted:
        jumps = self.device.need(VelocityJumps)
        return await jumps.move_in_steps(self.axis, target, velocity_pps=self._ground.jump_pps)

    async def _keep(self, with_new: Sequence[Stepped], before_s: float | None = None) -> None:
        kept = [
            (step.time_s.tolist(), step.encoder.tolist(), step.overshoot, step.count, step.settling_s)
            for step in with_new
        ]
        await self._pieces.add(LoopPiece(kept, before_s))
        await self.keeper.save(self.record)

    def _place(self, index: int, beyond: int = 0) -> int:
        """Where the step of that number ends, or `beyond` that [microsteps]."""
        ground = self._ground
        return ground.start + round(PLACES[index % len(PLACES)] * ground.full_step) + beyond

    async def _return(self, place: int) -> None:
        """Go where a step begins, with the loop as it is set."""
        if (await self._moves.state()).position == place:
            return
        await self._jump(place)
        await self.clock.sleep(STEP_S)

    def _tell_steps(self, found: LoopFound, steps: list[Stepped]) -> None:
        over = [one.overshoot for one in steps]
        mean = statistics.fmean(over)
        # Where the counts of the encoder lie is alike in all of them: no mean makes that smaller.
        half = math.hypot(mean_interval(over).high - mean, statistics.fmean(one.count for one in steps) / 2)
        found.overshoot = estimate(Fitted(mean, half))
        known = [one.settling_s for one in steps if one.settling_s is not None]
        found.settling_s = statistics.fmean(known) if len(known) == len(steps) else None
        first = steps[0]
        even = np.linspace(0.0, float(first.time_s[-1]), 2 * SHOWN_POINTS)
        found.step = LoopStep(
            time_s=even.tolist(),
            measured=np.interp(even, first.time_s, first.encoder).tolist(),
            expected=self._expected(even).tolist(),
        )
        found.captures = self.record.runs

    def _as_asked(self, found: LoopFound) -> bool:
        assert found.overshoot is not None
        off = abs(found.overshoot.value - found.expected_overshoot)
        return off <= max(OVERSHOOT_SHARE * found.expected_overshoot, OVERSHOOT_LEAST) and found.settling_s is not None

    def _decide(self, found: LoopFound, *, as_asked: bool, better: bool = True) -> None:
        record, told = self.record, found.overshoot
        assert told is not None
        words = (
            f"overshoot {100 * told.value:.3g} %, {100 * found.expected_overshoot:.3g} % expected; phase margin "
            f"{plain(found.phase_margin_deg, 3)} degrees, gain margin {plain(found.gain_margin, 3)}, bandwidth "
            f"{plain(found.bandwidth_hz, 3)} Hz"
        )
        record.improved = as_asked and better
        if record.improved:
            stays = "it is set" if self.wanted.keep else "one click takes it"
            record.verdict = f"the loop does as was asked: {words}; {stays}"
            record.next = "push it by hand, or let a load push: Closed loop, Disturbance"
            return
        record.best = None
        why = "not shown to settle sooner" if as_asked else "steps are not as the loop that was worked out"
        record.verdict = f"{why}: {words}; it stays as it was"
        record.next = "" if as_asked else "larger margins; no play and no load is in the step that was expected"

    def _count(self, by: float) -> None:
        self.record.runs += 1
        self.record.way_fullsteps += abs(by) / self._ground.full_step


def _settled_s(step: Stepped) -> float:
    return STEP_S if step.settling_s is None else step.settling_s
