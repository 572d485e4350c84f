"""What the motor has at a speed, from ramps up to it that lose steps or do not, as the edge of a switch tells."""

from __future__ import annotations

import math

from ...number_text import plain
from ...procedures.procedure import Failed
from ..document import TorqueCurve
from ..moves import MeasuredMoves
from ..parts import Interval
from ..ramp_settings import ACCELERATION, SPEED
from ..run import StudyRun
from ..switch_edge import SLOW_FULLSTEPS, UNTOLD, SwitchEdge
from .found import TorquePoint
from .plan import LOW_RPS, ROOM_TURNS, Ground
from .way import Way

ONSET = (0.25, 0.5, 0.75)
"""An acceleration sets in by these shares of it, half a swing of the rotor each: all at once it would swing out of
step at 0.725 of what there is."""
ONSET_SWINGS = 1.5
"""In so many swings the whole acceleration has set in: the least speed that can be told of is reached after it."""
WHOLE_SHARE = 0.8
"""Up to this share of the speed it has to have set in, or the link is too slow for that."""
FALLS_SWINGS, FALLS_DOUBT = 0.4, 0.15
"""A rotor takes part of a swing to fall out of step: steps that are lost by the end of a ramp tell what there was so
many swings before. Found, as what is left, on emulated motors against a brake."""
LEFT_BELOW, LEFT_ABOVE = 0.07, 0.10
"""What that leaves out, found there too, and is in each interval: a rotor with little damping loses steps early."""
HARDER, STEP, BRACKET = 1.4, 1.12, 1.045
"""From one acceleration to the next: at first, where one side of the edge is known, and when both are near enough."""
FASTER, TOP_BRACKET = 1.3, 1.1
"""The same of speeds, where the greatest one is looked for."""
TRIES = 4
"""Runs for one whose acceleration sets in as a whole: the link may be late once, and the first speed is raised then."""
RUNS_MOST = 40
"""Runs for one edge."""
PLACES = 0.382
"""From one run's place of the electrical period to the next."""


