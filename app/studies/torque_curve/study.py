"""The study itself: runs that are accelerated until the rotor slips, and what their slips tell."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...calc.motors.pull_out import PullOut, pull_out
from ...devices.core.capabilities import PositionFromEncoder
from ...number_text import plain
from ...procedures.procedure import POLL_S, Failed
from ..document import TorqueCurve
from ..moves import MeasuredMoves, deviation_of
from ..parts import Interval
from ..ramp_settings import ACCELERATION, SPEED
from ..record import Finding
from ..run import StudyRun
from ..sampled import sampling
from .found import RampMargin, TorqueFound, TorquePoint
from .plan import LOW_RPS, ROOM_TURNS, Ground, look

RATE_HZ = 2000.0
"""As many samples as the link gives, up to that."""
AWAY_FULLSTEPS = 3.0
"""An encoder further from the position than this tells of a rotor out of step."""
SETTLED_SHARE = 0.002
BEYOND = (2.0, 4.0)
"""Up to so many times its speed, and so much more, is accelerated hard [, turns/s]."""
HARDER, EDGE = 1.4, 1.1
"""Where a run lost no step, the next one is so much harder; the first goes so far beyond what is known."""
HARD, HARD_STEP = 0.85, 1.12
"""At each speed it is accelerated by this share of what the motor has, at first, and so much harder after a run without
a slip. Set in at once, that lets a rotor with little damping swing out of step: slowly, so that its currents follow."""
NEAR = 2.0
"""Up to so many times the first speed steps have to be lost for it to be told what is there at it."""
GENTLY, TOP = 0.15, 0.25
"""Shares of what the motor has at the first speed: to come up to a speed, and to find the greatest one."""
BELOW_TOP = 0.9
"""The last speed, as a share of the greatest one."""
TRIES = 3
"""Runs for one slip that can be told."""
REST_S, REST_FULLSTEPS = 60.0, 0.5
"""How long a load that is out of step may run on, and when it rests."""
REST_LOOKS_S = (0.1, 0.037, 0.071, 0.053, 0.089)
"""From one look at it to the next: at no beat of a swing, which would look like rest."""
LOST_FULLSTEPS, BACK_TRIES = 2.0, 3
"""What lost steps on a slow way are, and how often that is mended."""
FIT_SHARE = 0.025
"""What the fit of half a slip leaves out, found on emulated motors: it is in each interval."""
SWING = 1 / 0.725
"""A rotor without damping slips at this share of the static torque when an acceleration sets in at once."""

Ended = Literal["slipped", "held", "on the way"]


@dataclass(frozen=True, slots=True)
class Slip:
    """One run in one way; reached_pps : the speed of the field as it was last seen in step."""

    ended: Ended
    told: PullOut | None
    way: int
    reached_pps: float


class TorqueCurveStudy(StudyRun):
    """Accelerates at each speed until steps are lost; nothing of the axis is other at its end."""

    _ground: Ground
    _moves: MeasuredMoves

    @property
    def wanted(self) -> TorqueCurve:
        """What is looked for."""
        return self.record.document.wanted(TorqueCurve)

    async def _study(self) -> None:
        record, wanted = self.record, self.wanted
        self.tell("preconditions", 0.0, "looking at the axis")
        ground = self._ground = (await look(self.device, self.axis, wanted)).required()
        self._moves = MeasuredMoves(self.device, self.axis, self.clock, ground.full_step, band_fullsteps=1.0)
        self._positive = True
        self._way_fullsteps = self._reached_pps = 0.0
        record.findings, record.runs = [], 0
        if not record.baseline:
            record.baseline = ground.space.before
            record.baseline_setting = ground.space.now()
        found = record.torque = TorqueFound(inertia_kgm2=wanted.inertia_kgm2, friction_nm=wanted.friction_nm)
        await self.keeper.save(record)
        self._gentle, self._hard = ground.space.now()[ACCELERATION], HARD
        await self._home()
        await self._curve(found)
        await self._home()
        await self.back()
        self._judge(found)

    # --- what is run ------------------------------------------------------------------------------

    async def _curve(self, found: TorqueFound) -> None:
        ground, wanted = self._ground, self.wanted
        self.tell("look", 0.0, f"accelerating from {LOW_RPS:g} turns/s until steps are lost")
        first = await self._first(found)
        if first is None:
            return
        known = first.acceleration
        self._gentle = self._pps2(GENTLY * known)
        self.tell("look", 0.1, "looking how fast it turns at all")
        top = await self._accelerated(LOW_RPS, self._pps2(TOP * known), ground.most[SPEED])
        highest = ground.most[SPEED] / ground.turn
        if top.ended != "held":
            highest = found.speed_most_rps = top.reached_pps / ground.turn
        # The hard acceleration, too, ends at the greatest speed that it may have.
        last = BELOW_TOP * (highest if top.ended != "held" else highest - BEYOND[1])
        if last < 1.5 * LOW_RPS:
            raise Failed(
                f"already at {plain(highest, 3)} turns/s little torque is left: nothing to be drawn as a curve"
            )
        for index, speed_rps in enumerate(np.linspace(LOW_RPS, last, wanted.speeds)):
            if self.spent():
                self.record.next = "more time, or way: not all speeds were looked at"
                break
            part = 0.15 + 0.85 * index / wanted.speeds
            self.tell("look", part, f"at {plain(float(speed_rps), 3)} turns/s", self._left_s(part))
            self.keeper.mark(f"at {plain(float(speed_rps), 3)} turns/s")
            slips = await self._slips(float(speed_rps), known)
            if slips:
                point = self._point(slips)
                found.points.append(point)
                known = point.acceleration_radps2
                found.points.sort(key=lambda one: one.speed_rps)
                await self.keeper.save(self.record)

    def _left_s(self, part: float) -> float:
        return self.since_s / part * (1 - part)

    async def _first(self, found: TorqueFound) -> PullOut | None:
        """What it has at the first speed; None where the chip cannot accelerate so that steps are lost."""
        most, unclear = self._ground.most[ACCELERATION], 0
        hard = min(HARDER * self._gentle, most)
        while True:
            slip = await self._accelerated(LOW_RPS, hard)
            near = slip.reached_pps < NEAR * LOW_RPS * self._ground.turn or hard >= most
            if slip.told is not None and near:
                return slip.told
            if slip.ended == "on the way":
                raise Failed("it loses steps on the way to the first speed, as it is set now: a gentler ramp first")
            if slip.ended == "held" or not near:
                if hard >= most:
                    found.at_least_radps2 = self._radps2(most)
                    return None
                hard = min(HARDER * hard, most)
                continue
            # Far beyond its edge the rotor is past it between a few samples.
            hard, unclear = hard / EDGE, unclear + 1
            if unclear > TRIES:
                raise Failed(
                    "it loses steps, and the encoder does not show clearly how: too few lines, or too few samples of it"
                )

    async def _slips(self, speed_rps: float, known: float) -> list[Slip]:
        """As many clear slips from one speed as were asked for, as far as they come."""
        most, slips = self._ground.most[ACCELERATION], list[Slip]()
        tries = 0
        while len(slips) < self.wanted.repeats and tries < TRIES * self.wanted.repeats and not self.spent():
            hard = min(self._hard * self._pps2(known), most)
            slip = await self._accelerated(speed_rps, hard)
            tries += 1
            if slip.told is not None and slip.ended == "slipped":
                slips.append(slip)
                known = slip.told.acceleration
            elif slip.ended == "held":
                if hard >= most:
                    break
                self._hard *= HARD_STEP
        return slips

    async def _accelerated(self, speed_rps: float, hard_pps2: float, up_to_pps: float | None = None) -> Slip:
        """Gently up to a speed, then hard until the rotor slips or a greater speed is reached; rested and mended."""
        ground, record = self._ground, self.record
        way = 1 if self._positive else -1
        self._positive = not self._positive
        pps = speed_rps * ground.turn
        up = pps**2 / (2 * self._gentle)
        beyond = min(up_to_pps or BEYOND[0] * pps + BEYOND[1] * ground.turn, ground.most[SPEED])
        needed = up + (beyond**2 - pps**2) / (2 * hard_pps2) + beyond**2 / (2 * hard_pps2) + ROOM_TURNS * ground.turn
        room = ground.far - ground.start
        if up + 2 * ROOM_TURNS * ground.turn > room:
            raise Failed(
                f"to come up to {plain(speed_rps, 3)} turns/s it needs {plain(up / ground.turn, 3)} turns of way: "
                "more travel, or a lower greatest speed"
            )
        begin = ground.start if way > 0 else ground.start + min(room, math.ceil(needed))
        await self._gently_to(begin)
        off = await self._moves.deviation()
        await self._accelerate(self._gentle)
        end = ground.far if way > 0 else ground.start
        with sampling(self.device, self._channels(), RATE_HZ, self.clock) as samples:
            ended = await self._until_slip(way * pps, off, end, samples.take)
            if ended == "held":
                await self._accelerate(hard_pps2)
                ended = await self._until_slip(way * beyond, off, end, samples.take)
            elif ended == "slipped":
                ended = "on the way"
            await self.device.stop(self.axis)
            samples.take()
        record.runs += 1
        times_s, rows = samples.all()
        await self._run_out(begin)
        known = np.isfinite(rows).all(axis=1)
        position, encoder = rows[known].T
        rad = way * 2 * math.pi / ground.turn
        told = None
        if ended != "held":
            told = pull_out(times_s[known], rad * position, rad * (encoder - off), ground.periods)
        return Slip(ended, told, way, self._reached_pps)

    def _channels(self) -> list[str]:
        return [f"position.{self.axis}", f"encoder_position.{self.axis}"]

    async def _accelerate(self, pps2: float) -> None:
        """Set the acceleration alone, also of a motor that turns."""
        self._touched = True
        speed = self._ground.space.now()[SPEED]
        for each in self._ground.space.registers({SPEED: speed, ACCELERATION: pps2}):
            if each.name in self._ground.space.names(ACCELERATION):
                await self.device.registers.write(each.name, each.axis, each.value)

    async def _until_slip(self, pps: float, off: float, end: int, take: Callable[[], None]) -> Ended:
        """Turn at `pps`: "held" as it is reached, or its room ends."""
        device, clock, ground = self.device, self.clock, self._ground
        await device.motion.rotate(self.axis, pps)
        began_s, way = device.device_time_s(), 1 if pps > 0 else -1
        longest_s = 10.0 + 3 * abs(pps) / self._gentle
        while device.device_time_s() - began_s < longest_s:
            await clock.sleep(POLL_S)
            take()
            state = await self._moves.state()
            if abs(deviation_of(state) - off) > AWAY_FULLSTEPS * ground.full_step:
                await clock.sleep(POLL_S)
                take()
                return "slipped"
            self._reached_pps = abs(state.velocity_pps)
            if abs(state.velocity_pps - pps) <= SETTLED_SHARE * abs(pps):
                return "held"
            stopping = state.velocity_pps**2 / (2 * self._gentle) if state.velocity_pps else 0.0
            if way * (end - state.position) < min(stopping, ROOM_TURNS * ground.turn):
                return "held"
        raise Failed(
            f"after {plain(longest_s, 3)} s it does not turn at {plain(pps)} pps: a switch holds it, or a limit"
        )

    async def _run_out(self, begin: int) -> None:
        """Wait until the load has run out, and take the position from the encoder."""
        device, clock = self.device, self.clock
        until_s = clock.now() + REST_S
        last, still = math.inf, 0
        while still < len(REST_LOOKS_S):
            await clock.sleep(REST_LOOKS_S[still])
            state = await self._moves.state()
            now = float(state.encoder_position or 0)
            still = still + 1 if not state.moving and abs(now - last) < REST_FULLSTEPS * self._ground.full_step else 0
            last = now
            if clock.now() > until_s:
                raise Failed(f"{REST_S:g} s after its steps were lost the shaft still turns")
        self._way_fullsteps += abs(last - begin) / self._ground.full_step
        self.record.way_fullsteps = self._way_fullsteps + self._moves.way_fullsteps
        await device.need(PositionFromEncoder).position_from_encoder(self.axis)

    async def _gently_to(self, position: int) -> None:
        """Slowly to a position; where the load did not follow, as it still swung, from where it is."""
        space, full_step = self._ground.space, self._ground.full_step
        speed = min(max(space.now()[SPEED], LOW_RPS * self._ground.turn), self._ground.most[SPEED])
        await self.apply(space.registers({SPEED: speed, ACCELERATION: self._gentle}), "moves slowly")
        for _ in range(BACK_TRIES):
            await self._moves.go(position)
            if abs(await self._moves.deviation()) < LOST_FULLSTEPS * full_step:
                return
            await self._run_out(position)
        raise Failed(f"it loses steps as it moves slowly: it does not come to {position} in {BACK_TRIES} tries")

    async def _home(self) -> None:
        """Where the study began; a rotor that stood beside its field falls into step with the first move."""
        await self._gently_to(self._ground.start + 4 * self._ground.full_step)
        await self._gently_to(self._ground.start)

    # --- what it tells ----------------------------------------------------------------------------

    def _pps2(self, radps2: float) -> float:
        return radps2 / (2 * math.pi) * self._ground.turn

    def _radps2(self, pps2: float) -> float:
        return pps2 * 2 * math.pi / self._ground.turn

    def _point(self, slips: list[Slip]) -> TorquePoint:
        from scipy import stats

        told = [slip.told for slip in slips if slip.told is not None]
        values = [each.acceleration for each in told]
        mean, count = statistics.fmean(values), len(values)
        ways = {way: [s.told.acceleration for s in slips if s.told is not None and s.way == way] for way in (1, -1)}
        apart = statistics.fmean(ways[1]) - statistics.fmean(ways[-1]) if ways[1] and ways[-1] else 0.0
        spread = 0.0
        if count > 1:
            spread = float(stats.t.ppf(0.975, count - 1)) * statistics.stdev(values) / math.sqrt(count)
        noise = math.sqrt(sum(each.half**2 for each in told)) / count
        # The doubt of a fit is alike in all of them: no mean makes it smaller.
        doubt = statistics.fmean(each.doubt for each in told)
        half = math.hypot(max(spread, noise), FIT_SHARE * mean, doubt)
        point = TorquePoint(
            speed_rps=statistics.fmean(each.speed for each in told) / (2 * math.pi),
            acceleration_radps2=mean,
            interval_radps2=Interval(low=mean - half, high=mean + half),
            both_ways_radps2=apart,
            slips=count,
        )
        wanted = self.wanted
        if wanted.inertia_kgm2 is not None:
            torque = wanted.inertia_kgm2 * mean
            around = torque * math.hypot(half / mean, wanted.inertia_share)
            point.torque_nm = torque + wanted.friction_nm
            point.interval_nm = Interval(low=point.torque_nm - around, high=point.torque_nm + around)
        return point

    def _margin(self, points: list[TorquePoint]) -> RampMargin:
        """What the ramp before asks for, against the least of what is there up to its speed."""
        now, ground = self._ground.space.now(), self._ground
        speed, asked = now[SPEED] / ground.turn, self._radps2(now[ACCELERATION])
        within = [point for point in points if point.speed_rps <= speed] or points[:1]
        beyond = next((point for point in points if point.speed_rps > speed), None)
        # Torque falls with speed: what the next point above has is there at the ramp's speed as well.
        worst = min([*within, *([] if beyond is None else [beyond])], key=lambda point: point.acceleration_radps2)
        around = worst.interval_radps2
        return RampMargin(
            speed_rps=min(worst.speed_rps, speed),
            acceleration_radps2=asked,
            times=worst.acceleration_radps2 / asked,
            interval=Interval(low=around.low / asked, high=around.high / asked),
            whole=beyond is not None,
        )

    def _judge(self, found: TorqueFound) -> None:
        record = self.record
        if found.at_least_radps2 is not None:
            record.verdict = (
                f"no step is lost at the greatest acceleration that it may have: at {LOW_RPS:g} turns/s the motor has "
                f"more than {plain(found.at_least_radps2, 3)} rad/s^2{self._as_torque(found.at_least_radps2)}"
            )
            record.next = "more inertia, a coarser resolution of microsteps, or less current shows where its edge is"
            return
        if len(found.points) < 2:
            raise Failed("no two speeds showed a clear slip: more samples, a finer encoder, or more travel")
        found.margin = margin = self._margin(found.points)
        first, last = found.points[0], found.points[-1]
        what = (
            f"{plain(first.acceleration_radps2, 3)} rad/s^2{self._as_torque(first.acceleration_radps2)} at "
            f"{plain(first.speed_rps, 3)} turns/s, {plain(last.acceleration_radps2, 3)}"
            f"{self._as_torque(last.acceleration_radps2)} at {plain(last.speed_rps, 3)}"
        )
        inside = "" if margin.whole else " as far as it was looked at"
        record.verdict = f"{what}; {plain(margin.times, 3)} times what the ramp asks for{inside}"
        record.findings = [
            Finding(
                name="margin of the ramp",
                text=f"what the motor has, by what the ramp asks for, at its worst speed{inside}: an acceleration that "
                f"sets in at once, without S-shape, needs {SWING:.2f}, for the rotor swings",
                value=margin.times,
                interval=margin.interval,
            )
        ]
        if found.speed_most_rps is not None:
            record.findings.append(
                Finding(
                    name="greatest speed",
                    text=f"with {100 * TOP:g} % of the acceleration that it has at first steps were lost here",
                    value=found.speed_most_rps,
                    unit="turns/s",
                )
            )
        uneven = max(found.points, key=lambda point: abs(point.both_ways_radps2))
        around = uneven.interval_radps2
        if abs(uneven.both_ways_radps2) > around.high - around.low:
            record.findings.append(
                Finding(
                    name="both ways differ",
                    text="positive way less negative way, at worst: a weight or a spring pulls",
                    value=uneven.both_ways_radps2,
                    unit="rad/s^2",
                )
            )
        if found.inertia_kgm2 is None:
            record.findings.append(
                Finding(name="torque", text="the inertia was not told: torque is it times this", sure="cannot be told")
            )

    def _as_torque(self, radps2: float) -> str:
        wanted = self.wanted
        if wanted.inertia_kgm2 is None:
            return ""
        return f" ({plain(wanted.inertia_kgm2 * radps2 + wanted.friction_nm, 3)} N m)"
