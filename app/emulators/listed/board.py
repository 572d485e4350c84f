"""A plain evaluation board: it tells who it is and what is in its slots, and reads and writes registers of the chip.

Its firmware does nothing of its own: commands that would move a motor are refused as those of a chip without such.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from ...links.register_access import BoardAccess
from ...links.tmcl import FRAME_BYTES, Reply, Request, checksum
from ...registers.entry import Model
from ...registers.evaluation_board import (
    CHANNEL_1_BOARDS,
    CHANNEL_2_BOARDS,
    REGISTER_ADDRESS_BITS,
    BoardOpcode,
    SlotState,
)
from ...registers.tmcl.commands import Opcode, Status
from ..board.firmware import HOST, MODULE, VERSION_BINARY, VERSION_MAJOR, VERSION_MINOR, VERSION_STRING

if TYPE_CHECKING:
    from .chip import PlainChip

BOARDS_IN_SLOTS = 4
"""The global parameter that tells them."""
_INFO = {
    0: MODULE,
    1: VERSION_MAJOR << 16 | VERSION_MINOR,
    2: 2,  # speaks TMCL
    20: 8,  # bits of an axis parameter's number
    21: REGISTER_ADDRESS_BITS,
}


class Read(Protocol):
    def __call__(self, address: int, at_s: float | None = None) -> int: ...


class Write(Protocol):
    def __call__(self, address: int, data: int, at_s: float | None = None) -> None: ...


class BoardEnd:
    """Nine bytes to nine bytes; `read` and `write` reach the chip's registers."""

    def __init__(self, model: Model, read: Read, write: Write) -> None:
        self._address = model.slot.module
        self._access = BoardAccess(slot=model.slot)
        self._read = read
        self._write = write
        known = CHANNEL_2_BOARDS if model.slot.side == "driver" else CHANNEL_1_BOARDS
        number = next((number for number, title in known.items() if title == model.board), 0)
        there, empty = number | SlotState.DONE << 8, SlotState.NO_ANSWER << 8
        self._slots = there << 16 | empty if model.slot.side == "driver" else there | empty << 16

    def receive(self, frame: bytes, at_s: float | None = None) -> bytes | None:
        """Obey one command; None where it is for another module. Raises ValueError for a frame of another length."""
        if len(frame) != FRAME_BYTES:
            raise ValueError(f"a TMCL frame has {FRAME_BYTES} bytes, not {len(frame)}")
        if frame[0] != self._address:
            return None
        if frame[8] != checksum(frame[:8]):
            return self._reply(Status.WRONG_CHECKSUM, 0, 0)
        request = Request.decode(frame)
        if request.opcode == self._access.read_opcode:
            word = self._read(self._access.address_of(frame), at_s)
            return self._reply(Status.OK, request.opcode, word)
        if request.opcode == self._access.write_opcode:
            self._write(self._access.address_of(frame), request.value & 0xFFFF_FFFF, at_s)
            return self._reply(Status.OK, request.opcode, request.value)
        if request.opcode == Opcode.GET_VERSION and request.type == 0:
            return bytes((HOST,)) + VERSION_STRING
        told = self._told(request)
        if told is None:
            return self._reply(Status.INVALID_COMMAND, request.opcode, request.value)
        return self._reply(Status.OK, request.opcode, told)

    def _told(self, request: Request) -> int | None:
        """What the board tells of itself; None where it does not have that command."""
        match request.opcode, request.type:
            case Opcode.GET_VERSION, _:
                return VERSION_BINARY
            case Opcode.GGP, type_ if type_ == BOARDS_IN_SLOTS:
                return self._slots
            case BoardOpcode.GET_INFO, type_:
                return _INFO.get(type_, 0)
        return None

    def _reply(self, status: Status, opcode: int, value: int) -> bytes:
        signed = (value + (1 << 31)) % (1 << 32) - (1 << 31)
        return Reply(HOST, self._address, status, opcode, signed).encode()


class PlainBoard:
    """A chip on its board as a line sees it."""

    reply_pause_s = 0.0

    def __init__(self, chip: PlainChip) -> None:
        self.chip = chip
        self.clock = chip.clock
        self.faults = chip.faults

    def receive(self, frame: bytes, at_s: float | None = None) -> bytes | None:
        """Obey one frame; None where it is for another module."""
        return self.chip.board(frame, at_s)

    def unsolicited(self, at_s: float | None = None) -> list[tuple[float, bytes]]:
        """It speaks only when it is asked."""
        del at_s
        return []

    def catch_up(self, slice_s: float) -> bool:
        """As the chip's."""
        return self.chip.catch_up(slice_s)
