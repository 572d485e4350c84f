"""The 40-bit datagram of the TMC4361 and the TMC5xxx, both ways: pure functions, no port.

To the chip (DS-TMC4361 5.1): a write bit (1 writes), seven address bits, 32 data bits. From the chip: eight
status bits, 32 data bits. On the wire the most significant byte goes first.

The answer is pipelined: the data of a reply belong to the datagram before, its register if that one
was a read, what it wrote if it was a write. So a single read costs two datagrams, and n reads in a row
cost n + 1. The status bits are of this moment. A TMC5xxx does the same (TMC5031 data sheet, page 17).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..registers import catalog

FRAME_BYTES = 5
STATUS_BYTES = 1
"""Eight clocks alone: the chip sends its status, and heeds nothing of what it gets (DS-TMC4361 5.2)."""
STATUS_FRAME = bytes(STATUS_BYTES)
DATA_MASK = 0xFFFF_FFFF
ADDRESS_MAX = 0x7F
WRITE_BIT = 0x80
VERSION_ADDRESS = 0x7F
"""VERSION_NO of a TMC4361: reading it neither clears nor changes anything, so it may follow anything."""


@dataclass(frozen=True, slots=True)
class Request:
    """One datagram to the chip. `address` is 7 bits, `data` 32 bits, 0 for a read."""

    address: int
    write: bool
    data: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.address <= ADDRESS_MAX:
            raise ValueError(f"an address is 0x00..0x7f, not {self.address:#x}")
        if not 0 <= self.data <= DATA_MASK:
            raise ValueError(f"data is 32 bits, not {self.data:#x}")

    def encode(self) -> bytes:
        return bytes((self.address | (WRITE_BIT if self.write else 0),)) + self.data.to_bytes(4, "big")

    @classmethod
    def decode(cls, frame: bytes) -> Request:
        """Raises ValueError unless the frame is 5 bytes long."""
        first = _five(frame)[0]
        return cls(first & ADDRESS_MAX, bool(first & WRITE_BIT), int.from_bytes(frame[1:], "big"))


@dataclass(frozen=True, slots=True)
class Reply:
    """One datagram from the chip: `status` 8 bits, of now; `data` 32 bits, of the datagram before."""

    status: int
    data: int

    def encode(self) -> bytes:
        return bytes((self.status,)) + self.data.to_bytes(4, "big")

    @classmethod
    def decode(cls, frame: bytes) -> Reply:
        """Raises ValueError unless the frame is 5 bytes long."""
        return cls(_five(frame)[0], int.from_bytes(frame[1:], "big"))


def _five(frame: bytes) -> bytes:
    if len(frame) != FRAME_BYTES:
        raise ValueError(f"a datagram has {FRAME_BYTES} bytes, not {len(frame)}")
    return frame


def read(address: int) -> bytes:
    """The frame that asks for the register at `address`; the frame after it brings the answer."""
    return Request(address, write=False).encode()


def write(address: int, data: int) -> bytes:
    """The frame that writes 32 raw bits to `address`; the frame after it brings them back."""
    return Request(address, write=True, data=data).encode()


def speaks(model: str) -> bool:
    """Whether the chip `model` speaks it."""
    if not catalog.is_model(model):
        return False
    known = catalog.find_model(model)
    return known.datagram_bits == 8 * FRAME_BYTES and known.spi is None


FETCH = read(VERSION_ADDRESS)
"""What ends a chain: it brings the answer to the frame before, and its own is nobody's."""


def fetch_of(model: str) -> bytes:
    """The same for `model`."""
    return read(catalog.MODELS[model].fetch_address)


def read_chain(addresses: Sequence[int], fetch: bytes = FETCH) -> tuple[bytes, ...]:
    """The n + 1 frames that read n registers; none for none. `fetch` is the last of them."""
    return (*(read(address) for address in addresses), fetch) if addresses else ()


def words_of_chain(replies: Sequence[bytes]) -> list[int]:
    """The n words that the n + 1 replies to `read_chain` bear."""
    return [int.from_bytes(_five(reply)[1:], "big") for reply in replies[1:]]
