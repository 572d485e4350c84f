"""Positioning and rotation, and what is expected of them. Nothing here is ever sent twice.

All that a motion needs goes out in one chain of datagrams, in an order in which nothing moves before the last one:
XTARGET is where the axis stands until mode and speed are right. Of several axes everything but XTARGET goes out first,
and then the targets in successive datagrams. An axis that turns already goes over into the new motion without a stop.

None of VMAX, AMAX and the rest can be read, so they are written each time, and the link has to show that they arrived.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ...calc.ramps.sixpoint import MotionPlan
from ...calc.units.mechanics import RATE_UNITS
from ...calc.units.tmc5xxx import VELOCITY_MAX, velocity_unit_pps
from ...clock import Clock
from ...errors import BadReply, CannotMove, LinkError, OutOfRange, UsageError, WriteRefused
from ...links.port import FramePort
from ...number_text import plain
from ...registers.model import Register, to_raw
from ..core.axis_units import CHIP, SPELLINGS, to_position
from ..core.config import DeviceConfig
from ..core.device import MotionStarted
from ..core.motion_watch import Kind, MotionWatch
from ..core.planned_motion import PlannedMotion
from ..core.register_io import Held, Words, Write
from ..core.results import AxisMove, MotionEnd, MoveStarted, Rotating
from ..core.sixpoint_plans import move_plan, turn_plan
from . import rows as r
from .events import Events
from .ramp import Ramp

LOWEST, HIGHEST = -(1 << 31), (1 << 31) - 1
ARRIVAL_DOUBTED = "the axis may be under way: stop it"


@dataclass(slots=True)
class Before:
    """The axis right before it is sent somewhere. Positions in microsteps, velocity in chip units."""

    axis: int
    ramp: Ramp
    mode: int
    position: int
    velocity: int
    target: int
    switches: dict[str, int]
    """SW_MODE and, where it could be read, RAMP_STAT by fields."""
    warnings: list[str] = field(default_factory=list)

    @property
    def stands(self) -> bool:
        return self.velocity == 0

    @property
    def positioning(self) -> bool:
        return self.mode == r.POSITION

    @property
    def velocity_pps(self) -> float:
        return self.velocity * self.ramp.velocity_unit_pps

    def blocked(self, way: int) -> str:
        """What stops motion that way (+1, -1); "" where nothing does."""
        side, name = ("l", "left switch") if way < 0 else ("r", "right switch")
        return name if self.switches[f"stop_{side}_enable"] and self.switches.get(f"status_stop_{side}") else ""


class Moves(Events):
    """A TMC5xxx that is sent somewhere."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self._watches = tuple(MotionWatch(axis.index, self._tell_end, self._look_on) for axis in self.axes)

    # --- moves ----------------------------------------------------------------------------------

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        """Moves of one axis or both. Speed and acceleration are those the user has set, whatever a stop or a rotation
        has written over them."""
        axes = [self.axis(move.axis).index for move in moves]
        if not axes:
            raise UsageError("a move of no axis")
        if len(set(axes)) != len(axes):
            raise UsageError("an axis is in one move together only once")
        self.require_connected()
        async with self.queue.turn(guard=self.stop_guard(axes)) as turn:
            words = self.words(turn)
            befores = await self._prepare(words, axes)
            targets = []
            for move, before in zip(moves, befores, strict=True):
                before.ramp.require_move(before.axis)
                self._require_speed(before)
                before.warnings += before.ramp.warnings()
                targets.append(self._target(move, before))
            if self.limiter is not None:
                for before, target in zip(befores, targets, strict=True):
                    self.limiter.require_target(before.axis, target, before.position)
            ready, go = [], []
            for before, target in zip(befores, targets, strict=True):
                first, last = self._writes_of_move(before, target)
                ready += first
                go += last
            checked = [row for axis in axes for row in (self.rows(axis).xtarget, self.rows(axis).rampmode)]
            back = await self._set_off(words, [*ready, *go], checked, "position", dict(zip(axes, targets, strict=True)))
            for axis, target in zip(axes, targets, strict=True):
                rows = self.rows(axis)
                self._check_back(back, ((rows.xtarget, target), (rows.rampmode, r.POSITION)))
            started_s = words.time_s
            plans = [self._plan_to(before, target) for before, target in zip(befores, targets, strict=True)]
            for before, plan in zip(befores, plans, strict=True):
                self._expect(before.axis, started_s, before.position, plan)
        for axis in axes:
            self._tell(MotionStarted(axis, started_s))
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
        rows = self.rows(before.axis)
        for row in (rows.vmax, rows.amax):
            if self.wanted(row) is None and row.address in self._overwritten:
                raise CannotMove(
                    f"{row.name} cannot be read, and a stop or a rotation has written over what it was",
                    f"write {row.name}",
                    before.axis,
                )

    def _target(self, move: AxisMove, before: Before) -> int:
        wanted = to_position(self.mechanics(move.axis), move.target, move.unit)
        if move.unit == "microsteps" and wanted != move.target:
            before.warnings.append(f"rounded to {wanted} microsteps")
        target = before.position + wanted if move.relative else wanted
        distance = target - before.position
        if move.over_the_end:
            distance = _signed(distance)
            target = _signed(target)
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
        rows = self.rows(before.axis)
        speed = [
            Write(row, wanted) for row in (rows.amax, rows.vmax) if (wanted := self.wanted(row)) is not None
        ]  # nothing is known to write where somebody else has set it, and it is still that
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
        axis = self.axis(axis).index
        self.require_connected()
        rows = self.rows(axis)
        async with self._command(axis) as turn:
            words = self.words(turn)
            before = (await self._prepare(words, [axis]))[0]
            before.ramp.require_acceleration(axis)
            self._require_acceleration_known(axis)
            speed = self._speed(axis, velocity, unit, before)
            if self.limiter is not None:
                self.limiter.require_way(axis, speed, before.position)
            if speed:
                switch = before.blocked(1 if speed > 0 else -1)
                if switch:
                    before.warnings.append(f"the {switch} is active and stops motion that way")
            mode = r.FORWARD if speed >= 0 else r.BACKWARD
            amax = self.wanted(rows.amax)
            writes = [
                *([] if amax is None else [Write(rows.amax, amax)]),
                Write(rows.vmax, abs(speed)),
                Write(rows.rampmode, mode),
            ]
            if before.positioning and before.stands:
                writes.insert(0, _put(rows.xtarget, before.position))  # else VMAX alone might set it off
            back = await self._set_off(words, writes, (rows.rampmode,), "velocity", {axis: None}, speed)
            self._check_back(back, ((rows.rampmode, mode),))
            started_s = words.time_s
            if speed == 0:
                self._watches[axis].stop_commanded(started_s)
            plan = turn_plan(
                before.ramp.sixpoint(vmax=abs(speed) or 1), speed * before.ramp.velocity_unit_pps, before.velocity_pps
            )
            self._expect(axis, started_s, before.position, plan)
        self._tell(MotionStarted(axis, started_s))
        return Rotating(axis, speed, speed * before.ramp.velocity_unit_pps, before.warnings)

    def _require_acceleration_known(self, axis: int) -> None:
        row = self.rows(axis).amax
        if row.address in self._overwritten and self.wanted(row) is None:
            raise CannotMove("AMAX cannot be read, and a stop has written over what it was", "write AMAX", axis)

    def _speed(self, axis: int, velocity: float, unit: str, before: Before) -> int:
        """A velocity in chip units, with its sign. Raises OutOfRange with the limits in `unit`."""
        one = self._one_speed(axis, unit)
        exact = velocity / one
        limit = VELOCITY_MAX * one
        # Rounded up by a hair: a limit has to fit although a client sent it with fewer digits.
        if not abs(exact) <= VELOCITY_MAX * (1 + 1e-6):
            raise OutOfRange("velocity", velocity, -limit, limit, f"{unit}; {VELOCITY_MAX} is the chip's limit")
        speed = max(-VELOCITY_MAX, min(VELOCITY_MAX, round(exact)))
        if speed == 0 and velocity:
            raise OutOfRange("velocity", velocity, one, limit, f"{unit}; less than one chip unit is a standstill")
        if self.limiter is not None:
            self.limiter.require_velocity(axis, exact * before.ramp.velocity_unit_pps)
            speed = self.limiter.rounded(axis, speed, before.ramp.velocity_unit_pps)
        if speed and abs(speed / exact - 1) > 0.01:
            before.warnings.append(f"rounded to {speed} chip units, {plain(speed * one, 6)} {unit}")
        return speed

    def _one_speed(self, axis: int, unit: str) -> float:
        """How much of `unit` a VMAX of 1 is. Raises UsageError for a unit that the axis does not have."""
        if unit == CHIP:
            return 1.0
        spelled = SPELLINGS.get(unit, unit)
        if spelled not in RATE_UNITS:
            raise UsageError(f"{unit!r} is no unit of velocity; there are {', '.join((*RATE_UNITS, CHIP))}")
        try:
            return float(self.mechanics(axis).from_microsteps(velocity_unit_pps(self.clock_hz), spelled))
        except ValueError as error:
            raise UsageError(str(error)) from error

    # --- together -------------------------------------------------------------------------------

    async def _prepare(self, words: Words, axes: Sequence[int]) -> list[Before]:
        """Read what decides, and see to it that nothing of the past holds the motor. Nothing moves."""
        asked = [self.chip.gconf]
        for axis in axes:
            rows = self.rows(axis)
            asked += [rows.rampmode, rows.xactual, rows.vactual, rows.xtarget, rows.chopconf]
        held = await self._peek(words, axes, asked)
        if any([await self._release(words, axis, held) for axis in axes]):
            held = await self._peek(words, axes, asked)
        return [self._before(axis, held) for axis in axes]

    def _before(self, axis: int, held: Held) -> Before:
        rows = self.rows(axis)
        switches = held.fields(rows.sw_mode)
        if rows.ramp_stat.address in held.words:
            switches |= held.fields(rows.ramp_stat)
        return Before(
            axis,
            self.ramp(axis),
            held.value(rows.rampmode),
            held.value(rows.xactual),
            held.value(rows.vactual),
            held.value(rows.xtarget),
            switches,
            self._warnings(axis),
        )

    def _warnings(self, axis: int) -> list[str]:
        """Why a motor would not turn, or not as it should, though the ramp runs."""
        rows = self.rows(axis)
        told = []
        chopconf, current = self.word(rows.chopconf), self.word(rows.ihold_irun)
        if chopconf is not None and not r.part(rows.chopconf, "toff").unpack(chopconf):
            told.append("CHOPCONF.toff is 0: the driver is off, and the motor has no current")
        if current is not None and not r.part(rows.ihold_irun, "IRUN").unpack(current):
            told.append("IRUN is 0: the motor runs at 1/32 of its full current")
        sw_mode = self.word(rows.sw_mode) or 0
        if r.part(rows.sw_mode, "sg_stop").unpack(sw_mode) and r.part(rows.sw_mode, "en_softstop").unpack(sw_mode):
            told.append("SW_MODE has sg_stop and en_softstop, which do not go together")
        if self._lost:
            told.append("the chip was reset (GSTAT): what was set before that is lost")
        return told

    async def _release(self, words: Words, axis: int, held: Held) -> bool:
        """End a stop by StallGuard, which would hold the axis; it goes nowhere until it is told to.

        Where RAMP_STAT may not be read, an axis that stands may be held by one.
        """
        rows = self.rows(axis)
        unread = rows.ramp_stat.address not in held.words
        if held.word(rows.vactual) or not (unread or self._stat[axis] & self.flags[axis].stall):
            return False
        await self._stand_still(words, axis)
        if not self.chip.clears_on_read:
            await self._clear(words, [axis], stall=True)
        return True

    async def _stand_still(self, words: Words, axis: int) -> None:
        """Take every reason to move from an axis that stands. Raises BadReply where that may not have arrived."""
        if not await words.write_many(self._standing_still(axis)):
            raise BadReply(self.port.name, "what was to keep the axis where it is may have arrived otherwise", b"")
        self._known[self.rows(axis).rampmode.address] = r.FORWARD

    def _standing_still(self, axis: int) -> list[tuple[Register, int]]:
        """Velocity mode with VMAX 0, in the order in which nothing moves in between."""
        rows = self.rows(axis)
        self._overwrite(rows.vmax, 0)
        self._known.pop(rows.rampmode.address, None)
        return [(rows.vmax, 0), (rows.rampmode, r.FORWARD)]

    def _goes_nowhere(self, axis: int) -> bool:
        rows = self.rows(axis)
        mode = self.known(rows.rampmode)
        return mode in (r.FORWARD, r.BACKWARD) and self.word(rows.vmax) == 0

    async def _set_off(
        self,
        words: Words,
        writes: Sequence[Write],
        checked: Sequence[Register],
        kind: Kind,
        targets: dict[int, int | None],
        speed: int = 0,
    ) -> Held:
        """Send what sets axes in motion, once; `checked` as they are then. `speed` is that of a rotation, signed."""
        self.allow(writes)
        for axis, target in targets.items():
            if kind == "position" and target is not None:
                self.commanded(axis, "move", target=target)
            else:
                self.commanded(axis, "rotate", velocity=speed)
        for write in writes:
            if not write.register.access.readable:
                self._overwrite(write.register, write.word)
        try:
            back = Held(checked, (await words.chain(*writes, checked))[0])
        except LinkError as error:
            for axis in targets:
                self._motion_uncertain(axis, str(error))
            raise
        for axis, target in targets.items():
            self._watches[axis].began(kind, words.time_s, target)
        self._saw(back)
        if not words.arrived:
            raise BadReply(self.port.name, f"what was sent may have arrived otherwise; {ARRIVAL_DOUBTED}", b"")
        return back

    def _check_back(self, back: Held, wanted: Sequence[tuple[Register, int]]) -> None:
        for register, value in wanted:
            if back.value(register) != value:
                raise WriteRefused(register.name, to_raw(value, 32), back.word(register), ARRIVAL_DOUBTED)

    def _plan_to(self, before: Before, target: int) -> MotionPlan | None:
        return move_plan(before.ramp.sixpoint(), _signed(target - before.position), before.velocity_pps)

    def _expect(self, axis: int, started_s: float, position: int, plan: MotionPlan | None) -> None:
        if plan is None:
            self._books[axis].end(started_s, "another command")
        else:
            self._books[axis].add(PlannedMotion(axis, started_s, position, plan))

    def _motion_uncertain(self, axis: int, why: str) -> None:
        now_s = self.device_time_s()
        self._books[axis].end(now_s, why)
        self._watches[axis].began("unknown", now_s)

    # --- ends -----------------------------------------------------------------------------------

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        return self._watches[self.axis(axis).index].ends

    def _tell_end(self, end: MotionEnd) -> None:
        book = self._books[end.axis]
        present = book.present()
        if present is not None and (end.reason != "target_reached" or not present.ends):
            book.end(end.time_s, end.detail)
        self._tell(end)

    def _look_on(self) -> None:
        """Have looks come until the motion under way has ended."""
        raise NotImplementedError


def _put(register: Register, value: int) -> Write:
    return Write(register, to_raw(value, register.width))


def _signed(count: int) -> int:
    """What a 32-bit counter shows: of a distance, the shorter way round."""
    return (count + (1 << 31)) % (1 << 32) - (1 << 31)
