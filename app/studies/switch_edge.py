"""Lost steps seen by a switch: where its edge is found elsewhere than before, the position counter is wrong.

The edge is looked at from both sides, half of an electrical period away each: a rotor that slips does so by whole
periods, so that is enough, whatever the speed of the link. What was lost is known when the edge has been found anew.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from ..clock import Clock
from ..devices.core.capabilities import PositionSetting
from ..devices.core.device import Device
from ..procedures.procedure import Failed
from .moves import PERIOD_FULLSTEPS, REST_S, MeasuredMoves
from .until_switch import Side, go_until_switch, is_pressed

SWITCHES: dict[str, Side | None] = {"encoder": None, "left switch": "left", "right switch": "right"}
"""The switch that sees lost steps, by what a study is told does; None: the encoder."""
UNTOLD = "steps may have been lost since its switch was looked at last, and nothing tells: search the reference"
"""Of a study that ends early, or with the server."""
LEAVING = "cut off in that switch and resumed: first out of it, slowly, by a turn of the motor at most"
"""Of the plan of a study that goes on."""
CLEAR_FULLSTEPS = PERIOD_FULLSTEPS / 2
"""So far from the edge it is looked at whether the switch is pressed, or not."""
LOST_FULLSTEPS = 6.0
"""Further from where a switch was met its edge is not, but for lost steps: what the link is late by is far less."""
COARSE_FULLSTEPS = 8.0
"""Steps out of a pressed switch, before it is gone into by single full steps."""
STEPS_MAX = 200
"""Such steps at most: a motor that was stopped at speed stands that far in a switch that does not stop it."""
SPANS_MAX = 5
"""So many times the whole way it is looked for towards the switch: a heavy load that fell out of step runs on."""
SLOW_FULLSTEPS = 50.0
"""How fast a switch is gone into [full steps a second]: a quarter of a turn."""


class SwitchEdge:
    """The edge of a switch of one axis. Positions in microsteps of the counter."""

    def __init__(
        self,
        device: Device,
        axis: int,
        clock: Clock,
        side: Side,
        moves: MeasuredMoves,
        full_step: int,
        far: int,
        slowly: Callable[[], Awaitable[None]],
    ) -> None:
        """`moves` of the axis, `full_step` in microsteps; `far` is the place farthest from the switch of all moves.

        `slowly` sets a ramp for the way into the switch: where it stops the motor at once, a fast one loses steps.
        """
        self._slowly = slowly
        self._device, self._axis, self._clock, self._side = device, axis, clock, side
        self._moves, self._full_step, self._far = moves, full_step, far
        self._out = 1 if side == "left" else -1
        """The way out of the switch."""
        self._edge: int | None = None
        self._met = 0
        """Where the counter was as the switch was seen to change last."""

    async def learn(self, nearest: int) -> None:
        """Find the edge from where the axis stands, going to `nearest` at most. Raises Failed, BenchError."""
        await self._slowly()
        if not await self._until(nearest, pressed=True):
            raise Failed(
                f"the {self._side} switch is not met until {nearest}: begin nearer to it, or let it go farther"
            )
        met = self._met
        self._edge = await self._found()
        if abs(self._edge - met) > LOST_FULLSTEPS * self._full_step:
            raise Failed(
                f"the {self._side} switch stops so heavy a load at once, and it loses steps by that: have the switch "
                "stop it by its ramp, or make the load lighter"
            )

    async def lost(self) -> float:
        """How many full steps were lost since it was learnt; afterwards the counter is right again.

        The axis is moved to near the edge as it is set. Raises Failed where the switch is not found again, BenchError.
        """
        assert self._edge is not None
        clear = round(CLEAR_FULLSTEPS * self._full_step)
        outside, inside = (self._edge + sign * self._out * clear for sign in (1, -1))
        beside = not await self._until(outside, pressed=True)
        await self._slowly()
        if beside and await self._until(inside, pressed=True):
            return 0.0
        return await self._mended(inside, self._edge)

    async def _mended(self, inside: int, edge: int) -> float:
        """Find it anew, and set the counter right, which stays between `inside` and the farthest place meanwhile."""
        taken = await self._met_anew(inside)
        period = round(PERIOD_FULLSTEPS * self._full_step)
        periods = round((taken + await self._found() - edge) / period)
        at = (await self._moves.state()).position
        await self._counter.set_position(self._axis, at + taken - periods * period)
        return abs(periods) * PERIOD_FULLSTEPS

    async def _met_anew(self, inside: int) -> int:
        """Go to the edge, wherever the axis is; what was taken from the counter for that. Raises Failed."""
        taken = 0
        if await self._pressed():
            taken = await self._counter.set_position(self._axis, inside)
            if await self._until(self._far, pressed=False):
                return taken
        for _ in range(SPANS_MAX):  # a load that runs on may have carried it farther than it was sent
            taken += await self._counter.set_position(self._axis, self._far)
            if await self._until(inside, pressed=True):
                return taken
        raise Failed(f"steps were lost, and the {self._side} switch is not found again: search the reference anew")

    @property
    def _counter(self) -> PositionSetting:
        return self._device.need(PositionSetting)

    async def _found(self) -> int:
        """Where the edge is, from near it: out of the switch, and in again by full steps. Raises Failed."""
        for _ in range(STEPS_MAX):
            if not await self._pressed():
                break
            await self._until(await self._beside(COARSE_FULLSTEPS), pressed=False)
        for _ in range(STEPS_MAX):
            before = await self._beside(0.0)
            if await self._until(await self._beside(-1.0), pressed=True):
                return round((before + await self._beside(0.0)) / 2)
        raise Failed(f"the edge of the {self._side} switch is not found again near where it was met")

    async def _beside(self, fullsteps: float) -> int:
        """So far out of the switch from where the axis stands."""
        return (await self._moves.state()).position + round(self._out * fullsteps * self._full_step)

    async def _pressed(self) -> bool:
        return is_pressed(await self._moves.state(), self._side)

    async def _until(self, target: int, *, pressed: bool) -> bool:
        """Go to `target` until the switch is so, and rest; whether it was: a rotor at its edge may swing out of it.

        Raises Failed, BenchError.
        """
        moves = self._moves
        before = (await moves.state()).position
        met = await go_until_switch(self._device, self._axis, self._clock, self._side, target, pressed=pressed)
        if way := abs((await moves.state()).position - before):
            moves.way_fullsteps += way / self._full_step
            await self._clock.sleep(REST_S)
        if met is not None:
            self._met = met.at
        return met is not None or await self._pressed() == pressed
