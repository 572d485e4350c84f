"""From commands back to the text of a program, and the listing of one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .assembler import RAW, Assembly
from .binary import command_bytes
from .instructions import Command, InstructionSet


def disassemble(
    commands: Sequence[Command],
    instructions: InstructionSet,
    labels: Mapping[str, int] | None = None,
    *,
    first: int = 0,
) -> str:
    """A program that assembles to exactly these commands, of which the first is at address `first`.

    Jumps go to labels: those of `labels`, else `L` and the address; to addresses as numbers where it begins behind 0,
    for the labels of a text count from 0 on. What has no mnemonic, or fills fields that its mnemonic has no operand
    for, is written as `.command`.
    """
    names = {} if first else _names(commands, instructions, labels or {})
    lines = []
    for at, command in enumerate(commands):
        lines += [f"{name}:" for name in names.get(at, ())]
        lines.append(f"    {spell(command, instructions, names)}")
    lines += [f"{name}:" for name in names.get(len(commands), ())]
    return "".join(f"{line}\n" for line in lines)


def spell(command: Command, instructions: InstructionSet, names: Mapping[int, Sequence[str]] | None = None) -> str:
    """One command as it is written: `MVP ABS, 0, 51200`. `names` are labels by address."""
    instruction = instructions.by_opcode.get(command.opcode)
    if instruction is None:
        return _raw(command)
    fields = {"type": str(command.type), "motor": str(command.motor), "value": str(command.value)}
    for name, code in instruction.type_names.items():
        if code == command.type:
            fields["type"] = name
    if instruction.jumps:
        if not 0 <= command.value < instructions.memory:
            return _raw(command)
        targets = (names or {}).get(command.value)
        if targets:
            fields["value"] = targets[0]
    if any(getattr(command, unused) for unused in fields if unused not in instruction.operands):
        return _raw(command)
    return f"{instruction.mnemonic} {', '.join(fields[operand] for operand in instruction.operands)}".rstrip()


def listing(assembly: Assembly, instructions: InstructionSet) -> str:
    """Address, bytes, source line and command of each, then the labels with their addresses."""
    names = _names(assembly.commands, instructions, assembly.labels)
    lines = []
    for at, (command, place) in enumerate(zip(assembly.commands, assembly.places, strict=True)):
        label = " ".join(f"{name}:" for name in names.get(at, ()))
        text = f"{label} {spell(command, instructions, names)}".strip()
        lines.append(f"{at:5d}  {command_bytes(command).hex(' ').upper()}  {place.file}:{place.line}  {text}")
    if assembly.labels:
        lines += ["", "labels"]
        lines += [f"{address:5d}  {name}" for name, address in sorted(assembly.labels.items(), key=lambda it: it[1])]
    return "".join(f"{line}\n" for line in lines)


def _names(
    commands: Sequence[Command], instructions: InstructionSet, labels: Mapping[str, int]
) -> dict[int, list[str]]:
    names: dict[int, list[str]] = {}
    for name, address in labels.items():
        names.setdefault(address, []).append(name)
    taken = {name.upper() for name in labels}
    for command in commands:
        instruction = instructions.by_opcode.get(command.opcode)
        if instruction is not None and instruction.jumps and 0 <= command.value <= len(commands):
            name = f"L{command.value}"
            if command.value not in names and name not in taken:
                names[command.value] = [name]
    return names


def _raw(command: Command) -> str:
    return f"{RAW} {command.opcode}, {command.type}, {command.motor}, {command.value}"
