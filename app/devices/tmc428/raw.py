"""Single datagrams by hand."""

from __future__ import annotations

from ...errors import OutOfRange
from ...links.datagram32 import FRAME_BYTES, Request, status_flags
from ..core.capabilities import RawFrames
from ..core.changes import BY_HAND, register_changed
from ..core.register_file import RegisterRules
from ..core.register_link import RegisterLink
from ..core.results import RawExchange
from .memory import RampMemory


class RawDatagrams32(RawFrames):
    """Datagrams of 32 bits. `status_names` are those of the status bits, bit 0 first."""

    def __init__(
        self, link: RegisterLink, memory: RampMemory, writes: RegisterRules, status_names: tuple[str, ...]
    ) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._writes = writes
        self._status_names = status_names

    async def exchange(self, frame: bytes) -> RawExchange:
        if len(frame) != FRAME_BYTES:
            raise OutOfRange("frame length", len(frame), FRAME_BYTES, FRAME_BYTES, "bytes")
        self._session.require_connected()
        request = Request.decode(frame)
        register = self._link.table.at(request.address)
        async with self._link.command(register.axis if register and not request.read else None) as turn:
            reply = await turn.exchange(frame)
        status, data = reply[0], int.from_bytes(reply[1:], "big")
        if register is not None:
            if request.read:
                self._memory.saw(register, data)
            else:
                old = self._memory.known(register.address)
                self._writes.sent(register, request.data)
                self._session.tell(
                    register_changed(register, old, request.data, self._session.port.last_exchange_s, BY_HAND)
                )
                async with self._link.turn() as turn:
                    await self._writes.settle(self._link.io(turn), register, read_back=False)
        shown = data if request.read else request.data
        return RawExchange(
            reply,
            {
                "address": request.address,
                "register": register.name if register else None,
                "axis": register.axis if register else None,
                "rw": "read" if request.read else "write",
                "data": data,
                "value": register.decode(shown) if register else None,
                "fields": register.unpack(shown) if register else {},
                "status": status,
                "flags": status_flags(status, self._status_names),
            },
        )
