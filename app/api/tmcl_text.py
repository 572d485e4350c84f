"""TMCL between people and the wire: a line or named fields to the four numbers of a command, and back."""

from __future__ import annotations

import re

from app.api.schemas_tmcl import TmclFields, TmclLine
from app.links.errors import OutOfRange, UnknownThing, UsageError
from app.links.tmcl import Request, as_value
from app.registers.tmcl import BY_OPCODE, COMMANDS, CommandRow, Opcode

Command = tuple[int, int, int, int]
"""Opcode, type, motor or bank, value."""

_NAMES = {name: code.value for name, code in Opcode.__members__.items()}
"""Mnemonics, and our names of the control commands, which have none."""
_NUMBER = re.compile(r"([+-]?)(?:(0[xX]|\$)([0-9A-Fa-f]+)|([0-9]+))\Z")


def command_of(body: TmclFields | TmclLine) -> Command:
    """The command that a request means. Raises UsageError (a line that is none), UnknownThing, OutOfRange."""
    if isinstance(body, TmclLine):
        return parse_line(body.line)
    opcode = body.command if isinstance(body.command, int) else _opcode(body.command)
    return opcode, _type(BY_OPCODE.get(opcode), body.type), body.motor, as_value(body.value)


def parse_line(line: str) -> Command:
    """`MVP ABS, 0, 51200` to numbers. Operands that a command does not have are left out (`MST 0`, `ROR 0, 5000`), or
    all three are given. Raises as `command_of` does.
    """
    word, _, rest = line.split(";")[0].strip().partition(" ")
    operands = [operand.strip() for operand in rest.split(",")] if rest.strip() else []
    if not word:
        raise UsageError("an empty line is no command")
    number = _number(word)
    opcode = _opcode(word) if number is None else _byte("command", number)
    row = BY_OPCODE.get(opcode)
    kinds = _operands(row) if row is not None and number is None else ("type", "motor", "value")[: len(operands)]
    if len(operands) == 3:
        kinds = ("type", "motor", "value")
    if len(operands) != len(kinds) or not all(operands):
        raise UsageError(f"{line.strip()!r} is no command; {_usage(word.upper(), row, kinds)}")
    parts = {"type": 0, "motor": 0, "value": 0}
    for kind, operand in zip(kinds, operands, strict=True):
        if kind == "type":
            parts[kind] = _type(row, operand)
        elif kind == "motor":
            parts[kind] = _byte("motor or bank", _needed("motor or bank", operand))
        else:
            parts[kind] = _value(_needed("value", operand))
    return opcode, parts["type"], parts["motor"], parts["value"]


def line_of(request: Request) -> str:
    """A command as one writes it: the reverse of `parse_line`."""
    row = BY_OPCODE.get(request.opcode)
    if row is None:
        return f"{request.opcode} {request.type}, {request.motor}, {request.value}"
    name = row.mnemonic or Opcode(request.opcode).name
    given = {"type": request.type, "motor": request.motor, "value": request.value}
    kinds = _operands(row)
    if any(number for kind, number in given.items() if kind not in kinds):
        kinds = ("type", "motor", "value")  # numbers where the command has none: shown, not hidden
    type_name = next((name for name, code in row.types.items() if code == request.type), str(request.type))
    shown = {**{kind: str(number) for kind, number in given.items()}, "type": type_name}
    return f"{name} {', '.join(shown[kind] for kind in kinds)}".strip()


def _operands(row: CommandRow) -> tuple[str, ...]:
    described = {"type": row.type or row.types, "motor": row.motor, "value": row.value}
    return tuple(kind for kind, text in described.items() if text)


def _usage(word: str, row: CommandRow | None, kinds: tuple[str, ...]) -> str:
    if row is None:
        return "write: opcode type, motor, value"
    parts = {
        "type": "|".join(row.types) if row.types else row.type,
        "motor": f"({row.motor or 'motor or bank'})",
        "value": f"({row.value or 'value'})",
    }
    operands = ", ".join(parts[kind] or f"({kind})" for kind in kinds)
    return f"write: {word} {operands}" if operands else f"write: {word}, without operands"


def _opcode(word: str) -> int:
    number = _number(word)
    if number is not None:
        return _byte("command", number)
    opcode = _NAMES.get(word.strip().upper())
    if opcode is None:
        raise UnknownThing("command", word, [row.mnemonic or Opcode(row.opcode).name for row in COMMANDS])
    return opcode


def _type(row: CommandRow | None, given: int | str) -> int:
    if isinstance(given, int):
        return given
    number = _number(given)
    if number is not None:
        return _byte("type", number)
    names = row.types if row is not None else {}
    code = names.get(given.strip().upper())
    if code is None:
        kind = f"type of {row.mnemonic or row.name}" if row is not None else "type"
        raise UnknownThing(kind, given, list(names) or ["a number, 0..255"])
    return code


def _number(text: str) -> int | None:
    match = _NUMBER.match(text.strip())
    if match is None:
        return None
    sign, _, hexadecimal, decimal = match.groups()
    number = int(hexadecimal, 16) if hexadecimal else int(decimal)
    return -number if sign == "-" else number


def _needed(name: str, text: str) -> int:
    number = _number(text)
    if number is None:
        raise UsageError(f"{name} is a number (decimal, 0x or $ hexadecimal), not {text!r}")
    return number


def _byte(name: str, number: int) -> int:
    if not 0 <= number <= 255:
        raise OutOfRange(name, number, 0, 255)
    return number


def _value(number: int) -> int:
    if not -(1 << 31) <= number < 1 << 32:
        raise OutOfRange("value", number, -(1 << 31), (1 << 32) - 1, "32 bits")
    return as_value(number)
