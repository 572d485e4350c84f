"""The calibration itself: the angle error over whole turns both ways, a table for it, and its proof by pairs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np

from ...calc.microsteps.angle_correction import Correction, TooUneven, corrected, rms
from ...calc.microsteps.angle_error import BINS, AngleError, ElectricalAngle, Way, angle_error
from ...calc.microsteps.mslut import POSITIONS, decode, encode
from ...devices.core.capabilities import MslutTable
from ...number_text import plain
from ...procedures.procedure import Failed
from ..document import MicrostepCalibration
from ..moves import MeasuredMoves
from ..proof import compared_pairs, pair_order
from ..ramp_settings import SPEED
from ..record import AngleEffect, AnglePair, Figures, MicrostepFigures, Trial
from ..run import StudyRun
from .measured import figures, findings
from .plan import FIRST_SPEEDS, Ground, look

SAMPLES_A_PERIOD = 20.618
"""No whole number: each period is sampled at other places, so no order looks like another."""
ENOUGH, ATTEMPTS = 0.15, 3
"""A run with less than this share of its samples is made again, so often at most in all."""
LEAST_GAIN_DEG = 0.05
"""A table is not changed for less [deg electrical]: that is a seventh of a microstep of 1/256."""
TURNS_WITH = 0.02
"""How much less or more than the motor is told may an encoder show, on the whole way."""
ODD_DEG = 45.0
"""Beyond this error the rotor does not follow [deg electrical]: 90 is where it slips."""
SPEED_SHARE, SPEED_DEG = 0.2, 0.2
"""By how much what comes once a full step may depend on the speed: as a share of it, and [deg electrical]."""
NEW = 1
"""The number of the one trial: the corrected table."""


class MicrostepCalibrationStudy(StudyRun):
    """Measures, corrects, and proves."""

    _ground: Ground
    _moves: MeasuredMoves
    _electrical: ElectricalAngle

    @property
    def wanted(self) -> MicrostepCalibration:
        """What is looked for."""
        return self.record.document.wanted(MicrostepCalibration)

    async def _study(self) -> None:
        record = self.record
        self.tell("preconditions", 0.0, "looking at the axis")
        ground = self._ground = (await look(self.device, self.axis, self.wanted)).required()
        self._moves = MeasuredMoves(self.device, self.axis, self.clock, ground.full_step, band_fullsteps=1.0)
        record.findings, record.microsteps, record.trials, record.best = [], None, [], None
        if not record.baseline:
            record.baseline = [*ground.space.before, *ground.table.before]
        await self.keeper.save(record)
        correction = await self._measure()
        if correction is not None:
            await self._prove(correction)
        await self.back()
        await self._moves.go(ground.start)
        best = record.trial(record.best)
        if record.improved and self.wanted.keep and best is not None:
            await self.apply(best.registers, "the new table")
            self._touched = False

    # --- the angle error ----------------------------------------------------------------------------

    async def _find_angle(self) -> None:
        """Which electrical angle belongs to a position, and which way it turns: looked up at rest, twice."""
        ground, table = self._ground, self.device.need(MslutTable)
        places = []
        # The first of these moves takes a rotor that stood beside its field into step.
        for position in (ground.start + ground.lead, ground.start, ground.start + ground.full_step):
            await self._moves.go(position)
            places.append((await table.read_mslut(self.axis)).position)
        turned = (places[2] - places[1]) % POSITIONS
        if turned not in (POSITIONS // 4, 3 * POSITIONS // 4):
            raise Failed(
                f"a full step turned the place in the table by {turned} of {POSITIONS} instead of {POSITIONS // 4}: "
                "the resolution of microsteps is set otherwise than it is known, or the motor does not move"
            )
        angle = (places[1] + 0.5) * 2 * math.pi / POSITIONS
        sign = 1 if turned == POSITIONS // 4 else -1
        self._electrical = ElectricalAngle(float(ground.start), angle, float(ground.period), sign)

    async def _go_at(self, share: float) -> None:
        ramp = self._ground.ramp
        slow = {**ramp, SPEED: ramp[SPEED] * share}
        await self.apply(self._ground.space.registers(slow), f"moves at {plain(slow[SPEED], 4)} pps")

    async def _round(self, share: float = 1.0) -> list[Way]:
        """There and back once, at a share of the speed: what was sampled meanwhile, of whole turns."""
        ground = self._ground
        low = ground.start + ground.lead
        high = low + self.wanted.turns * ground.turn
        rate_hz = SAMPLES_A_PERIOD * share * ground.ramp[SPEED] / ground.period
        enough = ENOUGH * SAMPLES_A_PERIOD * (high - low) / ground.period
        for _ in range(ATTEMPTS):
            ways = await self._both_ways(low, high, rate_hz)
            if min(len(way.position) for way in ways) >= enough:
                return ways
        raise Failed(
            f"{min(len(way.position) for way in ways)} samples came of a run, {enough:.0f} are needed: the link is too "
            "slow for this speed, or something else keeps it busy"
        )

    async def _both_ways(self, low: int, high: int, rate_hz: float) -> list[Way]:
        """There and back once; what was sampled from `low` to `high` [microsteps] counts."""
        ground, ways = self._ground, []
        await self._moves.go(ground.start)
        for target, forward in ((ground.start + ground.way, True), (ground.start, False)):
            found = await self._moves.sampled(target, rate_hz)
            counts = np.isfinite(found.encoder) & (found.position >= low) & (found.position < high)
            ways.append(Way(found.position[counts], found.encoder[counts], forward))
            self.record.runs += 1
        self.record.way_fullsteps = self._moves.way_fullsteps
        return ways

    def _error(self, ways: Sequence[Way]) -> AngleError:
        """Raises Failed for what is no error of microsteps."""
        for way in ways:
            shown = float(np.polyfit(way.position, way.encoder, 1)[0])
            if abs(shown - 1) > TURNS_WITH:
                raise Failed(
                    f"the encoder shows {plain(shown, 3)} of the way that the motor is told: its resolution is set "
                    "wrong, it slips, or the motor does not turn (first look tells)"
                )
        try:
            found = angle_error(ways, self._electrical, float(self._ground.turn))
        except ValueError as error:
            raise Failed(f"nothing to fit: {error}") from error
        worst = max(found.residual, found.rms, abs(found.friction))
        if worst > ODD_DEG:
            raise Failed(
                f"the rotor stands {plain(worst, 3)} degrees electrical from its field: an open phase, too much load, "
                "too little current, or steps that are lost"
            )
        return found

    async def _measure(self) -> Correction | None:
        """The error as the axis is set now, and a table for it; None where none would be better."""
        record, ground = self.record, self._ground
        self.tell("baseline", 0.0, "finding the electrical angle")
        await self._go_at(1.0)
        await self._find_angle()
        ways: list[Way] = []
        found: list[AngleError] = []
        for index, share in enumerate(FIRST_SPEEDS):
            self._tell_round("baseline", index, f"turning there and back, at {share:g} of the speed")
            await self._go_at(share)
            ways += await self._round(share)
            found.append(self._error(ways[-2:]))
        await self._go_at(1.0)
        _require_slow(*found)
        measured, wave = self._error(ways), decode(ground.table.now)
        try:
            correction = corrected(measured, wave)
        except TooUneven as error:
            raise Failed(f"{error}: {plain(measured.rms, 3)} degrees electrical on average, steps are lost") from error
        beyond, expected = rms(correction.beyond), rms(correction.after)
        middle, step = POSITIONS // BINS // 2, POSITIONS // BINS
        told = record.microsteps = MicrostepFigures(
            microsteps_per_deg=ground.period / 360,
            before=figures(measured),
            wave_before=list(wave.values),
            beyond_rms_deg=beyond,
            predicted_rms_deg=expected,
            predicted_deg=correction.after[middle::step].tolist(),
        )
        record.findings = findings(measured, beyond)
        await self.keeper.save(record)
        if measured.rms - expected < max(LEAST_GAIN_DEG, self.wanted.smallest_gain * measured.rms):
            record.improved = False
            record.verdict = (
                f"no table of this chip makes it more exact by what counts: the error is {plain(measured.rms, 3)} deg "
                f"electrical, and would be {plain(expected, 3)} with the best of them; it stays as it is"
            )
            return None
        told.wave = list(correction.wave.values)
        return correction

    # --- the proof ----------------------------------------------------------------------------------

    async def _prove(self, correction: Correction) -> None:
        record, told, wanted = self.record, self.record.microsteps, self.wanted
        assert told is not None
        tables = {
            "A": self._ground.table.before,
            "B": self._ground.table.registers(encode(correction.wave.values, correction.wave.mirror)),
        }
        record.trials = [
            Trial(number=NEW, setting={}, registers=tables["B"], state="feasible", figures=Figures(), why="new table")
        ]
        record.best = NEW
        after: list[Way] = []
        for index in range(wanted.pairs):
            if self.spent():
                break
            self._tell_round("proof", len(FIRST_SPEEDS) + 2 * index, f"pair {index + 1} of {wanted.pairs}")
            order = pair_order(index)
            found: dict[str, float] = {}
            for which in order:
                await self.apply(tables[which], "a microstep table")
                ways = await self._round()
                found[which] = self._error(ways).rms
                after += ways if which == "B" else []
            told.pairs.append(AnglePair(baseline_deg=found["A"], winner_deg=found["B"], order=order))
        if after:
            told.after = figures(self._error(after))
        self._decide(told)
        await self.keeper.save(record)

    def _decide(self, told: MicrostepFigures) -> None:
        record, wanted = self.record, self.wanted
        if len(told.pairs) < wanted.pairs:
            record.improved, record.best = None, None
            record.verdict = f"the budget ended after {len(told.pairs)} of {wanted.pairs} pairs: nothing is shown"
            record.next = "more time"
            return
        before, after = [pair.baseline_deg for pair in told.pairs], [pair.winner_deg for pair in told.pairs]
        shown = compared_pairs(before, after, wanted.smallest_gain, record.document.seed)
        effect, old, new, record.improved = shown.effect, shown.old, shown.new, shown.better
        told.effect = AngleEffect(
            pairs=len(told.pairs),
            baseline_deg=old,
            winner_deg=new,
            difference_deg=effect.mean,
            interval_deg=effect.interval,
            p=effect.p,
            significant=record.improved,
        )
        words = f"{plain(old, 3)} to {plain(new, 3)} deg electrical, {plain(told.predicted_rms_deg or 0.0, 3)} expected"
        if record.improved:
            record.verdict = f"more exact: {words}; {'it is set' if wanted.keep else 'one click takes it'}"
            return
        record.best = None
        record.verdict = f"not shown to be more exact: {words}; it stays as it is"
        record.next = "does this table turn the motor? A driver that is given steps has a table of its own"

    def _tell_round(self, phase: Literal["baseline", "proof"], done: int, message: str) -> None:
        """`done` : rounds there and back so far."""
        rounds = len(FIRST_SPEEDS) + 2 * self.wanted.pairs
        left_s = self.since_s / done * (rounds - done) if done else None
        self.tell(phase, done / rounds, message, left_s)
        self.keeper.mark(message)


def _require_slow(fast: AngleError, slow: AngleError) -> None:
    """Raises Failed where the error once a full step depends on the speed: then the load's resonance is in it."""
    at_speed, at_half = fast.harmonic(4), slow.harmonic(4)
    apart = math.hypot(at_speed.sine - at_half.sine, at_speed.cosine - at_half.cosine)
    if apart > SPEED_SHARE * at_half.amplitude + SPEED_DEG + at_speed.half + at_half.half:
        raise Failed(
            f"once a full step the rotor is off by {plain(at_speed.amplitude, 3)} deg electrical, and by "
            f"{plain(at_half.amplitude, 3)} at half the speed: too near to the load's resonance, turn more slowly"
        )
