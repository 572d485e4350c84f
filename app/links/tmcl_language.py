"""TMCL as an assembler needs it: its commands, and the names of a module's parameters, from the tables."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ..calc.tmcl.instructions import OPERANDS, Instruction, InstructionSet
from ..registers.model import Space
from ..registers.tmcl.commands import COMMANDS, INTERRUPT_NAMES, PROGRAM_COMMANDS, CommandRow
from ..registers.tmcl.description import TmclModule

PARAMETERS_FILE, INTERRUPTS_FILE = "TMCLParam.tmc", "Interrupts.inc"
"""Files of names that programs include (FM-PD42-1241 3.5.6.4 and 8.3). The maker's are not public: ours have the names
that the manual shows, and for all else names of our tables."""
MANUAL_NAMES: Mapping[str, int] = MappingProxyType({"APMaxPositioningSpeed": 4, "APMaxAcceleration": 5, "Motor0": 0})
"""Names that the example of FM-PD42-1241 8.3 uses."""
_PREFIXES = {Space.AXIS: "AP", Space.GLOBAL_0: "GP", Space.GLOBAL_3: "GP3"}


def _instruction(row: CommandRow) -> Instruction:
    used = {"type": row.type or row.types, "motor": row.motor, "value": row.value}
    return Instruction(
        row.mnemonic,
        row.opcode,
        tuple(operand for operand in OPERANDS if used[operand]),
        row.types,
        row.jumps,
        row.help,
    )


INSTRUCTIONS = InstructionSet((_instruction(row) for row in COMMANDS if row.mnemonic), PROGRAM_COMMANDS)
"""Every command that a program may hold."""


def parameter_names(module: TmclModule) -> dict[str, int]:
    """Names for the numbers of a module's parameters: `APTargetPosition`, `GPSerialBaudRate`, and the manual's."""
    names = {
        prefix + "".join(part.capitalize() for part in row.name.split("_")): row.address
        for space, prefix in _PREFIXES.items()
        for row in module.rows(space).values()
    }
    return {**names, **MANUAL_NAMES}


def standard_includes(module: TmclModule) -> dict[str, str]:
    """The files that every program may include, by name."""
    return {
        PARAMETERS_FILE: _constants(parameter_names(module)),
        INTERRUPTS_FILE: _constants(INTERRUPT_NAMES),
    }


def standard_include(module: TmclModule, name: str) -> str | None:
    """The text of an included file that every program may have; None for another."""
    return next((text for file, text in standard_includes(module).items() if file.upper() == name.upper()), None)


def _constants(names: Mapping[str, int]) -> str:
    return "".join(f"{name} = {number}\n" for name, number in names.items())
