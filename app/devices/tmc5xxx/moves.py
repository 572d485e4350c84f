"""Positioning and rotation, and what is expected of them. Nothing here is ever sent twice.

All that a motion needs goes out in one chain of datagrams, in an order in which nothing moves before the last one:
XTARGET is where the axis stands until mode and speed are right. Of several axes everything but XTARGET goes out first,
and then the targets in successive datagrams. An axis that turns already goes over into the new motion without a stop.

None of VMAX, AMAX and the rest can be read, so they are written each time, and the link has to show that they arrived.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...calc.ramps.sixpoint import MotionPlan
from ...calc.units.tmc5xxx import VELOCITY_MAX, velocity_unit_pps
from ...errors import BadReply, CannotMove, LinkError, OutOfRange, UsageError, WriteRefused
from ...number_text import plain
from ...registers.model import Register, to_raw
from ..core.axis_units import to_position, velocity_unit_in
from ..core.capabilities import Motion
from ..core.events import MotionStarted
from ..core.motion_watch import Kind
from ..core.prediction import Prediction
from ..core.register_io import RegisterIO, Snapshot, Write
from ..core.register_link import RegisterLink
from ..core.results import AxisMove, MoveStarted, Rotating, StopMode, StopOutcome
from ..core.session import Session
from ..core.sixpoint_plans import move_plan, turn_plan
from ..core.start_gate import ready_to_start
from . import roles as r
from .decoded_registers import DecodedRegisters
from .memory import ChipMemory
from .motions import Motions
from .predictions import Predictions
from .preparation import Before, Preparation
from .roles import HIGHEST, LOWEST, signed
from .stops import Stops

ARRIVAL_UNKNOWN = "the axis may be under way: stop it"


@dataclass(eq=False)
class SixPointMotion(Motion):
    """Sends axes somewhere by their ramp generators."""

    session: Session
    link: RegisterLink
    memory: ChipMemory
    decoded: DecodedRegisters
    preparation: Preparation
    predictions: Predictions
    motions: Motions
    stops: Stops

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        return await self.stops.stop_axes(axes, mode)

    def speed_limit_pps(self, axis: int) -> float:
        self.session.axis(axis)
        return self.session.clock_hz / 2

    def prediction(self, axis: int) -> Prediction | None:
        return self.predictions.book(self.session.axis(axis).index).present()

    # --- moves ----------------------------------------------------------------------------------

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        """Moves of one axis or both. Speed and acceleration are those the user has set, whatever a stop or a rotation
        has written over them."""
        axes = [self.session.axis(move.axis).index for move in moves]
        if not axes:
            raise UsageError("a move of no axis")
        if len(set(axes)) != len(axes):
            raise UsageError("an axis is in one move together only once")
        self.session.require_connected()
        async with self.session.queue.turn(guard=self.session.stop_guard(axes)) as turn:
            io = self.link.io(turn)
            befores = await self.preparation.prepare(io, axes)
            targets = []
            for move, before in zip(moves, befores, strict=True):
                before.ramp.require_move(before.axis)
                self._require_speed(before)
                before.warnings += before.ramp.warnings()
                targets.append(self._target(move, before))
            if self.session.limiter is not None:
                for before, target in zip(befores, targets, strict=True):
                    self.session.limiter.require_target(before.axis, target, before.position)
            ready, go = [], []
            for before, target in zip(befores, targets, strict=True):
                first, last = self._writes_of_move(before, target)
                ready += first
                go += last
            checked = [row for rows in map(self.memory.rows, axes) for row in (rows.xtarget, rows.rampmode)]
            self.link.allow([*ready, *go])
            await ready_to_start()
            back = await self._set_off(io, [*ready, *go], checked, "position", dict(zip(axes, targets, strict=True)))
            for axis, target in zip(axes, targets, strict=True):
                rows = self.memory.rows(axis)
                self._check_back(back, ((rows.xtarget, target), (rows.rampmode, r.POSITION)))
            started_s = io.time_s
            plans = [self._plan_to(before, target) for before, target in zip(befores, targets, strict=True)]
            for before, plan in zip(befores, plans, strict=True):
                self.predictions.expect(before.axis, started_s, before.position, plan)
        for axis in axes:
            self.session.tell(MotionStarted(axis, started_s))
        return [
            MoveStarted(
                before.axis,
                before.position,
                target,
                started_s,
                None if plan is None else plan.duration_s,
                before.warnings,
            )
            for before, target, plan in zip(befores, targets, plans, strict=True)
        ]

    def _require_speed(self, before: Before) -> None:
        """Raises CannotMove where the speed of moves was overwritten before anybody here knew it."""
        rows = self.memory.rows(before.axis)
        for row in (rows.vmax, rows.amax):
            if self.memory.wanted(row) is None and self.memory.overwritten(row):
                raise CannotMove(
                    f"{row.name} cannot be read, and a stop or a rotation has written over what it was",
                    f"write {row.name}",
                    before.axis,
                )

    def _target(self, move: AxisMove, before: Before) -> int:
        wanted = to_position(self.decoded.mechanics(move.axis), move.target, move.unit)
        if move.unit == "microsteps" and wanted != move.target:
            before.warnings.append(f"rounded to {wanted} microsteps")
        target = before.position + wanted if move.relative else wanted
        distance = target - before.position
        if move.over_the_end:
            distance = signed(distance)
            target = signed(target)
        shown = "" if move.unit == "microsteps" else f"; {plain(move.target)} {move.unit} asked"
        if not LOWEST <= target <= HIGHEST:
            raise OutOfRange(f"target of axis {move.axis}", target, LOWEST, HIGHEST, f"microsteps{shown}")
        if abs(distance) > HIGHEST:
            raise OutOfRange(
                f"distance of axis {move.axis}", distance, -HIGHEST, HIGHEST, "microsteps: go in two moves"
            )
        switch = before.blocked(1 if distance > 0 else -1) if distance else ""
        if switch:
            before.warnings.append(f"the {switch} is active and stops motion that way")
        return target

    def _writes_of_move(self, before: Before, target: int) -> tuple[list[Write], list[Write]]:
        """What may go out before any axis is to move, and what sets this one off."""
        rows = self.memory.rows(before.axis)
        speed = [
            Write(row, wanted) for row in (rows.amax, rows.vmax) if (wanted := self.memory.wanted(row)) is not None
        ]  # nothing is known to write where another master has set it, and it is still that
        to_mode, to_target = Write(rows.rampmode, r.POSITION), _put(rows.xtarget, target)
        if before.stands:
            # From here to the last datagram the target is where the axis stands, and nothing moves.
            return [_put(rows.xtarget, before.position), to_mode, *speed], [to_target]
        if before.positioning:
            # The speed behind the target: with VMAX 0 the old target would be gone to first.
            return [], [to_target, *speed]
        # VMAX is the target velocity still; the mode makes it the limit again.
        return [], [to_target, to_mode, *speed]

    # --- rotation -------------------------------------------------------------------------------

    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        """In velocity mode, by AMAX. Raises OutOfRange with the chip's limit in `unit`."""
        axis = self.session.axis(axis).index
        self.session.require_connected()
        rows = self.memory.rows(axis)
        async with self.link.command(axis) as turn:
            io = self.link.io(turn)
            before = (await self.preparation.prepare(io, [axis]))[0]
            before.ramp.require_acceleration(axis)
            self._require_acceleration_known(axis)
            speed = self._speed(axis, velocity, unit, before)
            if self.session.limiter is not None:
                self.session.limiter.require_way(axis, speed, before.position)
            if speed:
                switch = before.blocked(1 if speed > 0 else -1)
                if switch:
                    before.warnings.append(f"the {switch} is active and stops motion that way")
            mode = r.FORWARD if speed >= 0 else r.BACKWARD
            amax = self.memory.wanted(rows.amax)
            writes = [
                *([] if amax is None else [Write(rows.amax, amax)]),
                Write(rows.vmax, abs(speed)),
                Write(rows.rampmode, mode),
            ]
            if before.positioning and before.stands:
                writes.insert(0, _put(rows.xtarget, before.position))  # else VMAX alone might set it off
            back = await self._set_off(io, writes, (rows.rampmode,), "velocity", {axis: None}, speed)
            self._check_back(back, ((rows.rampmode, mode),))
            started_s = io.time_s
            if speed == 0:
                self.motions.of(axis).stop_commanded(started_s)
            plan = turn_plan(
                before.ramp.sixpoint(vmax=abs(speed) or 1), speed * before.ramp.velocity_unit_pps, before.velocity_pps
            )
            self.predictions.expect(axis, started_s, before.position, plan)
        self.session.tell(MotionStarted(axis, started_s))
        return Rotating(axis, speed, speed * before.ramp.velocity_unit_pps, before.warnings)

    def _require_acceleration_known(self, axis: int) -> None:
        row = self.memory.rows(axis).amax
        if self.memory.overwritten(row) and self.memory.wanted(row) is None:
            raise CannotMove("AMAX cannot be read, and a stop has written over what it was", "write AMAX", axis)

    def _speed(self, axis: int, velocity: float, unit: str, before: Before) -> int:
        """A velocity in chip units, with its sign. Raises OutOfRange with the limits in `unit`."""
        one = velocity_unit_in(unit, self.decoded.mechanics(axis), velocity_unit_pps(self.session.clock_hz))
        exact = velocity / one
        limit = VELOCITY_MAX * one
        # Rounded up by a hair: a limit has to fit although a client sent it with fewer digits.
        if not abs(exact) <= VELOCITY_MAX * (1 + 1e-6):
            raise OutOfRange("velocity", velocity, -limit, limit, f"{unit}; {VELOCITY_MAX} is the chip's limit")
        speed = max(-VELOCITY_MAX, min(VELOCITY_MAX, round(exact)))
        if speed == 0 and velocity:
            raise OutOfRange("velocity", velocity, one, limit, f"{unit}; less than one chip unit is a standstill")
        if self.session.limiter is not None:
            self.session.limiter.require_velocity(axis, exact * before.ramp.velocity_unit_pps)
            speed = self.session.limiter.rounded(axis, speed, before.ramp.velocity_unit_pps)
        if speed and abs(speed / exact - 1) > 0.01:
            before.warnings.append(f"rounded to {speed} chip units, {plain(speed * one, 6)} {unit}")
        return speed

    # --- together -------------------------------------------------------------------------------

    async def _set_off(
        self,
        io: RegisterIO,
        writes: Sequence[Write],
        checked: Sequence[Register],
        kind: Kind,
        targets: dict[int, int | None],
        speed: int = 0,
    ) -> Snapshot:
        """Send what sets axes in motion, once; `checked` as they are then. `speed` is that of a rotation, signed."""
        self.link.allow(writes)
        for axis, target in targets.items():
            if kind == "position" and target is not None:
                self.session.commanded(axis, "move", target=target)
            else:
                self.session.commanded(axis, "rotate", velocity=speed)
        for write in writes:
            if not write.register.access.readable:
                self.memory.overwrite(write.register, write.word)
        try:
            back = Snapshot(checked, (await io.chain(*writes, checked))[0])
        except LinkError as error:
            for axis in targets:
                self.motions.uncertain(axis, str(error))
            raise
        for axis, target in targets.items():
            self.motions.of(axis).began(kind, io.time_s, target)
        self.memory.saw(back)
        if not io.arrived:
            raise BadReply(self.session.port.name, f"what was sent may have arrived otherwise; {ARRIVAL_UNKNOWN}", b"")
        return back

    def _check_back(self, back: Snapshot, wanted: Sequence[tuple[Register, int]]) -> None:
        for register, value in wanted:
            if back.value(register) != value:
                raise WriteRefused(register.name, to_raw(value, 32), back.word(register), ARRIVAL_UNKNOWN)

    def _plan_to(self, before: Before, target: int) -> MotionPlan | None:
        return move_plan(before.ramp.sixpoint(), signed(target - before.position), before.velocity_pps)


def _put(register: Register, value: int) -> Write:
    return Write(register, to_raw(value, register.width))