class Ramps:
    """Accelerates to each speed, away from a switch, with more and more until steps are lost."""

    def __init__(self, run: StudyRun, ground: Ground, wanted: TorqueCurve) -> None:
        assert ground.switch is not None
        self._run, self._ground, self._repeats = run, ground, wanted.repeats
        moves = MeasuredMoves(run.device, run.axis, run.clock, ground.full_step, 1.0, has_encoder=False)
        self._moves, self._way = moves, Way(run, ground, moves)
        self._edge = SwitchEdge(
            run.device, run.axis, run.clock, ground.switch, moves, ground.full_step, ground.far, self._slowly
        )
        moves.way_fullsteps = run.record.way_fullsteps
        before = run.record.torque.points[-1:] if run.record.torque is not None else []
        self._latest = next(((one.speed_rps, one.acceleration_radps2) for one in before), None)
        """Speed [turns/s] and acceleration [rad/s^2] of the point before."""
        self._late_s = 0.0
        """By how much the link is later than it should with the parts of an acceleration, at the worst so far."""
        self._next = ""

    def lowest_rps(self, known: float) -> float:
        """The first speed that can be told of [turns/s]. known : what the motor has there [rad/s^2]"""
        return max(LOW_RPS, self._swings_rps(ONSET_SWINGS, known) + known * self._late_s / (2 * math.pi))

    async def begin(self) -> None:
        """The rotor falls into step; then the edge is found. Raises Failed, BenchError."""
        ground = self._ground
        self._run.record.next = UNTOLD
        await self._way.gently()
        await self._moves.fall_into_step(ground.start, ground.way)
        await self._edge.learn(ground.near)

    async def home(self) -> None:
        """To where the study began. Raises Failed, BenchError."""
        await self._way.gently()
        await self._edge.lost()
        await self._way.gently()
        await self._moves.go(self._ground.start)
        if self._run.record.next == UNTOLD:
            self._run.record.next = self._next

    async def first(self) -> float | None:
        """What it has at the first speed [rad/s^2]; None where the chip cannot accelerate so that steps are lost.

        Raises Failed, BenchError.
        """
        most, gentle = self._ground.most[ACCELERATION], self._way.gentle_pps2
        if await self._lost(None, gentle):
            raise Failed("it loses steps with its ramp as it is set now: a gentler one first")
        pps2 = min(HARDER * gentle, most)
        while not await self._lost(None, pps2):
            if pps2 >= most:
                return None
            # What is known to hold by far is what the way back may be made with.
            self._way.gentle_pps2, pps2 = max(gentle, pps2 / HARDER**2), min(HARDER * pps2, most)
        return self._ground.radps2(pps2 / math.sqrt(HARDER))

    def gently(self, pps2: float) -> None:
        """Move with this acceleration from now on, between runs."""
        self._way.gentle_pps2 = pps2

    async def top(self, pps2: float) -> tuple[float, bool]:
        """The greatest speed that is reached with an acceleration [turns/s], and whether steps were lost beyond.

        Raises Failed, BenchError.
        """
        ground = self._ground
        held, lost, most = self._lowest_pps(pps2), math.inf, ground.most[SPEED]
        while held < most and lost / held > TOP_BRACKET:
            pps = min(FASTER * held, most) if lost == math.inf else math.sqrt(held * lost)
            if self._run.spent() or not self._fits(pps, pps2):
                break
            if await self._lost(pps, pps2):
                lost = pps
            else:
                held = pps
        return held / ground.turn, lost < math.inf

    async def at(self, speed_rps: float, known: float) -> TorquePoint | None:
        """What there is about a speed; None where no step is lost, or time is up. known : about what is expected
        [rad/s^2]. Raises Failed, BenchError."""
        ground, most = self._ground, self._ground.most[ACCELERATION]
        held: float | None = None
        lost: float | None = None
        pps2, holds, losses = min(ground.pps2(known), most), 0, 0
        for _ in range(RUNS_MOST):
            if self._run.spent() or not self._fits(speed_rps * ground.turn, pps2):
                return None
            if await self._lost(speed_rps * ground.turn, pps2):
                losses, lost = losses + 1, pps2
                held, holds = (None, 0) if held == pps2 else (held, holds)
            elif pps2 >= most:
                return None
            else:
                held, holds = pps2, holds + 1 if held == pps2 else 1
            if held is None or lost is None:
                pps2 = min(STEP * pps2, most) if lost is None else lost / STEP
            elif lost / held > BRACKET:
                pps2 = math.sqrt(held * lost)
            elif holds < self._repeats:
                pps2 = held  # again, from another place of the electrical period
            else:
                return self._point(speed_rps, ground.radps2(held), ground.radps2(lost), losses)
        return None

    # --- what is run ------------------------------------------------------------------------------

    def _swings_rps(self, swings: float, radps2: float) -> float:
        """By how much the speed grows in so many swings of the rotor, the motor at its edge [turns/s]."""
        return swings * radps2 * self._swing_s(radps2) / (2 * math.pi)

    def _swing_s(self, radps2: float) -> float:
        """Of a rotor whose motor has so much, about its field."""
        return 2 * math.pi / math.sqrt(self._ground.periods * radps2)

    def _lowest_pps(self, pps2: float) -> float:
        return min(self.lowest_rps(self._ground.radps2(pps2)) * self._ground.turn, self._ground.most[SPEED])

    def _fits(self, pps: float, pps2: float) -> bool:
        """Whether there is room for a ramp up to a speed, and back to rest."""
        ground = self._ground
        needed = pps**2 / (2 * self._way.gentle_pps2) + pps**2 / pps2 + ROOM_TURNS * ground.turn
        if needed > abs(ground.far - ground.start):
            self._next = (
                f"more travel: to {plain(pps / ground.turn, 3)} turns/s and back to rest it needs "
                f"{plain(needed / ground.turn, 3)} turns of it"
            )
            return False
        return True

    async def _lost(self, wished_pps: float | None, pps2: float) -> bool:
        """Whether steps are lost on a ramp up to a speed, None: the first that can be told of.

        Raises Failed where its acceleration does not set in as a whole, or there is no room for it; BenchError.
        """
        for _ in range(TRIES):
            pps = wished_pps or self._lowest_pps(pps2)
            if not self._fits(pps, pps2):
                raise Failed(self._next)
            lost, whole_pps = await self._ramp(pps, pps2)
            if whole_pps <= WHOLE_SHARE * pps:
                return lost
        raise Failed(
            f"its acceleration was not yet set as a whole at {plain(whole_pps / self._ground.turn, 3)} turns/s, "
            f"{TRIES} times: the link is too slow for so light a load, or an emulator is faster than real time"
        )

    async def _ramp(self, pps: float, pps2: float) -> tuple[bool, float]:
        """A ramp up to a speed: whether steps were lost, after which the counter is right, and at which speed [pps] its
        acceleration had set in as a whole. Raises Failed, BenchError."""
        run, ground, way, gentle = self._run, self._ground, self._way, self._way.gentle_pps2
        run.record.runs += 1
        place = round(PLACES * run.record.runs % 1 * 4 * ground.full_step)
        await way.gently()
        await self._moves.go(ground.start + ground.way * place)
        swing_s = self._swing_s(ground.radps2(pps2))
        pps = ground.space.rounded({**ground.space.now(), SPEED: pps})[SPEED]
        await way.set({SPEED: pps, ACCELERATION: ONSET[0] * pps2}, "accelerates")
        await run.device.motion.rotate(run.axis, ground.way * pps)
        began_s, device_s = run.clock.now(), run.device.device_time_s()
        for part, share in enumerate((*ONSET[1:], 1.0), start=1):
            await run.clock.sleep(max(0.0, began_s + part * swing_s / 2 - run.clock.now()))
            await way.accelerate(share * pps2)
        self._late_s = max(self._late_s, run.device.device_time_s() - device_s - ONSET_SWINGS * swing_s)
        whole_pps = abs((await self._moves.state()).velocity_pps)
        await way.speed_up(ground.way * pps, ground.far)
        await way.accelerate(gentle)
        self._moves.way_fullsteps += abs(await way.stop() - ground.start) / ground.full_step
        await way.gently()
        lost = await self._edge.lost()
        run.record.way_fullsteps = self._moves.way_fullsteps
        return lost > 0, whole_pps

    async def _slowly(self) -> None:
        """Set a ramp that a switch may end at once."""
        ground = self._ground
        slow = {SPEED: SLOW_FULLSTEPS * ground.full_step, ACCELERATION: self._way.gentle_pps2}
        await self._way.set(slow, "slowly, into the switch")

    # --- what it tells ----------------------------------------------------------------------------

    def _point(self, speed_rps: float, held: float, lost: float, losses: int) -> TorquePoint:
        """Between what held and what lost steps [rad/s^2], so many times; at the speed before, of part of a swing."""
        value = math.sqrt(held * lost)
        before = self._swings_rps(FALLS_SWINGS, value)
        speed = speed_rps - before
        slope = 0.0
        if self._latest is not None and speed > self._latest[0]:
            slope = abs(value - self._latest[1]) / (speed - self._latest[0])
        self._latest = speed, value
        doubt = slope * self._swings_rps(FALLS_DOUBT, value)
        below, above = (math.hypot(share * value, doubt, (lost - held) / 2) for share in (LEFT_BELOW, LEFT_ABOVE))
        return TorquePoint(
            speed_rps=speed,
            acceleration_radps2=value,
            interval_radps2=Interval(low=value - below, high=value + above),
            both_ways_radps2=None,
            slips=losses,
        )
