"""How a datagram on SPI says a register, for chips whose datagrams are not those that a family knows by itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

WORD_BITS_MAX = 53
"""Bits of a register: what a number of JSON holds in every browser."""


@dataclass(frozen=True, slots=True)
class SpiFormat:
    """A datagram of whole bytes: a head with the address and the write bit, then the data.

    data_bits : 8 to 64, a multiple of 8
    address_bits : 1 to 15; where head and address leave bits over, those are 0
    write_bit : whether the write bit is the highest of the head, or the lowest, below the address
    write_is : what that bit is in a write
    byte_order : of the data; the head goes highest byte first
    answer : whether an answer comes with the next datagram or with the same

    An answer is as long, and has its data where a write has them. Raises ValueError for what cannot be.
    """

    data_bits: int = 32
    address_bits: int = 7
    write_bit: Literal["high", "low"] = "high"
    write_is: Literal[0, 1] = 1
    byte_order: Literal["big", "little"] = "big"
    answer: Literal["next", "same"] = "next"

    def __post_init__(self) -> None:
        if not 8 <= self.data_bits <= 64 or self.data_bits % 8:
            raise ValueError(f"data has 8, 16, 24 ... 64 bits, not {self.data_bits}")
        if not 1 <= self.address_bits <= 15:
            raise ValueError(f"an address has 1 to 15 bits, not {self.address_bits}")

    @property
    def head_bytes(self) -> int:
        """Length of what stands before the data."""
        return (self.address_bits + 1 + 7) // 8

    @property
    def frame_bytes(self) -> int:
        """Length of a datagram, and of its answer."""
        return self.head_bytes + self.data_bits // 8

    @property
    def address_max(self) -> int:
        """The highest address."""
        return (1 << self.address_bits) - 1

    @property
    def word_bits(self) -> int:
        """How many bits a register of it can have here."""
        return min(self.data_bits, WORD_BITS_MAX)


USUAL = SpiFormat()
"""The 40 bits of most chips of this maker (DS-TMC4361 5.1)."""


@dataclass(frozen=True, slots=True)
class TaggedFormat:
    """20 bits whose uppermost say which register they are written to; nothing reads one (API, `tmc/ic/TMC2660`).

    Every datagram is answered by 20 bits at once: a status, which of several a field of one register selects. They
    travel as 24 bits, of which the chip takes the last, and whose first are the answer.

    written : what the addresses of registers have that are written, above the bits of a datagram; the others are
        numbers of statuses
    selecting : address of the register with the field that selects a status; `select_lsb` its lowest bit
    """

    written: int = 0x8
    selecting: int = 0xF
    select_lsb: int = 4
    select_bits: int = 2
    tag_lsb: int = 17
    frame_bytes: int = 3
    word_bits: int = 20

    def is_written(self, address: int) -> bool:
        """Whether the register is one that is written, and never read."""
        return bool(address & self.written)

    def width_of(self, address: int) -> int:
        """Bits of a register below those that say which it is; of a status all."""
        if not self.is_written(address):
            return self.word_bits
        return self.tag_lsb if address & ~self.written else self.tag_lsb + 1

    def tag_of(self, address: int) -> int:
        """What a datagram has above the word of a register that is written."""
        return (address & ~self.written) << self.tag_lsb

    def address_of(self, datagram: int) -> int:
        """The register that 20 bits are written to: those with an upper 00 have a bit more of data."""
        upper = datagram >> self.tag_lsb
        return self.written | (upper if upper >> 1 else 0)


Spi = SpiFormat | TaggedFormat
