"""A CAN message with an 11-bit identifier, and what a bus asks of a module that hangs on it."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Protocol, Self, runtime_checkable

from .module import LineModule

_IDENTIFIER = struct.Struct(">H")


@dataclass(frozen=True, slots=True)
class CanMessage:
    """`identifier` 0..2047, and up to eight bytes of data."""

    identifier: int
    data: bytes

    def packed(self) -> bytes:
        """As a line delivers it: two bytes of identifier, then the data."""
        return _IDENTIFIER.pack(self.identifier) + self.data

    @classmethod
    def unpacked(cls, delivered: bytes) -> Self:
        """Of what `packed` gave."""
        return cls(_IDENTIFIER.unpack_from(delivered)[0], delivered[_IDENTIFIER.size :])


@runtime_checkable
class CanModule(LineModule, Protocol):
    """A module with a CAN interface beside its serial one."""

    @property
    def can_bit_rate(self) -> int | None:
        """Of its interface since power-on [bit/s]; None for a model that has none."""
        ...

    def receive_message(self, message: CanMessage, at_s: float | None = None) -> CanMessage | None:
        """Take a message at module time `at_s` [s]; None where no answer is due: another identifier, suppressed."""
        ...

    def as_message(self, frame: bytes) -> CanMessage:
        """A frame of its own (position reached) as it is said on the bus."""
        ...
