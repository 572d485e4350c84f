"""Single frames as a user sends them by hand, and what they did to what we know.

A reply to a 40-bit datagram belongs to the datagram before, so the answer to a read comes with the next one: `_behind`
says which one may follow, and `decoded` has the answer. One byte alone brings the chip's status, where the link can
end a datagram there. Through an evaluation board a register is one TMCL command, over a UART one datagram with an
answer of its own. Of a told format the answer comes so or so.
"""

from __future__ import annotations

from typing import Protocol

from ...errors import OutOfRange, UsageError, WrongState
from ...links import datagram40, tmcl
from ...links.datagram_uart import UartForm
from ...links.register_access import BoardAccess, Spi40Access, UartAccess
from ...links.spi_access import HIDDEN, SpiAccess, TaggedAccess
from ...links.spi_datagram import data_of, decode
from ...registers.model import Register
from .capabilities import RawFrames
from .changes import BY_HAND, register_changed
from .register_file import RegisterRules
from .register_link import RegisterLink
from .results import RawExchange


class RawRules(Protocol):
    """What single frames do to a chip of one family."""

    def behind(self, frame: bytes, register: Register) -> bytes | None:
        """The datagram that may be sent to get the answer to `frame`, which reads `register`; None where none may.

        Once more the same leaves the pipeline as if it had gone out once.
        """
        return None if register.read_clears else frame

    def read_by_hand(self, register: Register, data: int, time_s: float) -> None:
        """A frame has read `register` at `time_s` [s]."""
        ...

    def known_word(self, register: Register) -> int | None:
        """What `register` was last seen to hold, or is known to; None where nobody knows."""
        ...

    async def moved_by_hand(self, register: Register) -> bool:
        """A raw write may move the axis: find out how, and whether it may."""
        ...

    def status_flags(self, status: int) -> dict[str, bool]:
        """The bits of the status byte by name."""
        ...

    def answered(self, word: int) -> dict[str, int]:
        """What an answer shows besides its flags, by name; empty where nobody knows."""
        del word
        return {}


