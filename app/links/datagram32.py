"""The 32-bit datagram of TMC428 and TMC4210, both ways: pure functions, no port.

To the chip (DS-TMC428 Table 6-3; DS-TMC4210 5.2.2.1): RRS and six address bits, RW (1 reads), 24 data bits.
From the chip (DS-TMC428 Table 6-4; DS-TMC4210 5.2.2.2): eight status bits, 24 data bits. On the wire the most
significant byte goes first.
"""

from __future__ import annotations

from dataclasses import dataclass

FRAME_BYTES = 4
DATA_MASK = 0xFF_FFFF


@dataclass(frozen=True, slots=True)
class Request:
    """One datagram to the chip. `address` is 7 bits, RRS as bit 6; `data` 24 bits, 0 for a read."""

    address: int
    read: bool
    data: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.address <= 0x7F:
            raise ValueError(f"an address is 0x00..0x7f, not {self.address:#x}")
        if not 0 <= self.data <= DATA_MASK:
            raise ValueError(f"data is 24 bits, not {self.data:#x}")

    def encode(self) -> bytes:
        return (self.address << 25 | self.read << 24 | self.data).to_bytes(FRAME_BYTES, "big")

    @classmethod
    def decode(cls, frame: bytes) -> Request:
        """Raises ValueError unless the frame is 4 bytes long."""
        word = _word(frame)
        return cls(word >> 25, bool(word >> 24 & 1), word & DATA_MASK)


@dataclass(frozen=True, slots=True)
class Reply:
    """One datagram from the chip: `status` 8 bits, `data` 24 bits."""

    status: int
    data: int

    def encode(self) -> bytes:
        return (self.status << 24 | self.data).to_bytes(FRAME_BYTES, "big")

    @classmethod
    def decode(cls, frame: bytes) -> Reply:
        """Raises ValueError unless the frame is 4 bytes long."""
        word = _word(frame)
        return cls(word >> 24, word & DATA_MASK)


def _word(frame: bytes) -> int:
    if len(frame) != FRAME_BYTES:
        raise ValueError(f"a datagram has {FRAME_BYTES} bytes, not {len(frame)}")
    return int.from_bytes(frame, "big")


def read(address: int) -> bytes:
    """The frame that asks for the register at `address`."""
    return Request(address, read=True).encode()


def write(address: int, data: int) -> bytes:
    """The frame that writes 24 raw bits to `address`."""
    return Request(address, read=False, data=data).encode()


def status_flags(status: int, names: tuple[str, ...]) -> dict[str, bool]:
    """The named status bits of a reply."""
    return {name: bool(status >> bit & 1) for bit, name in enumerate(names) if name}
