"""How an axis is now, and where its counter stands, by the registers of its ramp generator."""

from __future__ import annotations

from ....links.queue import Priority
from ....registers.listed.ramp import BACKWARD, FORWARD, HOLD, POSITION, Ramp
from ...core.capabilities import AxisMonitor, PositionCounter
from ...core.counter import CounterReading
from ...core.register_link import RegisterLink
from ...core.results import AxisState, MotionEnd, Switches
from ...core.session import Session
from ...core.signs import NO_SIGNS, Evidence, Sign, Signs
from .ongoing import ChipMotions
from .state import ChipState

MODES = {POSITION: "position", FORWARD: "velocity", BACKWARD: "velocity", HOLD: "hold"}


class ChipMonitor(AxisMonitor):
    """Asks the chip for the state of an axis; `motions` hears what it tells of the motion under way."""

    def __init__(self, session: Session, link: RegisterLink, state: ChipState, motions: ChipMotions) -> None:
        self._session = session
        self._link = link
        self._state = state
        self._motions = motions

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        """Velocities are the chip's own numbers."""
        ramp = self._state.ramps[self._session.axis(axis).index]
        self._session.require_connected()
        async with self._session.queue.turn(priority) as turn:
            reading = await self._motions.poll(self._link.io(turn), ramp)
        speed = self._state.word(ramp.max_speed)
        way = {FORWARD: 1, BACKWARD: -1}.get(reading.mode)
        return AxisState(
            position=reading.position,
            target_position=reading.target if reading.mode == POSITION else None,
            velocity_pps=float(reading.speed),
            target_velocity_pps=None if way is None or speed is None else float(way * speed),
            acceleration_pps2=None,
            position_reached=reading.reached,
            moving=reading.moves,
            mode=MODES[reading.mode],
            switches=Switches(None, None, None),
            flags=_flags(ramp, reading.status),
            time_s=reading.time_s,
        )

    def signs(self, axis: int, state: AxisState) -> Signs:
        """Zeros that keep it from moving; what its flags mean is not known."""
        ramp = self._state.ramps[self._session.axis(axis).index]
        if state.moving:
            return NO_SIGNS
        blocks = tuple(
            Sign(f"{row.name} is 0: it does not move", (Evidence(row.name, "0", state.time_s),))
            for row in (ramp.max_speed, ramp.acceleration)
            if self._state.wanted(row) == 0
        )
        return Signs(blocks=blocks) if blocks else NO_SIGNS

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        return self._motions.watches[self._session.axis(axis).index].ends


def _flags(ramp: Ramp, word: int | None) -> dict[str, bool]:
    """The single bits of the register of flags, by name."""
    if ramp.status is None or word is None:
        return {}
    return {part.name: bool(part.unpack(word)) for part in ramp.status.fields if part.width == 1}


class ChipCounter(PositionCounter):
    """XACTUAL, which counts as many bits as it has."""

    def __init__(self, session: Session, link: RegisterLink, state: ChipState) -> None:
        self._session = session
        self._link = link
        self._state = state

    async def poll(self, axis: int) -> CounterReading:
        ramp = self._state.ramps[self._session.axis(axis).index]
        self._session.require_connected()
        async with self._link.turn() as turn:
            io = self._link.io(turn)
            count, asked_at_s = await io.value(ramp.position), io.asked_s
        self._session.saw_position(axis, count, asked_at_s)
        return CounterReading(count, asked_at_s, None)

    def counter_bits(self, axis: int) -> int | None:
        return self._state.ramps[self._session.axis(axis).index].position.width
