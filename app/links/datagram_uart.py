"""Datagrams of the single-wire UART of the TMC5xxx and TMC22xx, both ways, with their CRC: pure functions, no port.

TMC5072, 5130 and 5160 (API headers and public host code of the maker): a write is sync 05, node, register + 0x80, 32
bits, CRC; a read is sync, node, register, CRC; the answer is sync, FF for the host, register, 32 bits, CRC. A TMC5062
has no node byte, and answers with F5 (its data sheet, page 23). Most significant byte first; the UART sends each byte's
lowest bit first, and in that order the CRC counts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..registers import catalog

SYNC = 0x05
"""Its low nibble lets the chip measure the baud rate."""
HOST = 0xFF
SYNC_5062_REPLY = 0xF5
NODE_MAX = HOST - 1
WRITE_BIT = 0x80
POLYNOMIAL = 0x07
"""x^8 + x^2 + x + 1."""
IFCNT = 0x02
"""Counts the writes that were accepted, modulo 256. Reading it changes nothing (TMC5160A data sheet 1.14, 5.1.1)."""


def _table() -> bytes:
    """The CRC's next state by state xor byte. Both are kept bit-reversed, so one table look-up is eight steps."""
    states = bytearray()
    reversed_polynomial = int(f"{POLYNOMIAL:08b}"[::-1], 2)
    for state in range(256):
        for _ in range(8):
            state = (state >> 1) ^ (reversed_polynomial if state & 1 else 0)
        states.append(state)
    return bytes(states)


_NEXT = _table()
_REVERSED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))


def crc8(data: bytes) -> int:
    """The CRC over all bytes of a datagram before it: start 0, no final inversion."""
    state = 0
    for byte in data:
        state = _NEXT[state ^ byte]
    return _REVERSED[state]


def is_sound(datagram: bytes) -> bool:
    """Whether the last byte of `datagram` is the CRC of those before it."""
    state = 0
    for byte in datagram[:-1]:
        state = _NEXT[state ^ byte]
    return _REVERSED[state] == datagram[-1]


@dataclass(frozen=True, slots=True)
class UartForm:
    """How the datagrams of a chip look. `node` is its address 0..254, None for a TMC5062, which has none.

    Raises ValueError for another node.
    """

    node: int | None = 0

    def __post_init__(self) -> None:
        if self.node is not None and not 0 <= self.node <= NODE_MAX:
            raise ValueError(f"a node is 0..{NODE_MAX}, not {self.node}")

    @property
    def write_bytes(self) -> int:
        """Length of a write."""
        return 7 if self.node is None else 8

    @property
    def read_bytes(self) -> int:
        """Length of a read request."""
        return 3 if self.node is None else 4

    @property
    def reply_bytes(self) -> int:
        """Length of an answer."""
        return self.write_bytes

    def write(self, register: int, data: int) -> bytes:
        """Write 32 bits to `register`, 0..127. Raises ValueError for what does not fit."""
        if not 0 <= data < 1 << 32:
            raise ValueError(f"data is 32 bits, not {data:#x}")
        return _closed(self._head + bytes((_register(register) | WRITE_BIT,)) + data.to_bytes(4, "big"))

    def read(self, register: int) -> bytes:
        """Ask for `register`, 0..127. Raises ValueError."""
        return _closed(self._head + bytes((_register(register),)))

    def reply(self, register: int, data: int) -> bytes:
        """What the chip answers."""
        head = bytes((SYNC_5062_REPLY,)) if self.node is None else bytes((SYNC, HOST))
        return _closed(head + bytes((_register(register),)) + data.to_bytes(4, "big"))

    def data_of(self, register: int, reply: bytes) -> int:
        """The 32 bits of the answer to a read of `register`. Raises ValueError that tells what is wrong with it."""
        if len(reply) != self.reply_bytes:
            raise ValueError(f"{len(reply)} bytes instead of {self.reply_bytes}")
        if crc8(reply[:-1]) != reply[-1]:
            raise ValueError(f"CRC {reply[-1]:#04x} instead of {crc8(reply[:-1]):#04x}")
        head = reply[: self.reply_bytes - 6]
        if head != (bytes((SYNC_5062_REPLY,)) if self.node is None else bytes((SYNC, HOST))):
            raise ValueError(f"it begins with {head.hex(' ')}: no answer to the host")
        if reply[-6] != register:
            raise ValueError(f"register {reply[-6]:#04x} instead of {register:#04x}")
        return int.from_bytes(reply[-5:-1], "big")

    def is_write(self, frame: bytes) -> bool:
        """Whether `frame`, a datagram to the chip, writes."""
        return bool(frame[self.read_bytes - 2] & WRITE_BIT)

    def register_of(self, frame: bytes) -> int:
        """The register that a datagram to the chip asks for or writes."""
        return frame[self.read_bytes - 2] & ~WRITE_BIT

    def check(self, frame: bytes) -> None:
        """Raises ValueError unless `frame` is a whole datagram to this chip, with the right CRC."""
        size = self.write_bytes if len(frame) >= self.read_bytes and self.is_write(frame) else self.read_bytes
        if len(frame) != size:
            raise ValueError(f"a datagram has {self.read_bytes} bytes to read, {self.write_bytes} to write")
        if not frame.startswith(self._head):
            raise ValueError(f"a datagram to this chip begins with {self._head.hex(' ')}, not {frame[:2].hex(' ')}")
        if crc8(frame[:-1]) != frame[-1]:
            raise ValueError(f"CRC {frame[-1]:#04x} instead of {crc8(frame[:-1]):#04x}")

    @property
    def _head(self) -> bytes:
        return bytes((SYNC,)) if self.node is None else bytes((SYNC, self.node))


def form_of(model: str, node: int = 0) -> UartForm:
    """The datagrams of `model` at `node`. Raises KeyError for a model without a UART, ValueError for another node."""
    kind = kind_of(model)
    if not kind:
        raise KeyError(model)
    return UartForm(None if kind == "plain" else node)


def kind_of(model: str) -> Literal["", "plain", "node"]:
    """What `model` has: no single-wire UART, one that it is alone on, or one where it has a node address."""
    return catalog.find_model(model).uart


def alone(model: str) -> bool:
    """Whether nothing but its UART leads to the chip `model`."""
    return catalog.is_model(model) and catalog.find_model(model).uart_alone


def node_max(model: str) -> int:
    """The greatest node address that `model` can have."""
    return (catalog.find_model(model).nodes or NODE_MAX + 1) - 1


def _closed(body: bytes) -> bytes:
    return body + bytes((crc8(body),))


def _register(register: int) -> int:
    if not 0 <= register < WRITE_BIT:
        raise ValueError(f"a register is 0x00..0x7f, not {register:#x}")
    return register
