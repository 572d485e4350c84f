"""Positioning. Nothing here is ever sent twice.

XTARGET is where the axis stands until the mode and the speed are right. An axis that turns already goes over into the
new motion without a stop.
"""

from __future__ import annotations

from ...calc.ramps.sramp_plan import SRampPlan
from ...errors import CannotMove, OutOfRange, WrongState
from ...number_text import plain
from ..core.axis_units import to_position
from ..core.capabilities import VelocityJumps
from ..core.events import MotionStarted
from ..core.register_io import Snapshot, Write
from ..core.register_link import RegisterLink
from ..core.results import AxisMove, MoveStarted
from ..core.start_gate import ready_to_start
from . import prediction, roles
from .cruise import Cruise
from .departure import COUNTER, Before, Departure, put
from .expected_motion import ExpectedMotion
from .memory import ChipMemory

LOWEST, HIGHEST = -(1 << 31), (1 << 31) - 1


class Moves(VelocityJumps):
    """Sends the axis of one TMC4361 to a position."""

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

    async def move_in_steps(
        self, axis: int, target: int, *, relative: bool = False, velocity_pps: float | None = None
    ) -> MoveStarted:
        """For procedures: go in hold mode, in which the velocity jumps, at `velocity_pps` (None: as it is set) [pps].

        What the user has set for moves is kept in mind, and comes back with the next one. Raises what `move` raises.
        """
        speed = None if velocity_pps is None else round(velocity_pps * 256)
        return await self.go(AxisMove(axis, target, relative), roles.HOLD, speed)

    async def stand_ready(self, axis: int) -> None:
        """For procedures: positioning again with the user's ramps and speed limit, the target where the axis stands.

        Raises WrongState while the axis moves.
        """
        axis = self._session.axis(axis).index
        self._session.require_connected()
        async with self._link.command(axis) as turn:
            io = self._link.io(turn)
            before = await self._departure.prepare(io)
            if not before.stands:
                raise WrongState(f"axis {axis} moves", "stop it first")
            self._session.commanded(axis, "stand_ready")
            mode = roles.POSITIONING_BIT | self._cruise.shape
            here, hold = put(roles.XTARGET, before.position), Write(roles.RAMPMODE, roles.POSITIONING_BIT)
            writes = (here, hold, put(roles.VMAX, self._cruise.speed), Write(roles.RAMPMODE, mode))
            checked = (roles.XTARGET, roles.VMAX, roles.RAMPMODE)
            self._memory.saw_all(Snapshot(checked, (await io.chain(*writes, checked))[0]))

    async def go(self, move: AxisMove, shape: int | None = None, speed: int | None = None) -> MoveStarted:
        """A move on ramps of `shape` at `speed` [1/256 pps]; None for the user's."""
        axis = self._session.axis(move.axis).index
        self._session.require_connected()
        async with self._link.command(axis) as turn:
            io = self._link.io(turn)
            before = await self._departure.prepare(io)
            shape = self._cruise.shape if shape is None else shape
            speed = self._cruise.speed if speed is None else speed
            before.ramp.require_motion(shape)
            if speed == 0:
                raise CannotMove("the axis cannot move: VMAX is 0", "write VMAX, in 1/256 pps", axis)
            target = self._target(move, before)
            before.warnings += before.ramp.units.warnings("VMAX", speed / 256, positioning=True)
            if self._session.limiter is not None:
                self._session.limiter.require_target(axis, COUNTER.shows(target), before.position)
            mode = roles.POSITIONING_BIT | shape
            writes = self._writes_of_move(before, target, mode, speed)
            self._link.allow(writes)
            await ready_to_start()
            await self._departure.release(io, before)
            waits = before.ramp.gates()[0]
            back = await self._departure.set_off(io, writes, "position", target)
            if not waits:
                self._departure.check_back(back, ((roles.XTARGET, target), (roles.RAMPMODE, mode)))
            plan = None if waits else self._plan_to(before, target, shape, speed)
            started_s = io.time_s
            self._expected.expect(started_s, before.position, plan)
        self._session.tell(MotionStarted(axis, started_s))
        duration_s = plan.duration_s if plan is not None else None
        return MoveStarted(axis, before.position, target, started_s, duration_s, before.warnings)

    def _target(self, move: AxisMove, before: Before) -> int:
        wanted = to_position(self._memory.mechanics(move.axis), move.target, move.unit)
        if move.unit == "microsteps" and wanted != move.target:
            before.warnings.append(f"rounded to {wanted} microsteps")
        target = before.position + wanted if move.relative else wanted
        shown = "" if move.unit == "microsteps" else f"; {plain(move.target)} {move.unit} asked"
        if not move.over_the_end and not LOWEST <= target <= HIGHEST:
            raise OutOfRange("target of axis 0", target, LOWEST, HIGHEST, f"microsteps{shown}")
        if not move.over_the_end and abs(target - before.position) > HIGHEST:
            raise OutOfRange(
                "distance of axis 0", target - before.position, -HIGHEST, HIGHEST, "microsteps: go in two moves"
            )
        way = COUNTER.way(target, before.position)
        switch = before.blocked(1 if way > 0 else -1) if way else ""
        if switch:
            before.warnings.append(f"the {switch} is active and stops motion that way")
        self._departure.warn_of_gates(before, ("XTARGET",))
        return target

    def _writes_of_move(self, before: Before, target: int, mode: int, speed: int) -> list[Write]:
        ramp = before.ramp
        limit = put(roles.VMAX, speed)
        other_speed = abs(ramp.value(roles.VMAX)) != speed
        if ramp.positioning:
            to_mode = [Write(roles.RAMPMODE, mode)] if ramp.mode != mode else []
            # The speed behind the target: with VMAX 0 the old target would be gone to first.
            return [*to_mode, put(roles.XTARGET, target), *([limit] if other_speed else [])]
        if ramp.gates()[0]:
            raise WrongState(
                "XTARGET waits for a start signal and the mode is velocity: it would set off to its old target",
                "write RAMPMODE (positioning) with XTARGET at XACTUAL first, or clear START_CONF.start_en[0]",
            )
        if before.stands:
            # From here to the last datagram the target is where the axis stands, and nothing moves.
            begin = [put(roles.XTARGET, before.position), Write(roles.RAMPMODE, mode)]
            return [*begin, *([limit] if other_speed else []), put(roles.XTARGET, target)]
        # In velocity mode VMAX is the target velocity: until the mode is changed it keeps the direction.
        faster = [put(roles.VMAX, speed if before.velocity >= 0 else -speed)] if other_speed else []
        return [put(roles.XTARGET, target), *faster, Write(roles.RAMPMODE, mode)]

    def _plan_to(self, before: Before, target: int, shape: int, speed: int) -> SRampPlan | None:
        if before.reference["circular_movement_en"]:
            return None  # the shorter way round; X_RANGE cannot be read
        return prediction.to_position(
            before.ramp,
            shape,
            speed / 256,
            COUNTER.way(target, before.position),
            before.velocity,
            before.acceleration,
        )
