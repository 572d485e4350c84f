"""The position counter of a TMC4361, and RST_EV, which tells of a reset."""

from __future__ import annotations

from ..core.counter import CounterLook
from . import rows
from .polling import Looks

LOOK = (rows.XACTUAL, rows.ENC_POS, rows.ENC_CONST, rows.REFERENCE_CONF)


class Counting(Looks):
    """A TMC4361 whose position counter can be followed."""

    COUNTER_WRITES = frozenset({"set_position", rows.XACTUAL.name, "X_RANGE"})

    _resets_told = 0

    def counter_bits(self, axis: int) -> int | None:
        self.axis(axis)
        conf = self.known(rows.REFERENCE_CONF)
        circular = conf is not None and rows.part(rows.REFERENCE_CONF, "circular_movement_en").unpack(conf)
        return None if circular else 32

    async def look(self, axis: int) -> CounterLook:
        self.axis(axis)
        self.require_connected()
        async with self.queue.turn() as turn:
            asked_at_s = self.device_time_s()
            held = await self._look_at_events(self.words(turn), LOOK)
        self._tell_position(held, asked_at_s)
        before, self._resets_told = self._resets_told, self.resets
        return CounterLook(held.value(rows.XACTUAL), asked_at_s, self.resets > before)

    def latch_register(self, axis: int) -> str | None:
        self.axis(axis)
        return rows.X_LATCH.name

    def compare_register(self, axis: int) -> str | None:
        self.axis(axis)
        return "POS_COMP"
