"""Single datagrams as somebody sends them by hand, and what they did to what we know.

A reply belongs to the datagram before (002, 5.1), so the answer to a read comes with the next one: after a read that
clears nothing the same datagram goes out once more, and `decoded` has its answer. The pipeline is left as if it had
gone out once, so that whoever sends a datagram twice sees what the data sheet shows.
"""

from __future__ import annotations

from app.devices.results import RawExchange
from app.devices.tmc4361 import rows
from app.devices.tmc4361.samples import Samples
from app.links import datagram40, tmcl
from app.links.datagram40 import Reply, Request
from app.links.errors import OutOfRange
from app.registers.landungsbruecke import BoardOpcode
from app.registers.model import Register
from app.registers.tmc4361_bits import event_names, selected_events


class Raw(Samples):
    """A TMC4361 that takes raw frames."""

    async def exchange(self, frame: bytes) -> RawExchange:
        size = self.access.frame_bytes
        if len(frame) != size:
            raise OutOfRange("frame length", len(frame), size, size, "bytes")
        self.require_connected()
        return await (self._datagram(frame) if size == datagram40.FRAME_BYTES else self._board_command(frame))

    async def _datagram(self, frame: bytes) -> RawExchange:
        request = Request.decode(frame)
        register = self.table.at(request.address, write=request.write)
        twice = not request.write and register is not None and not register.read_clears
        async with self._command(rows.AXIS if request.write else None) as turn:
            replies = [Reply.decode(reply) for reply in await turn.exchange_many([frame, frame] if twice else [frame])]
        status = replies[0].status
        data = replies[1].data if twice else request.data if request.write else None
        if register is not None and data is not None:
            await self._heed(register, data, write=request.write)
        return RawExchange(
            replies[0].encode(),
            {
                "address": request.address,
                "register": register.name if register else None,
                "axis": register.axis if register else None,
                "rw": "write" if request.write else "read",
                "data": data,
                "value": register.decode(data) if register and data is not None else None,
                "fields": register.unpack(data) if register and data is not None else {},
                "status": status,
                "flags": self._status_flags(status),
                "data_of_the_datagram_before": replies[0].data,
            },
        )

    async def _board_command(self, frame: bytes) -> RawExchange:
        """A TMCL command to the evaluation board; its register access is decoded."""
        async with self._command(rows.AXIS) as turn:
            reply = await turn.exchange(frame)
        request = tmcl.Request.decode(frame)
        answer = tmcl.Reply.decode(reply)
        write = request.opcode == BoardOpcode.WRITE_MC
        known = write or request.opcode == BoardOpcode.READ_MC
        register = self.table.at(request.type, write=write) if known else None
        data = (request.value if write else answer.value) & datagram40.DATA_MASK
        if register is not None and answer.ok:
            await self._heed(register, data, write=write)
        elif not known:
            self.commanded(rows.AXIS, f"TMCL {request.opcode}")
        return RawExchange(
            reply,
            {
                "address": request.type if known else None,
                "register": register.name if register else None,
                "axis": register.axis if register else None,
                "rw": "write" if write else "read",
                "data": data,
                "value": register.decode(data) if register else None,
                "fields": register.unpack(data) if register else {},
                "status": answer.status,
                "flags": {},
            },
        )

    async def _heed(self, register: Register, data: int, *, write: bool) -> None:
        """Take into account what a frame has read or written."""
        if not write:
            self._saw_word(register, data)
            return
        self._sent(register, data)
        self._saw_word(register, data)
        if register.address in rows.MOVING:
            await self._moved_by_hand()
            if register.access.readable and self.access.frame_bytes == datagram40.FRAME_BYTES:
                # The next datagram is to be answered by what this one has written.
                await self.queue.exchange(datagram40.read(register.address))

    def _status_flags(self, status: int) -> dict[str, bool]:
        """The status byte's bits by the events that SPI_STATUS_SELECTION shows there; none before that was seen."""
        selection = self.known(rows.SPI_STATUS_SELECTION)
        if selection is None:
            return {}
        return {
            name: bool(status >> place & 1)
            for place, bit in enumerate(selected_events(selection))
            for name in event_names(1 << bit)
        }
