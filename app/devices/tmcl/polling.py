"""The axis as it is now, and the task that looks on while a motion is under way."""

from __future__ import annotations

import asyncio
import contextlib

from ...calc.positions.extended import Counter
from ...errors import BadReply, BenchError, LinkDown, LinkError, LinkTimeout, UnknownParameter
from ...links.queue import Priority, SampleDropped
from ...links.tmcl import Request
from ...registers.model import Register
from ...registers.tmcl.commands import DriverErrors, ExtendedErrors, Opcode
from ..core.motion_watch import POLL_S, Look, UnderWay
from ..core.results import AxisState, DeviceState, StopReason, Switches
from ..core.signs import EncoderSeen, Remedy, Signs
from . import encoder, rows
from . import signs as sign
from .calls import Calls
from .motion import STATUS
from .stops import Stops

STATE = (
    rows.ACTUAL_POSITION,
    rows.ENCODER,
    rows.ACTUAL_POSITION,
    rows.EXTERNAL_ENCODER,
    rows.ACTUAL_POSITION,
    rows.ACTUAL_SPEED,
    rows.TARGET_POSITION,
    rows.TARGET_SPEED,
    rows.POSITION_REACHED,
    rows.LEFT_SWITCH,
    rows.RIGHT_SWITCH,
    rows.HOME_SWITCH,
    rows.DRIVER_FLAGS,
    rows.STEP_DIRECTION,
)
"""Each encoder between two readings of the position: their mean is the position of the same moment."""
LOOK = (rows.ACTUAL_POSITION, rows.ACTUAL_SPEED, rows.POSITION_REACHED)
WHY = (
    rows.ACTUAL_POSITION,
    rows.ACTUAL_SPEED,
    rows.POSITION_REACHED,
    rows.LEFT_SWITCH,
    rows.RIGHT_SWITCH,
    rows.LEFT_DISABLED,
    rows.RIGHT_DISABLED,
    rows.DRIVER_FLAGS,
)
COUNTER = Counter(32)
FATAL = DriverErrors.OVERTEMPERATURE | DriverErrors.SHORT_A | DriverErrors.SHORT_B


