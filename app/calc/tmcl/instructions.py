"""What an assembler has to know of a command: mnemonic, opcode, and which fields its operands fill."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal, NamedTuple

Operand = Literal["type", "motor", "value"]
OPERANDS: tuple[Operand, ...] = ("type", "motor", "value")
"""The order in which the operands of every command stand (FM-PD42-1241 3.6)."""


class Command(NamedTuple):
    """One command of a program. `motor` is the motor or the bank, `value` signed 32 bits."""

    opcode: int
    type: int = 0
    motor: int = 0
    value: int = 0


@dataclass(frozen=True, slots=True)
class Instruction:
    """A command with a mnemonic. `type_names` are the words for the values of its type byte, where it has any."""

    mnemonic: str
    opcode: int
    operands: tuple[Operand, ...]
    type_names: Mapping[str, int] = field(default_factory=dict)
    jumps: bool = False
    """Whether the value is an address of the program."""
    help: str = ""

    @property
    def usage(self) -> str:
        """How it is written: `WAIT TICKS|POS|REFSW|LIMSW|RFS, motor, value`."""
        words = [
            "|".join(self.type_names)
            if operand == "type" and self.type_names
            else "label"
            if operand == "value" and self.jumps
            else operand
            for operand in self.operands
        ]
        return f"{self.mnemonic} {', '.join(words)}".rstrip()


class InstructionSet:
    """The commands of a firmware, by mnemonic and by opcode; `memory` is how many commands a program may have."""

    def __init__(self, instructions: Iterable[Instruction], memory: int) -> None:
        self.memory = memory
        listed = tuple(instructions)
        self.by_mnemonic: Mapping[str, Instruction] = MappingProxyType({each.mnemonic: each for each in listed})
        self.by_opcode: Mapping[int, Instruction] = MappingProxyType({each.opcode: each for each in listed})
