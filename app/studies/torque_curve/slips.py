"""What the motor has at a speed, from runs whose rotor is seen to slip by the encoder."""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...calc.motors.pull_out import PullOut, pull_out
from ...devices.core.capabilities import PositionFromEncoder
from ...devices.core.results import AxisState
from ...number_text import plain
from ...procedures.procedure import POLL_S, Failed
from ..document import TorqueCurve
from ..moves import MeasuredMoves, deviation_of
from ..parts import Interval
from ..proof import mean_interval
from ..ramp_settings import ACCELERATION, SPEED
from ..run import StudyRun
from ..sampled import sampling
from .found import TorquePoint
from .plan import LOW_RPS, ROOM_TURNS, Ground
from .way import Way

RATE_HZ = 2000.0
"""As many samples as the link gives, up to that."""
AWAY_FULLSTEPS = 3.0
"""An encoder further from the position than this tells of a rotor out of step."""
BEYOND = (2.0, 4.0)
"""Up to so many times its speed, and so much more, is accelerated hard [, turns/s]."""
HARDER, EDGE = 1.4, 1.1
"""Where a run lost no step, the next one is so much harder; the first goes so far beyond what is known."""
HARD, HARD_STEP = 0.85, 1.12
"""At each speed it is accelerated by this share of what the motor has, at first, and so much harder after a run without
a slip. Set in at once, that lets a rotor with little damping swing out of step: slowly, so that its currents follow."""
NEAR = 2.0
"""Up to so many times the first speed steps have to be lost for it to be told what is there at it."""
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

Ended = Literal["slipped", "held", "on the way"]


@dataclass(frozen=True, slots=True)
class Slip:
    """One run in one way; reached_pps : the speed of the field as it was last seen in step."""

    ended: Ended
    told: PullOut | None
    way: int
    reached_pps: float


