"""How an axis is moved between the runs of the study: with little acceleration, and accelerated as a run asks for."""

from __future__ import annotations

from collections.abc import Callable

from ...devices.core.results import AxisState
from ...number_text import plain
from ...procedures.procedure import POLL_S, Failed
from ..moves import MeasuredMoves
from ..ramp_settings import ACCELERATION, SPEED
from ..run import StudyRun
from .plan import LOW_RPS, ROOM_TURNS, Ground

SETTLED_SHARE = 0.002
"""A speed is reached within this share of it."""
STARTS_S = 10.0


class Way:
    """The axis of a study on its ground. gentle_pps2 : what it is moved with between runs [pps^2]"""

    def __init__(self, run: StudyRun, ground: Ground, moves: MeasuredMoves) -> None:
        self._run, self.ground, self.moves = run, ground, moves
        self.gentle_pps2 = ground.space.now()[ACCELERATION]
        self.reached_pps = 0.0
        """The speed at which it was seen last by `speed_up`, without its sign."""

    async def gently(self) -> None:
        """Set the ramp with which it is moved between runs. Raises BenchError."""
        ground = self.ground
        speed = min(max(ground.space.now()[SPEED], LOW_RPS * ground.turn), ground.most[SPEED])
        await self.set({SPEED: speed, ACCELERATION: self.gentle_pps2}, "moves slowly")

    async def set(self, values: dict[str, float], what: str) -> None:
        """Set the ramp [pps, pps^2] of a motor that stands. Raises BenchError."""
        await self._run.apply(self.ground.space.registers(values), what)

    async def accelerate(self, pps2: float) -> None:
        """Set the acceleration alone, also of a motor that turns. Raises BenchError."""
        space = self.ground.space
        for each in space.registers({SPEED: space.now()[SPEED], ACCELERATION: pps2}):
            if each.name in space.names(ACCELERATION):
                await self._run.device.registers.write(each.name, each.axis, each.value)

    async def speed_up(self, pps: float, end: int, slipped: Callable[[AxisState], bool] = lambda _: False) -> bool:
        """Turn at `pps` until that is reached, or its room up to `end` is used up; False where it has slipped before.

        Raises Failed where it does not come to that speed, BenchError.
        """
        device, ground, way = self._run.device, self.ground, 1 if pps > 0 else -1
        await device.motion.rotate(self._run.axis, pps)
        began_s, longest_s = device.device_time_s(), STARTS_S + 3 * abs(pps) / self.gentle_pps2
        while device.device_time_s() - began_s < longest_s:
            await self._run.clock.sleep(POLL_S)
            state = await self.moves.state()
            if slipped(state):
                return False
            self.reached_pps = abs(state.velocity_pps)
            if abs(state.velocity_pps - pps) <= SETTLED_SHARE * abs(pps):
                return True
            stopping = state.velocity_pps**2 / (2 * self.gentle_pps2)
            if way * (end - state.position) < min(stopping, ROOM_TURNS * ground.turn):
                return True
        raise Failed(
            f"after {plain(longest_s, 3)} s it does not turn at {plain(pps)} pps: a switch holds it, or a limit"
        )

    async def stop(self) -> int:
        """Stop, and say where it rests [microsteps]. Raises Failed where it does not come to rest, BenchError."""
        device, clock = self._run.device, self._run.clock
        await device.stop(self._run.axis)
        longest_s = STARTS_S + 3 * self.reached_pps / self.gentle_pps2
        began_s = device.device_time_s()
        while (state := await self.moves.state()).moving:
            if device.device_time_s() - began_s > longest_s:
                raise Failed(f"{plain(longest_s, 3)} s after it was stopped it still moves")
            await clock.sleep(POLL_S)
        return state.position
