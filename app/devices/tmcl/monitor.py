"""How the axis is now: position, speed, switches and flags of one turn, and what else is known of it."""

from __future__ import annotations

import contextlib
from dataclasses import replace

from ...links.queue import Priority, SampleDropped
from ...links.tmcl import Request
from ...registers.tmcl.commands import ExtendedErrors, Opcode
from ..core.capabilities import AxisMonitor
from ..core.motion_watch import MotionReading
from ..core.results import AxisState, MotionEnd, Switches
from ..core.session import Session
from ..core.signs import Signs
from ..core.tmcl_frames import STATUS
from ..core.tmcl_link import TmclLink
from . import signs
from .counter import TickTimer
from .ongoing import OngoingMotion
from .state import ModuleState


class ModuleMonitor(AxisMonitor):
    """Asks the module for the state of its axis; `ongoing` hears what it tells of the motion under way."""

    def __init__(
        self, session: Session, state: ModuleState, link: TmclLink, ongoing: OngoingMotion, ticks: TickTimer
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._ongoing = ongoing
        self._ticks = ticks

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        state = await self._axis_state(axis, priority)
        if priority is Priority.SAMPLE:  # whoever polls all the time has to see a reset too
            with contextlib.suppress(SampleDropped):  # the line is busy: later then
                async with self._link.calls(priority=priority) as calls:
                    await self._ticks.reset_since(calls)
        return state

    def signs(self, axis: int, state: AxisState) -> Signs:
        found = signs.signs(self._state, self._session.axis(axis).index, state)
        return replace(found, resets=self._ticks.resets)

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        self._session.axis(axis)
        return self._ongoing.watch.ends

    async def _axis_state(self, axis: int, priority: Priority) -> AxisState:
        self._session.axis(axis)
        self._session.require_connected()
        async with self._link.calls(priority=priority) as calls:
            if None in self._state.counted_by:
                await calls.ask_many(self._state.roles.counting)
            asked_at_s = self._session.device_time_s()
            values = await calls.ask_many(self._state.roles.state)
            position = calls.need(self._state.roles.actual_position, values[4])
            speed = calls.need(self._state.roles.actual_speed, values[5])
            searching = (await calls.do(Request(self._link.address, Opcode.RFS, STATUS))).value != 0
            time_s = calls.time_s
            if self._state.program.runs:  # whose end nobody else would see without the page of programs
                status, counter = await calls.ask_many(self._state.roles.program)
                if status is not None:
                    self._state.program.saw(status, counter)
        first, between = (position if value is None else value for value in (values[0], values[2]))
        encoder, external = values[1], values[3]
        target, target_speed, told_reached, left, right, home, driver, step_direction = values[6:]
        reached = self._ongoing.reached(told_reached, position, target)
        # The encoder was read with the first position, and is told as if it were with the last.
        with_it = None if encoder is None else self._state.wrap.shows(encoder + self._state.wrap.way(position, first))
        self._session.saw_position(axis, position, asked_at_s, with_it)
        self._ongoing.watch.update(MotionReading(time_s, position, speed, reached), self._link.poll_spread_s)
        mode = self._mode(bool(step_direction), searching, speed, target_speed or 0, reached)
        return AxisState(
            position=position,
            target_position=target if mode == "position" else None,
            velocity_pps=speed * self._state.speed_unit_pps,
            target_velocity_pps=target_speed * self._state.speed_unit_pps
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
            deviation=None if encoder is None else self._apart_by(encoder, first, between),
            external_encoder_position=external,
            external_deviation=None if external is None else self._apart_by(external, between, position),
        )

    def _apart_by(self, encoder: int, before: int, after: int) -> float:
        """How far the encoder is from the mean of two positions; both counters wrap."""
        return self._state.wrap.way(encoder, before) - self._state.wrap.way(after, before) / 2

    def _mode(self, step_direction: bool, searching: bool, speed: int, target_speed: int, reached: bool) -> str:
        """TMCL has no register of the mode: the latest command tells, and where none is known, what can be seen."""
        if step_direction:
            return "step/dir"
        if searching:
            return "reference search"
        driven = self._ongoing.driven
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
            return target_speed != 0 and self._ongoing.watch.under_way is not None
        return mode == "position" and not reached and self._ongoing.watch.under_way is not None

    def _flags(self, driver: int | None) -> dict[str, bool]:
        parts = () if driver is None else self._state.roles.driver_flags.fields
        flags = {part.name: bool(part.unpack(driver or 0)) for part in parts}
        flags["stall_stop"] = bool(self._ongoing.latched & ExtendedErrors.STALL)
        flags["deviation_stop"] = bool(self._ongoing.latched & ExtendedErrors.DEVIATION)
        return flags
