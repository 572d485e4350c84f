"""From a line as people write it in a TMCL program to the four numbers of a command."""

from __future__ import annotations

import re
from collections.abc import Mapping

from ..errors import OutOfRange, UnknownThing, UsageError
from ..registers.tmcl.commands import BY_OPCODE, COMMANDS, CommandRow, Opcode
from .tmcl import as_value

Command = tuple[int, int, int, int]
"""Opcode, type, motor or bank, value."""

_NAMES: Mapping[str, int] = {
    **{name: code.value for name, code in Opcode.__members__.items()},
    **{row.name.upper(): row.opcode for row in COMMANDS},
}
"""Mnemonics; of the control commands, which have none, what we call them, with spaces or underscores."""
_NUMBER = re.compile(r"([+-]?)(?:(?:0[xX]|\$)([0-9A-Fa-f]+)|([0-9]+))\Z")
_REMARK = re.compile(r";|//")
"""Our console began with semicolons; the maker's programs have slashes."""
_ALL = ("type", "motor", "value")


def parse_line(line: str) -> Command:
    """`MVP ABS, 0, 51200` to numbers; what the log and the console print is understood too.

    Operands that a command has no use for may be left out: `MST 0`, `ROR 0, 5000`, `CALC ADD, 7`; all three always
    work. What follows a semicolon or two slashes is a remark. Raises UsageError (a line that is none), UnknownThing,
    OutOfRange.
    """
    text = _REMARK.split(line, maxsplit=1)[0].strip()
    if not text:
        raise UsageError("an empty line is no command")
    if not text.isascii():  # some letters have capitals of another length
        raise UsageError(f"TMCL has no such letters: {text!r}")
    name = _name_at_start(text)
    opcode = opcode_of(name.removeprefix("COMMAND "))
    row = BY_OPCODE.get(opcode)
    rest = text[len(name) :].strip()
    operands = [operand.strip() for operand in rest.split(",")] if rest else []
    kinds = _kinds(row, len(operands))
    if kinds is None or not all(operands):
        raise UsageError(f"{text!r} is no command; write: {_usage(name, row)}")
    given = dict(zip(kinds, operands, strict=True))
    motor, value = _whole("motor or bank", given.get("motor", "0")), _whole("value", given.get("value", "0"))
    if not -(1 << 31) <= value < 1 << 32:
        raise OutOfRange("value", value, -(1 << 31), (1 << 32) - 1, "32 bits")
    return opcode, type_of(row, given.get("type", "0")), _byte("motor or bank", motor), as_value(value)


def _name_at_start(text: str) -> str:
    """The command at the start of a line in capitals: the longest name that fits, else the first word."""
    upper = text.upper()
    unnamed = re.match(r"COMMAND +\S+", upper)
    if unnamed:
        return unnamed[0]
    fitting = [name for name in _NAMES if upper == name or upper.startswith(f"{name} ")]
    return max(fitting, key=len, default=upper.partition(" ")[0])


def _kinds(row: CommandRow | None, given: int) -> tuple[str, ...] | None:
    """What that many operands are; None where no reading has so many."""
    own = _own(row)
    for used in (own, {*own, "motor"}, {*own, "motor", "type"}, _ALL):
        kinds = tuple(kind for kind in _ALL if kind in used)
        if len(kinds) == given:
            return kinds
    return None


def _own(row: CommandRow | None) -> tuple[str, ...]:
    """The operands that a command has a use for."""
    if row is None:
        return _ALL
    used = {"type": row.type or row.types, "motor": row.motor, "value": row.value}
    return tuple(kind for kind in _ALL if used[kind])


def _usage(name: str, row: CommandRow | None) -> str:
    if row is None:
        return f"{name} type, motor, value"
    meaning = {"type": "|".join(row.types) or f"({row.type})", "motor": f"({row.motor})", "value": f"({row.value})"}
    operands = ", ".join(meaning[kind] for kind in _own(row))
    return f"{name} {operands}" if operands else f"{name}, without operands"


def opcode_of(word: str) -> int:
    """The number of a command, given by mnemonic, by our name or as a number. Raises UnknownThing, OutOfRange."""
    number = _number(word)
    if number is not None:
        return _byte("command", number)
    opcode = _NAMES.get(word.strip().upper())
    if opcode is None:
        raise UnknownThing("command", word, [row.mnemonic or Opcode(row.opcode).name for row in COMMANDS])
    return opcode


def type_of(row: CommandRow | None, given: int | str) -> int:
    """The type byte, given by name or as a number. Raises UnknownThing, OutOfRange."""
    if isinstance(given, int):
        return given
    number = _number(given)
    if number is not None:
        return _byte("type", number)
    names = row.types if row is not None else {}
    code = names.get(given.strip().upper())
    if code is None:
        kind = "type" if row is None else f"type of {row.mnemonic or row.name}"
        raise UnknownThing(kind, given, list(names) or ["numbers, 0..255"])
    return code


def _number(text: str) -> int | None:
    """Decimal, or hexadecimal behind 0x or $; None for what is no number."""
    match = _NUMBER.match(text.strip())
    if match is None:
        return None
    sign, hexadecimal, decimal = match.groups()
    number = int(hexadecimal, 16) if hexadecimal else int(decimal)
    return -number if sign == "-" else number


def _whole(name: str, text: str) -> int:
    number = _number(text)
    if number is None:
        raise UsageError(f"{name} is a number (decimal, or hexadecimal behind 0x or $), not {text!r}")
    return number


def _byte(name: str, number: int) -> int:
    if not 0 <= number <= 255:
        raise OutOfRange(name, number, 0, 255)
    return number
