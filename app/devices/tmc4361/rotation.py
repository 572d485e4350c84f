"""Turning on and on, in velocity mode. Nothing here is ever sent twice."""

from __future__ import annotations

from ...errors import OutOfRange
from ..core.axis_units import velocity_unit_in
from ..core.events import MotionStarted
from ..core.register_io import Write
from ..core.register_link import RegisterLink
from ..core.results import Rotating
from . import prediction, roles
from .cruise import Cruise
from .departure import Before, Departure, put
from .expected_motion import ExpectedMotion
from .memory import ChipMemory


class Rotation:
    """Has the axis of one TMC4361 turn at a velocity."""

    def __init__(
        self,
        link: RegisterLink,
        memory: ChipMemory,
        cruise: Cruise,
        departure: Departure,
        expected: ExpectedMotion,
    ) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._cruise = cruise
        self._departure = departure
        self._expected = expected

    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        """In velocity mode, on ramps of the shape that is set. Raises OutOfRange with the chip's limit in `unit`."""
        axis = self._session.axis(axis).index
        self._session.require_connected()
        async with self._link.command(axis) as turn:
            io = self._link.io(turn)
            before = await self._departure.prepare(io)
            before.ramp.require_motion(self._cruise.shape)
            vmax = self._speed(axis, velocity, unit, before)
            writes = self._writes_of_rotation(before, vmax)
            if self._session.limiter is not None:
                self._session.limiter.require_way(axis, vmax, before.position)
                self._link.allow(writes)
            if vmax:
                switch = before.blocked(1 if vmax > 0 else -1)
                if switch:
                    before.warnings.append(f"the {switch} is active and stops motion that way")
                await self._departure.release(io, before)
            self._departure.warn_of_gates(before, ("VMAX", "RAMPMODE"))
            back = await self._departure.set_off(io, writes, "velocity", None, vmax)
            if not any(before.ramp.gates()[1:]):
                self._departure.check_back(back, ((roles.VMAX, vmax), (roles.RAMPMODE, self._cruise.shape)))
            started_s = io.time_s
            if vmax == 0:
                self._expected.watch.stop_commanded(started_s)
            plan = prediction.to_velocity(
                before.ramp, self._cruise.shape, vmax / 256, before.velocity, before.acceleration
            )
            self._expected.expect(started_s, before.position, plan)
        self._session.tell(MotionStarted(axis, started_s))
        return Rotating(axis, vmax, vmax / 256, before.warnings)

    def _speed(self, axis: int, velocity: float, unit: str, before: Before) -> int:
        """A velocity as VMAX, in 1/256 pps. Raises OutOfRange with the limits in `unit`."""
        one = velocity_unit_in(unit, self._memory.mechanics(axis), 1 / 256)
        limit_pps = before.ramp.units.limits("VMAX").highest
        limit = limit_pps * 256 * one
        # Rounded up by a hair: what a client got with fewer digits has to fit.
        if not abs(velocity) <= limit * (1 + 1e-9):
            raise OutOfRange("velocity", velocity, -limit, limit, f"{unit}; {limit_pps:.0f} pps are the chip's limit")
        vmax = max(-round(limit_pps * 256), min(round(limit_pps * 256), round(velocity / one)))
        if vmax == 0 and velocity:
            raise OutOfRange("velocity", velocity, one, limit, f"{unit}; less than 1/256 pps is a standstill")
        if self._session.limiter is not None:
            self._session.limiter.require_velocity(axis, velocity / one / 256)
            vmax = self._session.limiter.rounded(axis, vmax, 1 / 256)
        before.warnings += before.ramp.units.warnings("VMAX", vmax / 256)
        return vmax

    def _writes_of_rotation(self, before: Before, vmax: int) -> list[Write]:
        mode, speed = Write(roles.RAMPMODE, self._cruise.shape), put(roles.VMAX, vmax)
        if not before.ramp.positioning:
            return [speed] if before.ramp.mode == self._cruise.shape else [speed, mode]
        if before.stands:
            # At its target nothing moves, whatever VMAX is; the mode sets it off.
            return [put(roles.XTARGET, before.position), speed, mode]
        # 0 must not be written while positioning (DS-TMC4361 8.2.2); any other VMAX only changes the limit.
        return [speed, mode] if vmax else [mode, speed]
