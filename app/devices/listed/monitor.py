"""How an axis is now, and where its counter stands, by parameters of standard meaning."""

from __future__ import annotations

from ...links.queue import Priority
from ..core.capabilities import AxisMonitor, PositionCounter
from ..core.counter import CounterReading
from ..core.results import AxisState, MotionEnd, Switches
from ..core.session import Session
from ..core.signs import NO_SIGNS, Signs
from ..core.tmcl_link import TmclLink
from .ongoing import ListedMotions
from .state import COUNTER_BITS, ListedState


class ListedMonitor(AxisMonitor):
    """Asks the module for the state of an axis; `motions` hears what it tells of the motion under way."""

    def __init__(self, session: Session, state: ListedState, link: TmclLink, motions: ListedMotions) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._motions = motions

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        """Velocities are the module's own numbers."""
        axis = self._session.axis(axis).index
        self._session.require_connected()
        async with self._link.calls(priority=priority) as calls:
            values = await self._motions.poll(axis, calls)
            time_s = calls.time_s
        position, speed = values[0] or 0, values[1] or 0
        target, target_speed, told = values[2:]
        motion = self._motions.axes[axis]
        reached = motion.reached(told, position, target)
        driven = motion.driven
        if driven is None or driven == "unknown":  # TMCL has no parameter of the mode: what can be seen tells
            driven = "velocity" if target_speed or not (speed or reached) else "position"
        mode = "position" if driven == "position" else "velocity" if speed or target_speed else "hold"
        under_way = motion.watch.under_way is not None
        return AxisState(
            position=position,
            target_position=target if mode == "position" else None,
            velocity_pps=float(speed),
            target_velocity_pps=float(target_speed) if mode != "position" and target_speed is not None else None,
            acceleration_pps2=None,
            position_reached=reached and mode == "position",
            moving=bool(speed) or (under_way and (bool(target_speed) if mode != "position" else not reached)),
            mode=mode,
            switches=Switches(None, None, None),
            flags={},
            time_s=time_s,
        )

    def signs(self, axis: int, state: AxisState) -> Signs:
        """None: what errors and flags of this module mean is not known."""
        del state
        self._session.axis(axis)
        return NO_SIGNS

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        return self._motions.axes[self._session.axis(axis).index].watch.ends


class ListedCounter(PositionCounter):
    """The position parameter, which is taken for a counter of 32 bits."""

    def __init__(self, session: Session, state: ListedState, link: TmclLink) -> None:
        self._session = session
        self._state = state
        self._link = link

    async def poll(self, axis: int) -> CounterReading:
        session = self._session
        row = self._state.axes[session.axis(axis).index].position
        session.require_connected()
        async with self._link.calls() as calls:
            asked_at_s = session.device_time_s()
            count = await calls.get(row)
        session.saw_position(axis, count, asked_at_s)
        return CounterReading(count, asked_at_s, None)

    def counter_bits(self, axis: int) -> int | None:
        self._session.axis(axis)
        return COUNTER_BITS
