"""The EEPROM of a board in a slot, by which it says what it is (TMC-EvalSystem, tmc/EEPROM.h): commands 65 and 66."""

from __future__ import annotations

import struct

SIZE = 1 << 14
"""Bytes of a 25128; further address bits do not count, and reading goes on at the beginning."""
MAGIC = 0x3412
HARDWARE_VERSION = (1, 0)
"""Of the emulated boards; nobody asks for it but who reads the EEPROM."""
ABSENT = -1
"""What four bytes read as where no board drives the line: pulled high (decided here; the firmware does not say)."""
_HEAD = struct.Struct("<16sHBBH")
"""Name, number, hardware version, magic number."""


class IdentityEeprom:
    """16 KiB that keep what is written to them; the firmware's idea of the board is not changed by it."""

    def __init__(self, name: str, number: int) -> None:
        head = _HEAD.pack(name.encode(), number, *HARDWARE_VERSION, MAGIC)
        self._bytes = bytearray(head + b"\xff" * (SIZE - len(head)))

    def read(self, address: int) -> int:
        """Four bytes from `address` on, the lowest first, as a signed number."""
        found = bytes(self._bytes[(address + at) % SIZE] for at in range(4))
        return int.from_bytes(found, "little", signed=True)

    def write(self, address: int, value: int) -> None:
        """One byte."""
        self._bytes[address % SIZE] = value & 0xFF
