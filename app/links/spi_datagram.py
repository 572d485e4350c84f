"""Datagrams on SPI by a format that a table tells (`SpiFormat`), both ways: pure functions, no port."""

from __future__ import annotations

from dataclasses import dataclass

from ..registers import catalog
from ..registers.spi_format import SpiFormat, TaggedFormat
from . import datagram32, datagram40


@dataclass(frozen=True, slots=True)
class Request:
    """One datagram to the chip; `data` is 0 for a read."""

    address: int
    write: bool
    data: int = 0


def encode(form: SpiFormat, request: Request) -> bytes:
    """The bytes for the wire. Raises ValueError for an address or data that do not fit."""
    if not 0 <= request.address <= form.address_max:
        raise ValueError(f"an address is 0x00..{form.address_max:#04x}, not {request.address:#x}")
    if not 0 <= request.data < 1 << form.data_bits:
        raise ValueError(f"data is {form.data_bits} bits, not {request.data:#x}")
    bit = form.write_is if request.write else 1 - form.write_is
    low = form.write_bit == "low"
    head = request.address << 1 | bit if low else request.address | bit << 8 * form.head_bytes - 1
    return head.to_bytes(form.head_bytes, "big") + request.data.to_bytes(form.data_bits // 8, form.byte_order)


def decode(form: SpiFormat, frame: bytes) -> Request:
    """Raises ValueError for a frame of another length."""
    head = int.from_bytes(sized(form, frame)[: form.head_bytes], "big")
    low = form.write_bit == "low"
    bit = head & 1 if low else head >> 8 * form.head_bytes - 1
    address = (head >> 1 if low else head) & form.address_max
    return Request(address, bit == form.write_is, data_of(form, frame))


def data_of(form: SpiFormat, frame: bytes) -> int:
    """The data in a datagram or an answer. Raises ValueError for another length."""
    return int.from_bytes(sized(form, frame)[form.head_bytes :], form.byte_order)


def answer(form: SpiFormat, data: int, status: int = 0) -> bytes:
    """An answer as a chip gives it: its head is a status."""
    return status.to_bytes(form.head_bytes, "big") + data.to_bytes(form.data_bits // 8, form.byte_order)


def sized(form: SpiFormat, frame: bytes) -> bytes:
    """The same frame. Raises ValueError where it has another length."""
    if len(frame) != form.frame_bytes:
        raise ValueError(f"a datagram has {form.frame_bytes} bytes, not {len(frame)}")
    return frame


# --- by model ----------------------------------------------------------------------------------


def _spi_of(model: str) -> SpiFormat | TaggedFormat | None:
    """The format that a table tells of the chip; None where none does, and for a name that is no model's."""
    return catalog.find_model(model).spi if catalog.is_model(model) else None


def frame_bytes_of(model: str) -> int:
    """The length of a raw frame of the chip, which its answer has too."""
    spi = _spi_of(model)
    if spi is not None:
        return spi.frame_bytes
    return datagram40.FRAME_BYTES if datagram40.speaks(model) else datagram32.FRAME_BYTES


def head_bytes_of(model: str) -> int:
    """What stands before the data in an answer that comes with the next datagram; 0 for chips that answer at once."""
    spi = _spi_of(model)
    if isinstance(spi, SpiFormat) and spi.answer == "next":
        return spi.head_bytes
    return 1 if datagram40.speaks(model) else 0


def asks_anew(model: str) -> bool:
    """Whether a question has other bytes as the chip is set otherwise, so that nobody may keep one and ask it later."""
    spi = _spi_of(model)
    return spi is not None and not isinstance(spi, SpiFormat)


def chained(model: str) -> bool:
    """Whether nobody may come between the frames of one question."""
    spi = _spi_of(model)
    return head_bytes_of(model) > 0 or (spi is not None and not isinstance(spi, SpiFormat))
