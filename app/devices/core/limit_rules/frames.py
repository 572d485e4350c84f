"""What frames write: (address, word), by how they go over the wire. Reads, the most of them, are told by one bit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from ....errors import WrongState
from ....links import datagram32, datagram40, tmcl
from ....links.access32 import Spi32Access
from ....links.datagram_uart import UartForm
from ....links.register_access import BoardAccess, RegisterAccess, UartAccess
from ....links.spi_access import SpiAccess, TaggedAccess
from ....links.spi_datagram import decode
from ....registers.evaluation_board import BoardOpcode
from ....registers.spi_format import SpiFormat, TaggedFormat
from ....registers.tmcl.commands import Opcode

Decoder: TypeAlias = Callable[[bytes], Sequence[tuple[int, int]]]

BOARD_MOVES = frozenset({Opcode.ROR, Opcode.ROL, Opcode.MVP, Opcode.SAP, BoardOpcode.USER_FUNCTION_MC})
"""Commands of an evaluation board by which its firmware writes registers of the chip that nobody here sees."""


def decoder_of(access: RegisterAccess) -> Decoder:
    """How the frames of this access are read."""
    if isinstance(access, UartAccess):
        return _uart(access.form)
    if isinstance(access, BoardAccess):
        return _board(access)
    if isinstance(access, SpiAccess):
        return _told(access.form)
    if isinstance(access, TaggedAccess):
        return _tagged(access.form)
    return spi32_writes if isinstance(access, Spi32Access) else spi40_writes


def spi32_writes(frame: bytes) -> Sequence[tuple[int, int]]:
    if len(frame) != datagram32.FRAME_BYTES or frame[0] & 1:
        return ()
    return ((frame[0] >> 1, int.from_bytes(frame[1:], "big")),)


def spi40_writes(frame: bytes) -> Sequence[tuple[int, int]]:
    if len(frame) != datagram40.FRAME_BYTES or not frame[0] & datagram40.WRITE_BIT:
        return ()
    return ((frame[0] & datagram40.ADDRESS_MAX, int.from_bytes(frame[1:], "big")),)


def _told(form: SpiFormat) -> Decoder:
    def writes(frame: bytes) -> Sequence[tuple[int, int]]:
        if len(frame) != form.frame_bytes:
            return ()
        request = decode(form, frame)
        return ((request.address, request.data),) if request.write else ()

    return writes


def _tagged(form: TaggedFormat) -> Decoder:
    def writes(frame: bytes) -> Sequence[tuple[int, int]]:
        if len(frame) != form.frame_bytes:
            return ()
        datagram = int.from_bytes(frame, "big")
        address = form.address_of(datagram)
        return ((address, datagram & (1 << form.width_of(address)) - 1),)

    return writes


def _board(access: BoardAccess) -> Decoder:
    def writes(frame: bytes) -> Sequence[tuple[int, int]]:
        if len(frame) != tmcl.FRAME_BYTES or frame[1] != access.write_opcode:
            return ()
        return ((access.address_of(frame), int.from_bytes(frame[4:8], "big")),)

    return writes


def moves_by_board(frame: bytes) -> bool:
    """Whether the board's own firmware would do something with the axis."""
    return len(frame) == tmcl.FRAME_BYTES and frame[1] in BOARD_MOVES


def refuse_board(frame: bytes) -> None:
    """Raises WrongState for a command by which the board itself moves the axis: what it comes to nobody can tell."""
    if moves_by_board(frame):
        raise WrongState(
            f"command {frame[1]} has the board write registers by itself, past the soft limits of this axis",
            "write the registers instead, or take the limits away",
        )


def _uart(form: UartForm) -> Decoder:
    def writes(frame: bytes) -> Sequence[tuple[int, int]]:
        if len(frame) != form.write_bytes or not form.is_write(frame):
            return ()
        return ((form.register_of(frame), int.from_bytes(frame[-5:-1], "big")),)

    return writes