class RawDatagrams(RawFrames):
    """Single frames to a chip of 40-bit datagrams, whatever link it is behind."""

    def __init__(self, link: RegisterLink, registers: RegisterRules, rules: RawRules) -> None:
        self._link = link
        self._session = link.session
        self._registers = registers
        self._rules = rules

    @property
    def status_alone(self) -> bool:
        return isinstance(self._link.access, Spi40Access) and self._session.port.traits.cuts

    async def exchange(self, frame: bytes) -> RawExchange:
        access = self._link.access
        if isinstance(access, UartAccess):
            return await self._uart_datagram(access.form, frame)
        size = access.frame_bytes
        if isinstance(access, Spi40Access) and len(frame) == datagram40.STATUS_BYTES:
            return await self._status(frame)
        if len(frame) != size:
            raise OutOfRange("frame length", len(frame), size, size, "bytes")
        self._session.require_connected()
        if isinstance(access, BoardAccess):
            return await self._board_command(access, frame)
        if isinstance(access, SpiAccess):
            return await self._told_datagram(access, frame)
        if isinstance(access, TaggedAccess):
            return await self._tagged_datagram(access, frame)
        return await self._datagram(frame)

    async def _status(self, frame: bytes) -> RawExchange:
        """The chip's status by eight clocks. Raises WrongState where the link carries whole datagrams alone."""
        if frame != datagram40.STATUS_FRAME:
            raise UsageError(
                f"eight clocks write nothing: send {datagram40.STATUS_FRAME.hex()}, or a datagram of "
                f"{datagram40.FRAME_BYTES} bytes"
            )
        self._session.require_connected()
        if not self.status_alone:
            raise WrongState(
                f"{self._session.port.name} carries whole datagrams alone, none of eight clocks",
                f"send a datagram of {datagram40.FRAME_BYTES} bytes: its answer begins with the same status",
            )
        async with self._link.command(None) as turn:
            status = (await turn.exchange(frame))[0]
        decoded = self._decoded(None, None, None, write=False)
        return RawExchange(bytes((status,)), decoded | {"status": status, "flags": self._rules.status_flags(status)})

    async def _datagram(self, frame: bytes) -> RawExchange:
        request = datagram40.Request.decode(frame)
        register = self._link.table.at(request.address, write=request.write)
        behind = None if request.write or register is None else self._rules.behind(frame, register)
        async with self._link.command(self._axis_touched(register) if request.write else None) as turn:
            sent = [frame] if behind is None else [frame, behind]
            replies = [datagram40.Reply.decode(reply) for reply in await turn.exchange_many(sent)]
            time_s = turn.last_exchange_s
        status = replies[0].status
        data = request.data if request.write else None if behind is None else replies[1].data
        if register is not None and data is not None:
            await self._heed(register, data, write=request.write, time_s=time_s)
        decoded = self._decoded(request.address, register, data, write=request.write)
        decoded |= {
            "status": status,
            "flags": self._rules.status_flags(status),
            "data_of_the_datagram_before": replies[0].data,
        }
        return RawExchange(replies[0].encode(), decoded)

    async def _told_datagram(self, access: SpiAccess, frame: bytes) -> RawExchange:
        """A datagram of a told format; where answers come one later, a read is answered by the next."""
        form = access.form
        request = decode(form, frame)
        register = self._link.table.at(request.address, write=request.write)
        behind = None
        if form.answer == "next" and register is not None and not request.write:
            behind = self._rules.behind(frame, register)
        async with self._link.command(self._axis_touched(register) if request.write else None) as turn:
            replies = await turn.exchange_many([frame] if behind is None else [frame, behind])
            time_s = turn.last_exchange_s
        data: int | None = data_of(form, replies[-1])
        if request.write:
            data = request.data
        elif form.answer == "next" and behind is None:
            data = None
        if register is not None and data is not None:
            await self._heed(register, data, write=request.write, time_s=time_s)
        decoded = self._decoded(request.address, register, data, write=request.write)
        return RawExchange(replies[0], decoded | {"status": replies[0][0], "flags": {}})

    async def _tagged_datagram(self, access: TaggedAccess, frame: bytes) -> RawExchange:
        """A datagram whose upper bits say the register that it writes; its answer is a status."""
        form, datagram = access.form, int.from_bytes(frame, "big")
        address = form.address_of(datagram)
        register = self._link.table.at(address, write=True)
        async with self._link.command(self._axis_touched(register)) as turn:
            reply = await turn.exchange(frame)
            time_s = turn.last_exchange_s
        access.check(frame, reply)
        status = access.status([reply]) or 0
        # of what was selected before this datagram, which may select something else
        answer = {} if reply[-1] & HIDDEN else self._rules.answered(int.from_bytes(reply, "big") >> 4)
        data = datagram & (1 << form.width_of(address)) - 1
        if register is not None:
            await self._heed(register, data, write=True, time_s=time_s)
        decoded = self._decoded(address, register, data, write=True)
        told = {"status": status, "flags": self._rules.status_flags(status), "answer": answer}
        return RawExchange(reply, decoded | told)

    async def _board_command(self, access: BoardAccess, frame: bytes) -> RawExchange:
        """A TMCL command to the evaluation board; its register access is decoded."""
        request = tmcl.Request.decode(frame)
        write = request.opcode == access.write_opcode
        known = write or request.opcode == access.read_opcode
        address = access.address_of(frame)
        register = self._link.table.at(address, write=write) if known else None
        async with self._link.command(self._axis_touched(register)) as turn:
            reply = await turn.exchange(frame)
            time_s = turn.last_exchange_s
        answer = tmcl.Reply.decode(reply)
        data = (request.value if write else answer.value) & datagram40.DATA_MASK
        if register is not None and answer.ok:
            await self._heed(register, data, write=write, time_s=time_s)
        elif not known:
            for axis in self._session.axes:
                self._session.commanded(axis.index, f"TMCL {request.opcode}")
        decoded = self._decoded(address if known else None, register, data, write=write)
        return RawExchange(reply, decoded | {"status": answer.status, "flags": {}})

    async def _uart_datagram(self, form: UartForm, frame: bytes) -> RawExchange:
        """A datagram of a UART; the answer to a write is the chip's count of writes (IFCNT)."""
        if len(frame) not in (form.read_bytes, form.write_bytes):
            raise OutOfRange("frame length", len(frame), form.read_bytes, form.write_bytes, "bytes")
        try:
            form.check(frame)
        except ValueError as error:
            raise UsageError(str(error)) from error
        self._session.require_connected()
        write, address = form.is_write(frame), form.register_of(frame)
        register = self._link.table.at(address, write=write)
        async with self._link.command(self._axis_touched(register) if write else None) as turn:
            reply = await turn.exchange(frame)
            time_s = turn.last_exchange_s
        data = int.from_bytes((frame if write else reply)[-5:-1], "big")
        if register is not None:
            await self._heed(register, data, write=write, time_s=time_s)
        return RawExchange(reply, self._decoded(address, register, data, write=write) | {"status": None, "flags": {}})

    @staticmethod
    def _decoded(address: int | None, register: Register | None, data: int | None, *, write: bool) -> dict[str, object]:
        return {
            "address": address,
            "register": register.name if register else None,
            "axis": register.axis if register else None,
            "rw": "write" if write else "read",
            "data": data,
            "value": register.decode(data) if register and data is not None else None,
            "fields": register.unpack(data) if register and data is not None else {},
        }

    @staticmethod
    def _axis_touched(register: Register | None) -> int | None:
        """The axis whose stop shall overtake a write to `register`."""
        return 0 if register is None else register.axis

    async def _heed(self, register: Register, data: int, *, write: bool, time_s: float) -> None:
        """Take into account what a frame has read or written at `time_s` [s]."""
        if not write:
            self._rules.read_by_hand(register, data, time_s)
            return
        old = self._rules.known_word(register)
        self._registers.sent(register, data)
        self._registers.saw(register, data)
        self._session.tell(register_changed(register, old, data, time_s, BY_HAND))
        if (
            await self._rules.moved_by_hand(register)
            and register.access.readable
            and isinstance(self._link.access, Spi40Access | SpiAccess)
        ):
            # The next datagram is to be answered by what this one has written.
            await self._session.queue.exchange(self._link.access.read_frames((register.address,))[0])
