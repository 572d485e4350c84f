"""The position counter of a ramp generator chip: 24 bits."""

from __future__ import annotations

from ..core.capabilities import PositionCounter
from ..core.counter import CounterReading
from ..core.register_link import RegisterLink
from .memory import RampMemory
from .prediction import POSITION_BITS
from .resets import Resets

COUNTER_WRITES = frozenset({"set_position", "x_actual", "X_ACTUAL"})


class RampCounter(PositionCounter):
    """Reads the counter, and what tells of a reset. `compare` is the register that it is compared with, if any."""

    def __init__(self, link: RegisterLink, memory: RampMemory, resets: Resets, compare: str | None) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._resets = resets
        self._compare = compare

    def counter_bits(self, axis: int) -> int | None:
        self._session.axis(axis)
        return POSITION_BITS

    def latch_register(self, axis: int) -> str | None:
        return self._memory.rows[self._session.axis(axis).index].x_latched.name

    def compare_register(self, axis: int) -> str | None:
        self._session.axis(axis)
        return self._compare if self._memory.compared_axis in (None, axis) else None

    async def poll(self, axis: int) -> CounterReading:
        self._session.axis(axis)
        self._session.require_connected()
        async with self._link.turn() as turn:
            io = self._link.io(turn)
            count = await io.value(self._memory.rows[axis].x_actual)
            asked_at_s = io.asked_s
            for register in self._resets.rows(axis):
                word = await io.read(register)
                self._memory.saw(register, word)
                if word != register.reset:
                    break  # one is enough
        self._resets.judge(axis)
        reset_seen = self._resets.take(axis)
        self._session.saw_position(axis, count, asked_at_s)
        return CounterReading(count, asked_at_s, reset_seen)