class Looks(Stops):
    """A TMCL module that is looked at."""

    # --- state ----------------------------------------------------------------------------------

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        self.axis(axis)
        self.require_connected()
        async with self.calls(priority=priority) as calls:
            if self.unit_mode is None:
                await calls.ask_many((rows.UNIT_MODE,))
            asked_at_s = self.device_time_s()
            values = await calls.ask_many(STATE)
            position = calls.need(rows.ACTUAL_POSITION, values[4])
            speed = calls.need(rows.ACTUAL_SPEED, values[5])
            searching = (await calls.do(Request(self.address, Opcode.RFS, STATUS))).value != 0
            time_s = calls.time_s
        first, between = (position if value is None else value for value in (values[0], values[2]))
        encoder, external = values[1], values[3]
        target, target_speed, told_reached, left, right, home, driver, step_direction = values[6:]
        reached = self._reached(told_reached, position, target)
        # The encoder was read with the first position, and is told as if it were with the last.
        with_it = None if encoder is None else COUNTER.shows(encoder + COUNTER.way(position, first))
        self.saw_position(axis, position, asked_at_s, with_it)
        self._watch.look(Look(time_s, position, speed, reached), self._spread_s())
        mode = self._mode(bool(step_direction), searching, speed, target_speed or 0, reached)
        return AxisState(
            position=position,
            target_position=target if mode == "position" else None,
            velocity_pps=speed * self.speed_unit_pps,
            target_velocity_pps=target_speed * self.speed_unit_pps
            if mode in ("velocity", "hold") and target_speed is not None
            else None,
            acceleration_pps2=None,
            position_reached=reached and mode == "position",
            moving=self._moving(mode, speed, target_speed, reached),
            mode=mode,
            switches=Switches(*(None if active is None else bool(active) for active in (left, right, home))),
            flags=self._flags(driver),
            time_s=time_s,
            encoder_position=encoder,
            deviation=None if encoder is None else encoder - (first + between) / 2,
            external_encoder_position=external,
            external_deviation=None if external is None else external - (between + position) / 2,
        )

    ENCODER_REGISTERS = encoder.REGISTERS

    def encoder_remedies(self, axis: int, state: AxisState, seen: EncoderSeen) -> tuple[Remedy, ...]:
        return encoder.encoder_remedies(self, self.axis(axis).index, state, seen)

    def signs(self, axis: int, state: AxisState) -> Signs:
        return sign.signs(self, self.axis(axis).index, state)

    def _reached(self, told: int | None, position: int, target: int | None = None) -> bool:
        """Whether the axis is at its target: as the module tells, else by where it is and where it was sent."""
        if told is not None:
            return bool(told)
        if target is None and self._watch.under_way is not None:
            target = self._watch.under_way.target
        return position == target

    def _mode(self, step_direction: bool, searching: bool, speed: int, target_speed: int, reached: bool) -> str:
        """TMCL has no register of the mode: the latest command tells, and where none is known, what can be seen."""
        if step_direction:
            return "step/dir"
        if searching:
            return "reference search"
        driven = self._driven
        if driven in (None, "unknown", "search"):
            driven = "velocity" if target_speed or not (speed or reached) else "position"
        if driven == "position":
            return "position"
        return "velocity" if speed or target_speed else "hold"

    def _moving(self, mode: str, speed: int, target_speed: int | None, reached: bool) -> bool:
        """A speed of 0 is also that of a motor about to start, or turning round."""
        if speed or mode == "reference search":
            return True
        if mode == "velocity":
            return target_speed != 0 and self._watch.under_way is not None
        return mode == "position" and not reached and self._watch.under_way is not None

    def _flags(self, driver: int | None) -> dict[str, bool]:
        parts = () if driver is None else rows.DRIVER_FLAGS.fields
        flags = {part.name: bool(part.unpack(driver or 0)) for part in parts}
        flags["stall_stop"] = bool(self._latched & ExtendedErrors.STALL)
        flags["deviation_stop"] = bool(self._latched & ExtendedErrors.DEVIATION)
        return flags

    def _saw(self, register: Register, value: int) -> None:
        super()._saw(register, value)
        if register is rows.EXTENDED_ERROR_FLAGS:
            self._latched |= value
        elif register is rows.ACTUAL_SPEED and value and self._watch.under_way is None:
            self._watch.began("unknown", self.port.last_exchange_s)  # somebody else set it in motion

    # --- looking on -----------------------------------------------------------------------------

    _looking: asyncio.Task[None] | None = None

    def _look_on(self) -> None:
        if self._looking is None or self._looking.done():
            self._looking = self._begin(self._look_until_rest(), "motion of")

    async def _look_until_rest(self) -> None:
        while self._watch.under_way is not None:
            await self.background.sleep(POLL_S)
            try:
                await self._look_once()
            except SampleDropped:
                continue  # the link is busy; later then
            except BadReply:
                continue  # noise: asked again often enough for now
            except LinkError as error:
                self._lose_sight(str(error))
            except BenchError:
                continue

    async def _look_once(self) -> None:
        watch = self._watch
        # Telemetry that asks for the same looks often enough: one set of questions is enough for both.
        if self.device_time_s() - watch.looked_s > POLL_S * self._time_scale():
            async with self.calls(priority=Priority.SAMPLE) as calls:
                asked_at_s = self.device_time_s()
                told_position, told_speed, reached = await calls.ask_many(LOOK)
                position = calls.need(rows.ACTUAL_POSITION, told_position)
                speed = calls.need(rows.ACTUAL_SPEED, told_speed)
                time_s = calls.time_s
            self.saw_position(0, position, asked_at_s)
            watch.look(Look(time_s, position, speed, self._reached(reached, position)), self._spread_s())
        rests = watch.at_rest(self.device_time_s())
        if rests is not None:
            async with self.calls(priority=Priority.SAMPLE) as calls:
                why = await self._why(calls, *rests)
            if why is not None and watch.under_way is rests[0]:
                watch.end(*why)

    def _time_scale(self) -> float:
        """How fast device time runs."""
        wire = getattr(self.port, "wire", None)
        scale = getattr(getattr(wire, "clock", None), "scale", 1.0)
        return float(scale)

    def _spread_s(self) -> float:
        """How long the questions of one look take on this link, about [s]."""
        possible = self.calls_per_s_possible
        return 0.0 if possible is None else len(STATE) / possible

    async def _why(self, calls: Calls, motion: UnderWay, rest: Look) -> tuple[StopReason, str] | None:
        """Why the motor rests; None where it only pauses."""
        if (await calls.do(Request(self.address, Opcode.RFS, STATUS))).value:
            return None
        position, speed, told, left, right, left_off, right_off, driver = await calls.ask_many(WHY)
        reached = self._reached(told, rest.position)
        if speed or position != rest.position:
            return None
        if motion.stopped_s is not None:
            return "stop_command", "stopped on command"
        if motion.kind == "search":
            self._driven = None
            return "target_reached", "the reference search has ended"
        # Reading AP 207 clears it, so once and only now; a lost answer loses the flags too, and they stay unknown.
        with contextlib.suppress(BadReply, LinkTimeout, UnknownParameter):
            await calls.get(rows.EXTENDED_ERROR_FLAGS)
        if self._latched & ExtendedErrors.STALL:
            return "stall", "StallGuard stopped the motor (AP 207)"
        if self._latched & ExtendedErrors.DEVIATION:
            return "deviation", "an encoder's deviation stopped the motor (AP 207)"
        if driver is not None and driver & FATAL:
            names = [part.name for part in rows.DRIVER_FLAGS.fields if part.unpack(driver & FATAL)]
            return "driver_error", f"the driver reports {', '.join(names)} (AP 208)"
        if motion.direction <= 0 and left and not left_off:
            return "left_switch", "the left stop switch is active"
        if motion.direction >= 0 and right and not right_off:
            return "right_switch", "the right stop switch is active"
        if reached and motion.kind != "velocity":
            return "target_reached", "at its target"
        return "unknown", "the motor rests, and nothing that the module tells says why"

    # --- lost sight of --------------------------------------------------------------------------

    def set_state(self, state: DeviceState, problem: BenchError | None = None) -> None:
        super().set_state(state, problem)
        if state == "failed":
            self.lacking.clear()
            self._known.clear()  # it may be another module, or the same after a power-on, when it comes back
            self._driven = None
            self._book.end(self.device_time_s(), "the link failed")
            if isinstance(problem, LinkDown | LinkTimeout):
                self._lose_sight(str(problem))

    def _lose_sight(self, why: str) -> None:
        if self._watch.under_way is not None:
            self._watch.end("lost_link", f"the link failed while it moved; what it did then is not known: {why}")
