"""The position counter of a TMC4361, and RST_EV, which tells of a reset."""

from __future__ import annotations

from ..core.capabilities import PositionCounter
from ..core.counter import CounterReading
from ..core.register_io import Snapshot
from ..core.register_link import RegisterLink
from ..core.session import Session
from . import roles
from .events import Events
from .memory import ChipMemory

LOOK = (roles.XACTUAL, roles.ENC_POS, roles.ENC_CONST, roles.REFERENCE_CONF)
COUNTER_WRITES = frozenset({"set_position", roles.XACTUAL.name, "X_RANGE"})
"""Commands after which the counter shows another number for the same place."""


def tell_position(session: Session, held: Snapshot, asked_at_s: float) -> None:
    """Tell who follows the position counter; the encoder's along, where it was read and counts."""
    has_encoder = roles.ENC_POS.address in held.words and held.words.get(roles.ENC_CONST.address)
    encoder = held.value(roles.ENC_POS) if has_encoder else None
    session.saw_position(roles.AXIS, held.value(roles.XACTUAL), asked_at_s, encoder)


class Counter(PositionCounter):
    """Reads the counter, and whether the chip was reset."""

    def __init__(self, link: RegisterLink, memory: ChipMemory, events: Events) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._events = events
        self._resets_told = 0

    def counter_bits(self, axis: int) -> int | None:
        self._session.axis(axis)
        conf = self._memory.known(roles.REFERENCE_CONF)
        circular = conf is not None and roles.part(roles.REFERENCE_CONF, "circular_movement_en").unpack(conf)
        return None if circular else 32

    async def poll(self, axis: int) -> CounterReading:
        self._session.axis(axis)
        self._session.require_connected()
        async with self._link.turn() as turn:
            asked_at_s = self._session.device_time_s()
            held = await self._events.take(self._link.io(turn), LOOK)
        tell_position(self._session, held, asked_at_s)
        before, self._resets_told = self._resets_told, self._events.resets
        return CounterReading(held.value(roles.XACTUAL), asked_at_s, self._events.resets > before)

    def latch_register(self, axis: int) -> str | None:
        self._session.axis(axis)
        return roles.X_LATCH.name

    def compare_register(self, axis: int) -> str | None:
        self._session.axis(axis)
        return "POS_COMP"
