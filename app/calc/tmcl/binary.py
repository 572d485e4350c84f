"""The binary file of a TMCL program: eight bytes a command, the last one their sum.

Opcode, type, motor or bank, four bytes of value with the most significant first, sum of the seven modulo 256
(PyTrinamic, `LoadTMCLBinary.py` and the `test.bin` beside it).
"""

from __future__ import annotations

import struct
from collections.abc import Iterable

from ...errors import UsageError
from .instructions import Command

RECORD_BYTES = 8
_COMMAND = struct.Struct(">BBBi")


def command_bytes(command: Command) -> bytes:
    """The seven bytes that a module stores, most significant byte of the value first."""
    return _COMMAND.pack(*command)


def command_of(seven: bytes) -> Command:
    """What seven stored bytes mean. Raises UsageError for another number of bytes."""
    if len(seven) != _COMMAND.size:
        raise UsageError(f"a stored TMCL command has {_COMMAND.size} bytes, not {len(seven)}")
    return Command(*_COMMAND.unpack(seven))


def to_binary(commands: Iterable[Command]) -> bytes:
    """The whole file."""
    parts = bytearray()
    for command in commands:
        seven = command_bytes(command)
        parts += seven
        parts.append(sum(seven) & 0xFF)
    return bytes(parts)


def from_binary(content: bytes) -> list[Command]:
    """The commands of a file. Raises UsageError for a length or a sum that is wrong, and says which record."""
    if len(content) % RECORD_BYTES:
        raise UsageError(
            f"a TMCL binary has {RECORD_BYTES} bytes for each command, and {len(content)} is no multiple of that: "
            "the file is cut off, or is no TMCL binary"
        )
    commands = []
    for at in range(0, len(content), RECORD_BYTES):
        seven, told = content[at : at + 7], content[at + 7]
        if sum(seven) & 0xFF != told:
            raise UsageError(
                f"command {at // RECORD_BYTES} of the TMCL binary has the sum {told:02X}h, its bytes give "
                f"{sum(seven) & 0xFF:02X}h: the file is damaged, or is no TMCL binary"
            )
        commands.append(command_of(seven))
    return commands
