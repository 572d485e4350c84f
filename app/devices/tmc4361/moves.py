"""Positioning and rotation, and what is expected of them. Nothing here is ever sent twice.

Everything that a motion needs goes out in one chain of datagrams, whose order sees to it that nothing moves before the
last one: XTARGET is where the axis stands until the mode and the speed are right. An axis that turns already goes over
into the new motion without a stop.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ...calc.positions.extended import Counter
from ...calc.ramps.sramp_plan import SRampPlan
from ...calc.units.mechanics import RATE_UNITS
from ...clock import Clock
from ...errors import CannotMove, LinkError, OutOfRange, UsageError, WriteRefused, WrongState
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
from . import prediction as foresight
from . import rows
from .events import Events
from .setting import Setting
from .switches import stopped_by

COUNTER = Counter(32)
LOWEST, HIGHEST = -(1 << 31), (1 << 31) - 1
STATE = (rows.XACTUAL, rows.VACTUAL, rows.AACTUAL, rows.STATUS)
HOLDS = {
    "STOPL_EVENT": "STOPL_ACTIVE_F",
    "STOPR_EVENT": "STOPR_ACTIVE_F",
    "VSTOPL_ACTIVE": "VSTOPL_ACTIVE_F",
    "VSTOPR_ACTIVE": "VSTOPR_ACTIVE_F",
    "STOP_ON_STALL": "ACTIVE_STALL_F",
}
"""Events that keep the motor from a direction, and the flags of what has caused them."""


@dataclass(slots=True)
class Before:
    """The axis right before it is sent somewhere. Positions in microsteps, velocity in pps, acceleration in pps^2."""

    setting: Setting
    position: int
    velocity: int
    acceleration: int
    target: int
    flags: dict[str, int]
    reference: dict[str, int]
    warnings: list[str] = field(default_factory=list)

    @property
    def stands(self) -> bool:
        return self.velocity == 0 and self.acceleration == 0

    def blocked(self, way: int) -> str:
        """What stops motion that way (+1, -1); "" where nothing does."""
        return stopped_by(self.flags, self.reference, way)


class Moves(Events):
    """A TMC4361 that is sent somewhere."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self._watch = MotionWatch(rows.AXIS, self._tell_end, self._look_on)

    # --- moves ----------------------------------------------------------------------------------

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        """One move, of the one axis. Speed and shape are those the user has set, whatever a stop or a rotation has
        written over them."""
        if len(moves) != 1:
            raise UsageError(f"a {self.family.title} has one axis, so a move is of one axis")
        return [await self._move(moves[0])]

    async def move_in_steps(
        self, axis: int, target: int, *, relative: bool = False, velocity_pps: float | None = None
    ) -> MoveStarted:
        """For procedures: go in hold mode, in which the velocity jumps, at `velocity_pps` (None: as it is set) [pps].

        What the user has set for moves is kept in mind, and comes back with the next one. Raises what `move` raises.
        """
        speed = None if velocity_pps is None else round(velocity_pps * 256)
        return await self._move(AxisMove(axis, target, relative), rows.HOLD, speed)

    async def stand_ready(self, axis: int) -> None:
        """For procedures: positioning again with the user's ramps and speed limit, the target where the axis stands.

        Raises WrongState while the axis moves.
        """
        axis = self.axis(axis).index
        self.require_connected()
        async with self._command(axis) as turn:
            words = self.words(turn)
            before = await self._prepare(words)
            if not before.stands:
                raise WrongState(f"axis {axis} moves", "stop it first")
            self.commanded(axis, "stand_ready")
            mode = rows.POSITIONING_BIT | self.cruise.shape
            here, hold = _put(rows.XTARGET, before.position), Write(rows.RAMPMODE, rows.POSITIONING_BIT)
            writes = (here, hold, self._vmax(self.cruise.speed), Write(rows.RAMPMODE, mode))
            checked = (rows.XTARGET, rows.VMAX, rows.RAMPMODE)
            self._saw(Held(checked, (await words.chain(*writes, checked))[0]))

    async def _move(self, move: AxisMove, shape: int | None = None, speed: int | None = None) -> MoveStarted:
        """A move on ramps of `shape` at `speed` [1/256 pps]; None for the user's."""
        axis = self.axis(move.axis).index
        self.require_connected()
        async with self._command(axis) as turn:
            words = self.words(turn)
            before = await self._prepare(words)
            shape = self.cruise.shape if shape is None else shape
            speed = self.cruise.speed if speed is None else speed
            before.setting.require_motion(shape)
            if speed == 0:
                raise CannotMove("the axis cannot move: VMAX is 0", "write VMAX, in 1/256 pps", axis)
            target = self._target(move, before)
            before.warnings += before.setting.units.warnings("VMAX", speed / 256, positioning=True)
            if self.limiter is not None:
                self.limiter.require_target(axis, COUNTER.shows(target), before.position)
            mode = rows.POSITIONING_BIT | shape
            writes = self._writes_of_move(before, target, mode, speed)
            self.allow(writes)
            await self._release(words, before)
            waits = before.setting.gates()[0]
            back = await self._set_off(words, writes, "position", target)
            if not waits:
                self._check_back(back, ((rows.XTARGET, target), (rows.RAMPMODE, mode)))
            plan = None if waits else self._plan_to(before, target, shape, speed)
            started_s = words.time_s
            self._expect(started_s, before.position, plan)
        self._tell(MotionStarted(axis, started_s))
        duration_s = plan.duration_s if plan is not None else None
        return MoveStarted(axis, before.position, target, started_s, duration_s, before.warnings)

    def _target(self, move: AxisMove, before: Before) -> int:
        wanted = to_position(self.mechanics(move.axis), move.target, move.unit)
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
        self._warn_of_gates(before, ("XTARGET",))
        return target

    def _writes_of_move(self, before: Before, target: int, mode: int, speed: int) -> list[Write]:
        setting = before.setting
        limit = self._vmax(speed)
        other_speed = abs(setting.value(rows.VMAX)) != speed
        if setting.positioning:
            to_mode = [Write(rows.RAMPMODE, mode)] if setting.mode != mode else []
            # The speed behind the target: with VMAX 0 the old target would be gone to first.
            return [*to_mode, _put(rows.XTARGET, target), *([limit] if other_speed else [])]
        if setting.gates()[0]:
            raise WrongState(
                "XTARGET waits for a start signal and the mode is velocity: it would set off to its old target",
                "write RAMPMODE (positioning) with XTARGET at XACTUAL first, or clear START_CONF.start_en[0]",
            )
        if before.stands:
            # From here to the last datagram the target is where the axis stands, and nothing moves.
            begin = [_put(rows.XTARGET, before.position), Write(rows.RAMPMODE, mode)]
            return [*begin, *([limit] if other_speed else []), _put(rows.XTARGET, target)]
        # In velocity mode VMAX is the target velocity: until the mode is changed it keeps the direction.
        faster = [self._vmax(speed if before.velocity >= 0 else -speed)] if other_speed else []
        return [_put(rows.XTARGET, target), *faster, Write(rows.RAMPMODE, mode)]

    # --- rotation -------------------------------------------------------------------------------

    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        """In velocity mode, on ramps of the shape that is set. Raises OutOfRange with the chip's limit in `unit`."""
        axis = self.axis(axis).index
        self.require_connected()
        async with self._command(axis) as turn:
            words = self.words(turn)
            before = await self._prepare(words)
            before.setting.require_motion(self.cruise.shape)
            vmax = self._speed(axis, velocity, unit, before)
            writes = self._writes_of_rotation(before, vmax)
            if self.limiter is not None:
                self.limiter.require_way(axis, vmax, before.position)
                self.allow(writes)
            if vmax:
                switch = before.blocked(1 if vmax > 0 else -1)
                if switch:
                    before.warnings.append(f"the {switch} is active and stops motion that way")
                await self._release(words, before)
            self._warn_of_gates(before, ("VMAX", "RAMPMODE"))
            back = await self._set_off(words, writes, "velocity", None, vmax)
            if not any(before.setting.gates()[1:]):
                self._check_back(back, ((rows.VMAX, vmax), (rows.RAMPMODE, self.cruise.shape)))
            started_s = words.time_s
            if vmax == 0:
                self._watch.stop_commanded(started_s)
            plan = foresight.to_velocity(
                before.setting, self.cruise.shape, vmax / 256, before.velocity, before.acceleration
            )
            self._expect(started_s, before.position, plan)
        self._tell(MotionStarted(axis, started_s))
        return Rotating(axis, vmax, vmax / 256, before.warnings)

    def _speed(self, axis: int, velocity: float, unit: str, before: Before) -> int:
        """A velocity as VMAX, in 1/256 pps. Raises OutOfRange with the limits in `unit`."""
        one = self._one_speed(axis, unit)
        limit_pps = before.setting.units.limits("VMAX").highest
        limit = limit_pps * 256 * one
        # Rounded up by a hair: what a client got with fewer digits has to fit.
        if not abs(velocity) <= limit * (1 + 1e-9):
            raise OutOfRange("velocity", velocity, -limit, limit, f"{unit}; {limit_pps:.0f} pps are the chip's limit")
        vmax = max(-round(limit_pps * 256), min(round(limit_pps * 256), round(velocity / one)))
        if vmax == 0 and velocity:
            raise OutOfRange("velocity", velocity, one, limit, f"{unit}; less than 1/256 pps is a standstill")
        if self.limiter is not None:
            self.limiter.require_velocity(axis, velocity / one / 256)
            vmax = self.limiter.rounded(axis, vmax, 1 / 256)
        before.warnings += before.setting.units.warnings("VMAX", vmax / 256)
        return vmax

    def _one_speed(self, axis: int, unit: str) -> float:
        """How much of `unit` a VMAX of 1 is. Raises UsageError for a unit that the axis does not have."""
        if unit == CHIP:
            return 1.0
        spelled = SPELLINGS.get(unit, unit)
        if spelled not in RATE_UNITS:
            raise UsageError(f"{unit!r} is no unit of velocity; there are {', '.join((*RATE_UNITS, CHIP))}")
        try:
            return float(self.mechanics(axis).from_microsteps(1 / 256, spelled))
        except ValueError as error:
            raise UsageError(str(error)) from error

    def _writes_of_rotation(self, before: Before, vmax: int) -> list[Write]:
        mode, speed = Write(rows.RAMPMODE, self.cruise.shape), self._vmax(vmax)
        if not before.setting.positioning:
            return [speed] if before.setting.mode == self.cruise.shape else [speed, mode]
        if before.stands:
            # At its target nothing moves, whatever VMAX is; the mode sets it off.
            return [_put(rows.XTARGET, before.position), speed, mode]
        # 0 must not be written while positioning (DS-TMC4361 8.2.2); any other VMAX only changes the limit.
        return [speed, mode] if vmax else [mode, speed]

    # --- together -------------------------------------------------------------------------------

    async def _prepare(self, words: Words) -> Before:
        """Read what decides, and refuse what cannot go well. Nothing moves."""
        registers = (*rows.RAMP, rows.REFERENCE_CONF, rows.XTARGET, *STATE)
        held = await self._peek(words, registers)
        if self._events & rows.event("FROZEN"):
            raise WrongState(
                "the chip is frozen (NFREEZE went low): nothing but a reset ends that",
                "write RESET_CLK_GATING.RESET_REG 0x525354, then set it up again",
            )
        return Before(
            Setting(held.words),
            held.value(rows.XACTUAL),
            held.value(rows.VACTUAL),
            held.value(rows.AACTUAL),
            held.value(rows.XTARGET),
            held.fields(rows.STATUS),
            held.fields(rows.REFERENCE_CONF),
            self.clock_warnings(),
        )

    def _warn_of_gates(self, before: Before, wanted: Sequence[str]) -> None:
        gated = [
            name
            for name, waits in zip(("XTARGET", "VMAX", "RAMPMODE"), before.setting.gates(), strict=True)
            if waits and name in wanted
        ]
        if gated:
            before.warnings.append(f"{' and '.join(gated)} waits for a start signal (START_CONF)")

    async def _release(self, words: Words, before: Before) -> None:
        """Clear events of stops whose cause is gone: a direction stays closed until then (DS-TMC4361 9)."""
        gone = rows.event(
            *(name for name, flag in HOLDS.items() if self._events & rows.event(name) and not before.flags[flag])
        )
        if not gone:
            return
        if before.stands and before.setting.positioning and before.target != before.position:
            # Else it would set off to its old target as soon as the way is free.
            await words.write_many(((rows.XTARGET, to_raw(before.position, 32)),))
        await self._clear(words, gone)

    def _vmax(self, vmax: int) -> Write:
        return _put(rows.VMAX, vmax)

    async def _set_off(
        self, words: Words, writes: Sequence[Write], kind: Kind, target: int | None, speed: int = 0
    ) -> Held:
        """Send what sets the axis in motion, once; XTARGET, VMAX and RAMPMODE as they are then."""
        self.allow(writes)
        checked = (rows.XTARGET, rows.VMAX, rows.RAMPMODE)
        if kind == "position" and target is not None:
            self.commanded(rows.AXIS, "move", target=target)
        else:
            self.commanded(rows.AXIS, "rotate", velocity=speed)
        for write in writes:
            if write.register is rows.VMAX:
                self.cruise.overwrite_vmax(write.register.decode(write.word))
            elif write.register is rows.RAMPMODE:
                self.cruise.overwrite_mode(write.word)
        try:
            back = Held(checked, (await words.chain(*writes, checked))[0])
        except LinkError as error:
            self._motion_uncertain(str(error))
            raise
        self._watch.began(kind, words.time_s, target)
        self._saw(back)
        return back

    def _check_back(self, back: Held, wanted: Sequence[tuple[Register, int]]) -> None:
        for register, value in wanted:
            if back.value(register) != value:
                raise WriteRefused(
                    register.name, to_raw(value, 32), back.word(register), "the axis may be under way: stop it"
                )

    def _plan_to(self, before: Before, target: int, shape: int, speed: int) -> SRampPlan | None:
        if before.reference["circular_movement_en"]:
            return None  # the shorter way round; X_RANGE cannot be read
        return foresight.to_position(
            before.setting,
            shape,
            speed / 256,
            COUNTER.way(target, before.position),
            before.velocity,
            before.acceleration,
        )

    def _expect(self, started_s: float, position: int, plan: SRampPlan | None) -> None:
        if plan is None:
            self._book.end(started_s, "another command")
        else:
            self._book.add(PlannedMotion(rows.AXIS, started_s, position, plan))

    def _motion_uncertain(self, why: str) -> None:
        now_s = self.device_time_s()
        self._book.end(now_s, why)
        self._watch.began("unknown", now_s)

    # --- ends -----------------------------------------------------------------------------------

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        self.axis(axis)
        return self._watch.ends

    def _tell_end(self, end: MotionEnd) -> None:
        present = self._book.present()
        if present is not None and (end.reason != "target_reached" or not present.ends):
            self._book.end(end.time_s, end.detail)
        self._tell(end)

    def _look_on(self) -> None:
        """Have looks come until the motion under way has ended."""
        raise NotImplementedError


def _put(register: Register, value: int) -> Write:
    return Write(register, to_raw(value, register.width))
