"""The identification itself: slow turns with two currents, hops after which the rotor rings, and their fits."""

from __future__ import annotations

import math

import numpy as np

from ...calc.motors.friction_backlash import Turn
from ...calc.motors.ring_down import Ring
from ...calc.motors.slow_turns import SlowTurn, fit_slow_turn
from ...number_text import counted, plain
from ...procedures.procedure import Failed
from ..document import Identification
from ..fitted import estimate
from ..moves import PERIOD_FULLSTEPS, MeasuredMoves
from ..ramp_settings import ACCELERATION, SPEED
from ..ringing import HOPS, RATE_HZ, ring_after
from ..run import StudyRun
from .coil import (
    ENOUGH,
    ENOUGH_AT_LAST,
    LESS_MOST,
    LESS_SURE,
    MOST,
    AmplitudeRuns,
    AtSpeed,
    CoilFound,
    coil_of,
    load_sine_of,
)
from .fits import fitted
from .found import Identified
from .measured import Measured, findings, identified, in_torques, torque_of
from .plan import AmplitudeGround, Ground, hop_targets, look

TURNS_WITH = 0.02
"""How much less or more than the motor is told may an encoder show, on the whole way."""
TURNS_TAKE = 0.85
"""Share of the time."""


class IdentificationStudy(StudyRun):
    """Turns, hops, fits, and puts the setting back."""

    _ground: Ground
    _moves: MeasuredMoves

    @property
    def wanted(self) -> Identification:
        """What is asked for."""
        return self.record.document.wanted(Identification)

    async def _study(self) -> None:
        record = self.record
        self.tell("preconditions", 0.0, "looking at the axis")
        ground = self._ground = (await look(self.device, self.axis, self.wanted)).required()
        self._moves = MeasuredMoves(self.device, self.axis, self.clock, ground.full_step, band_fullsteps=1.0)
        record.findings, record.identified = [], None
        if not record.baseline:
            fields = [] if ground.amplitude is None else ground.amplitude.fields.before
            record.baseline = [*ground.ramp.before, *ground.current.before, *fields]
        await self.keeper.save(record)
        turns = [await self._slow_turn(index, *how) for index, how in enumerate(ground.turns)]
        rings = await self._rings()
        await self._moves.go(ground.start)
        await self.back()
        found = await self._fitted(turns, rings)
        told_of = identified(found, ground, self.wanted)
        coil = await self._coil(told_of)
        if coil.resistance is not None:
            told_of.resistance_ohm = estimate(coil.resistance)
        if coil.inductance is not None:
            told_of.inductance_h = estimate(coil.inductance)
        if coil.back_emf is not None:
            told_of.back_emf_v_s_rad = estimate(coil.back_emf)
        torque, why = torque_of(self.wanted, coil.back_emf)
        if torque is not None:
            in_torques(told_of, torque)
        record.identified = told_of
        record.findings = findings(told_of, [*found.why, *coil.why, *([why] if why else [])])
        told = sum(one.sure == "measured" for one in record.findings)
        record.verdict = f"{told} figures of motor and machine, {len(record.findings) - told} that cannot be told"
        record.next = "a twin with these figures: fastest move tries on it first"

    # --- slow turns ---------------------------------------------------------------------------------

    async def _slow_turn(self, index: int, scale: int, times: float) -> SlowTurn:
        """A turn there and back at a current scale, and so many times the slow speed.

        Raises Failed where the encoder does not follow.
        """
        ground = self._ground
        share = ground.current.share(scale)
        self._tell(index, f"a turn there and back with {100 * share:.0f} % of the current")
        speed = times * ground.slow_pps
        await self.apply(
            [
                *ground.ramp.registers({SPEED: speed, ACCELERATION: ground.most}),
                *ground.current.registers(scale),
            ],
            f"slow turns with {100 * share:.0f} % of the current",
        )
        low, high = ground.start + ground.lead, ground.start + ground.lead + ground.turn
        positions, encoders, ways = [], [], []
        for target, forward in ((ground.start + ground.way, True), (ground.start, False)):
            found = await self._moves.sampled(target, RATE_HZ)
            counts = np.isfinite(found.encoder) & (found.position >= low) & (found.position < high)
            positions.append(found.position[counts])
            encoders.append(found.encoder[counts])
            ways.append(np.full(int(counts.sum()), forward))
            self._count_run()
        try:
            turn = fit_slow_turn(
                np.concatenate(positions),
                np.concatenate(encoders),
                np.concatenate(ways),
                float(ground.turn),
                float(4 * ground.full_step),
            )
        except ValueError as error:
            raise Failed(f"nothing to fit: {error}") from error
        if abs(turn.ratio.value - 1) > TURNS_WITH:
            raise Failed(
                f"the encoder shows {plain(turn.ratio.value, 3)} of the way that the motor is told: its resolution is "
                "set wrong, it slips, or the motor does not turn (first look tells)"
            )
        return turn

    # --- hops ---------------------------------------------------------------------------------------

    async def _rings(self) -> list[Ring]:
        ground = self._ground
        self._tell(len(ground.turns), "hops, after each of which the rotor rings")
        await self.apply(ground.current.registers(ground.current.run_scale), "the run current, also at rest")
        first, *targets = hop_targets(ground, self.wanted.hops)
        await self._moves.go(first - ground.full_step)
        await self._moves.go(first)
        before = await self._moves.deviation()
        await self.apply(
            ground.ramp.registers({SPEED: ground.hop_pps, ACCELERATION: ground.most}), "hops as fast as the chip can"
        )
        rings = []
        for index, target in enumerate(targets):
            self.tell(
                "look", TURNS_TAKE + (1 - TURNS_TAKE) * index / len(targets), f"hop {index + 1} of {len(targets)}"
            )
            rings.append(await self._ring(target, index))
        apart = (await self._moves.deviation() - before) / ground.full_step
        await self.apply(ground.ramp.registers({SPEED: ground.slow_pps, ACCELERATION: ground.most}), "slow moves")
        if abs(apart) > PERIOD_FULLSTEPS / 2:
            raise Failed(
                f"hops of {HOPS[0]:g} full steps lost {plain(abs(apart), 3)}: too heavy a load, or too little current"
            )
        return rings

    async def _ring(self, target: int, number: int) -> Ring:
        """Hop to `target`, and what the encoder shows from there on."""
        ground = self._ground

        async def hop(to: int) -> None:
            await self.device.motion.move(self.axis, to)

        start = (await self._moves.state()).position
        self._moves.way_fullsteps += abs(target - start) / ground.full_step
        ring = await ring_after(hop, self.device, self.axis, self.clock, target, ground.full_step, number)
        self._count_run()
        return ring

    # --- the coil -----------------------------------------------------------------------------------

    async def _coil(self, told: Identified) -> CoilFound:
        """Resistance, inductance and back-EMF, with StealthChop tuning itself; the setting goes back then."""
        ground, amplitude = self._ground, self._ground.amplitude
        if amplitude is None:
            return CoilFound(why=[f"resistance, back-EMF: {ground.no_amplitude}"])
        self.tell("look", TURNS_TAKE, "StealthChop tunes itself at rest")
        self.keeper.mark("StealthChop tunes itself")
        runs = AmplitudeRuns(self.device, self.axis, self.clock, amplitude.places)
        scale = ground.current.run_scale
        try:
            for values in (amplitude.places.before, amplitude.places.tuned):
                await self.apply(
                    [*ground.current.registers(scale), *amplitude.fields.registers(values)],
                    "StealthChop that tunes itself",
                )
            at_rest = await runs.at_rest(scale, ground.current.steps)
            at_speed = await self._at_speed(runs, amplitude, at_rest)
        except Failed as error:
            return CoilFound(why=[f"resistance, back-EMF: {error}"])
        finally:
            await self._rest()
            await self.back()
        teeth = ground.turn / ground.full_step / 4
        load = load_sine_of(told, 0.0 if isinstance(at_speed, str) else at_speed.rps, teeth)
        return coil_of(at_rest, at_speed, amplitude.told, amplitude.places, teeth, load)

    async def _at_speed(self, runs: AmplitudeRuns, amplitude: AmplitudeGround, at_rest: float) -> AtSpeed | str:
        """Amplitudes of both currents at the first speed that takes enough more voltage than rest; or why not."""
        current = self._ground.current
        least = LESS_SURE * amplitude.places.least_counts / at_rest
        low = max(self._ground.low_scale, math.ceil(least * (current.run_scale + 1)) - 1)
        less = current.share(low)
        if less > LESS_MOST:
            return "StealthChop does not measure less than this current at this supply: its pulses are too short"
        for rps, ramp in amplitude.speeds:
            await self.apply(
                [*current.registers(current.run_scale), *amplitude.ramps.registers(ramp)],
                f"turns at {counted(rps, 'turn')} a second",
            )
            found = await self._turned(runs, rps, ramp)
            enough = ENOUGH_AT_LAST if rps == amplitude.speeds[-1][0] else ENOUGH
            if found is None or not enough * at_rest <= found <= MOST:
                continue
            await self.apply(current.registers(low), f"the same with {100 * less:.0f} % of the current")
            with_less = await self._turned(runs, rps, ramp)
            if with_less is not None:
                return AtSpeed(rps, found, less, with_less)
        return "no speed within the limits takes enough more voltage than rest"

    async def _turned(self, runs: AmplitudeRuns, rps: float, ramp: dict[str, float]) -> float | None:
        """Mean amplitude of a turn there and back [counts]."""
        ground = self._ground
        self.tell("look", TURNS_TAKE, f"a turn there and back at {counted(rps, 'turn')} a second, with StealthChop")
        longest_s = 2 * (ground.way / ramp[SPEED] + ramp[SPEED] / ramp[ACCELERATION]) + 1.0
        found = await runs.there_and_back(ground.start, ground.way, longest_s)
        self._moves.way_fullsteps += 2 * ground.way / ground.full_step
        self._count_run()
        return found

    # --- fits ---------------------------------------------------------------------------------------

    async def _fitted(self, turns: list[SlowTurn], rings: list[Ring]) -> Measured:
        """Raises Failed."""
        ground = self._ground
        rad = 2 * math.pi / (4 * ground.full_step)
        made = [
            Turn(turn.apart.scaled(rad), ground.current.share(scale), rad * times * ground.slow_pps)
            for turn, (scale, times) in zip(turns, ground.turns, strict=True)
        ]
        self.tell("look", TURNS_TAKE, "what was measured is fitted")
        return await self.aside(fitted, turns[0], made, rings)

    # --- what is told -------------------------------------------------------------------------------

    def _count_run(self) -> None:
        self.record.runs += 1
        self.record.way_fullsteps = self._moves.way_fullsteps

    def _tell(self, index: int, message: str) -> None:
        self.tell("look", TURNS_TAKE * index / len(self._ground.turns), message)
        self.keeper.mark(message)