class Slips:
    """Accelerates hard from each speed, both ways in turn, until the rotor slips: how it slips tells what there was."""

    def __init__(self, run: StudyRun, ground: Ground, wanted: TorqueCurve) -> None:
        self._run, self._ground, self._wanted = run, ground, wanted
        self._moves = MeasuredMoves(run.device, run.axis, run.clock, ground.full_step, band_fullsteps=1.0)
        self._way = Way(run, ground, self._moves)
        self._positive, self._hard = True, HARD
        self._way_fullsteps = run.record.way_fullsteps

    def lowest_rps(self, known: float) -> float:
        """The first speed that can be told of [turns/s]."""
        return LOW_RPS

    async def begin(self) -> None:
        """A rotor that stood beside its field falls into step with the first move. Raises Failed, BenchError."""
        await self.home()

    async def home(self) -> None:
        """To where the study began. Raises Failed, BenchError."""
        await self._gently_to(self._ground.start + 4 * self._ground.full_step)
        await self._gently_to(self._ground.start)

    async def first(self) -> float | None:
        """What it has at the first speed [rad/s^2]; None where the chip cannot accelerate so that steps are lost.

        Raises Failed, BenchError.
        """
        most, unclear = self._ground.most[ACCELERATION], 0
        hard = min(HARDER * self._way.gentle_pps2, most)
        while True:
            slip = await self._accelerated(LOW_RPS, hard)
            near = slip.reached_pps < NEAR * LOW_RPS * self._ground.turn or hard >= most
            if slip.told is not None and near:
                return slip.told.acceleration
            if slip.ended == "on the way":
                raise Failed("it loses steps on the way to the first speed, as it is set now: a gentler ramp first")
            if slip.ended == "held" or not near:
                if hard >= most:
                    return None
                hard = min(HARDER * hard, most)
                continue
            # Far beyond its edge the rotor is past it between a few samples.
            hard, unclear = hard / EDGE, unclear + 1
            if unclear > TRIES:
                raise Failed(
                    "it loses steps, and the encoder does not show clearly how: too few lines, or too few samples of it"
                )

    def gently(self, pps2: float) -> None:
        """Move with this acceleration from now on, between runs and up to the speed of each."""
        self._way.gentle_pps2 = pps2

    async def top(self, pps2: float) -> tuple[float, bool]:
        """The greatest speed that is reached with an acceleration [turns/s], and whether steps were lost there; as far
        as a hard acceleration from there may go. Raises Failed, BenchError."""
        most = self._ground.most[SPEED]
        found = await self._accelerated(LOW_RPS, pps2, most)
        if found.ended != "held":
            return found.reached_pps / self._ground.turn, True
        return most / self._ground.turn - BEYOND[1], False

    async def at(self, speed_rps: float, known: float) -> TorquePoint | None:
        """What there is at a speed, by as many clear slips as were asked for, as far as they come; None without one.

        known : about what is expected [rad/s^2]. Raises Failed, BenchError.
        """
        most, slips = self._ground.most[ACCELERATION], list[tuple[int, PullOut]]()
        tries = 0
        while len(slips) < self._wanted.repeats and tries < TRIES * self._wanted.repeats and not self._run.spent():
            hard = min(self._hard * self._ground.pps2(known), most)
            slip = await self._accelerated(speed_rps, hard)
            tries += 1
            if slip.told is not None and slip.ended == "slipped":
                slips.append((slip.way, slip.told))
                known = slip.told.acceleration
            elif slip.ended == "held":
                if hard >= most:
                    break
                self._hard *= HARD_STEP
        return _point(slips) if slips else None

    # --- what is run ------------------------------------------------------------------------------

    async def _accelerated(self, speed_rps: float, hard_pps2: float, up_to_pps: float | None = None) -> Slip:
        """Gently up to a speed, then hard until the rotor slips or a greater speed is reached; rested and mended."""
        run, ground, gentle = self._run, self._ground, self._way.gentle_pps2
        way = 1 if self._positive else -1
        self._positive = not self._positive
        pps = speed_rps * ground.turn
        beyond = min(up_to_pps or BEYOND[0] * pps + BEYOND[1] * ground.turn, ground.most[SPEED])
        up, room = pps**2 / (2 * gentle), abs(ground.far - ground.start)
        if up + 2 * ROOM_TURNS * ground.turn > room:
            raise Failed(
                f"to come up to {plain(speed_rps, 3)} turns/s it needs {plain(up / ground.turn, 3)} turns of way: "
                "more travel, or a lower greatest speed"
            )
        needed = up + (beyond**2 - pps**2) / (2 * hard_pps2) + beyond**2 / (2 * hard_pps2) + ROOM_TURNS * ground.turn
        begin = ground.start if way > 0 else ground.start + min(room, math.ceil(needed))
        await self._gently_to(begin)
        off = await self._moves.deviation()
        await self._way.accelerate(gentle)
        end = ground.far if way > 0 else ground.start
        with sampling(run.device, self._channels(), RATE_HZ, run.clock) as samples:

            def slipped(state: AxisState) -> bool:
                samples.take()
                return abs(deviation_of(state) - off) > AWAY_FULLSTEPS * ground.full_step

            ended: Ended = "held" if await self._way.speed_up(way * pps, end, slipped) else "on the way"
            if ended == "held":
                await self._way.accelerate(hard_pps2)
                ended = "held" if await self._way.speed_up(way * beyond, end, slipped) else "slipped"
            if ended != "held":
                await run.clock.sleep(POLL_S)
                samples.take()
            await run.device.stop(run.axis)
            samples.take()
        run.record.runs += 1
        times_s, rows = samples.all()
        await self.run_out(begin)
        known = np.isfinite(rows).all(axis=1)
        position, encoder = rows[known].T
        rad = way * 2 * math.pi / ground.turn
        told = None
        if ended != "held":
            told = pull_out(times_s[known], rad * position, rad * (encoder - off), ground.periods)
        return Slip(ended, told, way, self._way.reached_pps)

    def _channels(self) -> list[str]:
        return [f"position.{self._run.axis}", f"encoder_position.{self._run.axis}"]

    async def run_out(self, begin: int) -> None:
        """Wait until the load has run out, and take the position from the encoder."""
        run, clock = self._run, self._run.clock
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
        run.record.way_fullsteps = self._way_fullsteps + self._moves.way_fullsteps
        await run.device.need(PositionFromEncoder).position_from_encoder(run.axis)

    async def _gently_to(self, position: int) -> None:
        """Slowly to a position; where the load did not follow, as it still swung, from where it is."""
        await self._way.gently()
        for _ in range(BACK_TRIES):
            await self._moves.go(position)
            if abs(await self._moves.deviation()) < LOST_FULLSTEPS * self._ground.full_step:
                return
            await self.run_out(position)
        raise Failed(f"it loses steps as it moves slowly: it does not come to {position} in {BACK_TRIES} tries")


def _point(slips: list[tuple[int, PullOut]]) -> TorquePoint:
    """What slips of one speed tell, each with its way."""
    told = [slip for _, slip in slips]
    values = [each.acceleration for each in told]
    mean, count = statistics.fmean(values), len(values)
    ways = {way: [slip.acceleration for its, slip in slips if its == way] for way in (1, -1)}
    apart = statistics.fmean(ways[1]) - statistics.fmean(ways[-1]) if ways[1] and ways[-1] else None
    spread = mean_interval(values).high - mean if count > 1 else 0.0
    noise = math.sqrt(sum(each.half**2 for each in told)) / count
    # The doubt of a fit is alike in all of them: no mean makes it smaller.
    doubt = statistics.fmean(each.doubt for each in told)
    half = math.hypot(max(spread, noise), FIT_SHARE * mean, doubt)
    return TorquePoint(
        speed_rps=statistics.fmean(each.speed for each in told) / (2 * math.pi),
        acceleration_radps2=mean,
        interval_radps2=Interval(low=mean - half, high=mean + half),
        both_ways_radps2=apart,
        slips=count,
    )
