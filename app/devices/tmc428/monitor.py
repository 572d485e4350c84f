"""How the axes of a ramp generator chip are now."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ...calc.units.tmc428 import acceleration_hz_s, pulse_rate_hz
from ...links.datagram32 import status_flags
from ...links.queue import Priority
from ...registers.model import Access
from ..core.capabilities import AxisMonitor
from ..core.register_link import RegisterLink
from ..core.results import AxisState, MotionEnd, Switches
from ..core.signs import Signs
from . import signs as ramp_signs
from .axis_roles import HOLD_MODE, POSITIONING_MODES, AxisRoles
from .chain_status import ChainStatus
from .interrupts import Interrupts
from .memory import RampMemory
from .prediction import TickedBook
from .ramp_parameters import RampParameters, distance
from .resets import Resets
from .switching import Switching


class RampMonitor(AxisMonitor):
    """Reads an axis's registers and switches in one turn."""

    def __init__(
        self,
        link: RegisterLink,
        memory: RampMemory,
        switching: Switching,
        books: Sequence[TickedBook],
        resets: Resets,
        interrupts: Interrupts,
        chain: ChainStatus | None = None,
    ) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._switching = switching
        self._books = books
        self._resets = resets
        self._interrupts = interrupts
        self._chain = chain

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        self._session.axis(axis)
        self._session.require_connected()
        rows = self._memory.rows[axis]
        if self._chain is not None:
            await self._chain.learn()
        async with self._session.queue.turn(priority) as turn:
            io = self._link.io(turn)
            ramp = await self._memory.read_ramp(io, axis)
            interrupts = await self._interrupts.look(io, axis)
            left, right = await self._switching.read(io, axis)
            x_target = await io.value(rows.x_target)
            v_target = await io.value(rows.v_target)
            a_actual = await io.value(rows.a_actual)
            v_actual = await io.value(rows.v_actual)
            x_actual = await io.value(rows.x_actual)
            time_s, status = io.time_s, io.status
            asked_at_s = io.asked_s
            if self._chain is not None:
                await self._chain.look(io)
        self._session.saw_position(axis, x_actual, asked_at_s)
        self._resets.judge(axis)
        reached = self._switching.reached(status, axis)
        flags = status_flags(status, self._switching.status_names)
        flags |= {
            part.name: bool(part.unpack(interrupts)) for part in rows.interrupts.fields if part.access is Access.R_W1C
        }
        flags |= {} if self._chain is None else self._chain.flags(axis)
        flags[rows.latch_waiting.name] = bool(rows.latch_waiting.unpack(ramp.reference))
        to_go = distance(x_target, x_actual)
        moving = self._moving(rows, ramp, v_actual, v_target, to_go, left, right)
        if not moving and (to_go if ramp.mode in POSITIONING_MODES else v_target):
            self._books[axis].end(time_s, "the motor stands: a switch stopped it")
        home = right if rows.reference_right.unpack(ramp.reference) else left
        return AxisState(
            position=x_actual,
            target_position=x_target,
            velocity_pps=pulse_rate_hz(v_actual, ramp.pulse_div, self._session.clock_hz),
            target_velocity_pps=pulse_rate_hz(v_target, ramp.pulse_div, self._session.clock_hz),
            acceleration_pps2=self._acceleration(a_actual, ramp),
            position_reached=reached,
            moving=moving,
            mode=rows.mode.values[ramp.mode],
            switches=Switches(left, right, home),
            flags=flags,
            time_s=time_s,
        )

    def signs(self, axis: int, state: AxisState) -> Signs:
        index = self._session.axis(axis).index
        told = ramp_signs.signs(self._memory.rows[index], index, self._memory.ramp(index), state)
        if self._chain is not None:
            told = replace(
                told,
                faults=(*told.faults, *self._chain.faults(index, state)),
                warnings=self._chain.warnings(index, state),
                stalling=self._chain.stalling(index, state),
            )
        return replace(told, resets=self._resets.count(index))

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        self._session.axis(axis)
        return ()  # nothing tells why such a motor came to rest

    def _acceleration(self, a_actual: int, ramp: RampParameters) -> float:
        # a_actual is drawn with 12 signed bits; its extreme -2048 is no value that a_max can make.
        return acceleration_hz_s(max(-2047, a_actual), ramp.pulse_div, ramp.ramp_div, self._session.clock_hz)

    @staticmethod
    def _moving(
        rows: AxisRoles,
        ramp: RampParameters,
        v_actual: int,
        v_target: int,
        to_go: int,
        left: bool | None,
        right: bool | None,
    ) -> bool:
        """v_actual reads 0 below one chip unit too, so 0 alone does not say that the motor rests (DS-TMC428 8.6)."""
        if v_actual:
            return True
        if not ramp.v_max or not ramp.a_max or ramp.mode == HOLD_MODE:
            return False
        wanted = to_go if ramp.mode in POSITIONING_MODES else v_target
        return bool(wanted) and not ramp.blocked(rows, 1 if wanted > 0 else -1, left, right)
