"""From the text of a TMCL program to its commands, with everything that is wrong told at once.

A line holds labels (`Loop:`), then a command with its operands, a constant (`Speed = 500`) or `#include File`;
`//` and `;` begin a comment (FM-PD42-1241 2.4, 3.5.6.4, 8.3, 8.6). Addresses count commands. Open in FM-PD42-1241, and
decided here:
- capitals make no difference, neither in mnemonics nor in names (as in github.com/raceresult/go-tmcl, whose output is
  tested against the maker's assembler);
- numbers are decimal, hexadecimal behind 0x or $, or binary behind %; a name may have a sign before it;
- a label or constant of the same name as another is an error, unless it is a constant of the same value;
- `.command opcode, type, motor, value` stores any command: what has no mnemonic can so be written, too.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import NamedTuple

from .instructions import Command, Instruction, InstructionSet, Operand

INCLUDE_DEPTH = 8
LINES_MAX = 50_000
PROBLEMS_MAX = 100
RAW = ".command"

Resolver = Callable[[str], str | None]
"""The text of an included file by its name; None where there is none."""

_LABEL = re.compile(r"\s*([A-Za-z_]\w*):", re.ASCII)
_COMMAND = re.compile(r"\s*([A-Za-z_.]\w*)(?:\s+(.*\S))?\s*\Z", re.ASCII)
_CONSTANT = re.compile(r"\s*([A-Za-z_]\w*)\s*=\s*(.*?)\s*\Z", re.ASCII)
_INCLUDE = re.compile(r"\s*#include\s+(?:<([^<>]+)>|\"([^\"]+)\"|(\S+))\s*\Z", re.IGNORECASE)
_NUMBER = re.compile(r"([+-]?)(?:([0-9]+)|(?:0[xX]|\$)([0-9A-Fa-f]+)|%([01]+))\Z")
_NAME = re.compile(r"([+-]?)([A-Za-z_]\w*)\Z", re.ASCII)


class Place(NamedTuple):
    """A line of a file, both as people count them."""

    file: str
    line: int


@dataclass(frozen=True, slots=True)
class Problem:
    """Something wrong with a program, and what was expected there. Lines and columns count from 1."""

    file: str
    line: int
    column: int
    message: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}: {self.message}"


@dataclass(slots=True)
class Assembly:
    """A program as commands. With `problems` the commands are not to be used."""

    commands: list[Command] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    """Where each command was written."""
    labels: dict[str, int] = field(default_factory=dict)
    """Addresses by name, as it was written."""
    constants: dict[str, int] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)


class _Line(NamedTuple):
    """A command whose operands are not resolved yet: names may be defined further down."""

    place: Place
    text: str
    instruction: Instruction | None
    operands: list[str]


def assemble(
    text: str,
    instructions: InstructionSet,
    *,
    name: str = "program",
    resolve: Resolver = lambda _: None,
) -> Assembly:
    """The commands of `text`, whose file is called `name` in messages."""
    return _Assembler(instructions, resolve).run(text, name)


class _Assembler:
    def __init__(self, instructions: InstructionSet, resolve: Resolver) -> None:
        self._instructions = instructions
        self._resolve = resolve
        self._limit = instructions.memory
        self._made = Assembly()
        self._names: dict[str, int] = {}
        """Labels and constants, in capitals."""
        self._defined: dict[str, Place] = {}
        self._lines: list[_Line] = []
        self._read = 0
        self._included: set[str] = set()
        self._suggested: dict[str, str] = {}
        """For names that stand for nothing: one that stands in a thousand lines is looked up once."""

    def run(self, text: str, name: str) -> Assembly:
        self._file(text, name, (name,))
        made = self._made
        for line in self._lines:
            made.commands.append(self._command(line))
            made.places.append(line.place)
        if len(self._lines) > self._limit:
            place = self._lines[self._limit].place
            self._tell(
                place,
                1,
                f"the program has {len(self._lines)} commands, the module holds {self._limit}: shorten it, this is "
                "the first that does not fit",
            )
        made.problems.sort(key=lambda problem: (problem.file != name, problem.file, problem.line, problem.column))
        return made

    # --- lines -----------------------------------------------------------------------------------

    def _file(self, text: str, name: str, chain: tuple[str, ...]) -> None:
        for number, raw in enumerate(text.splitlines(), 1):
            self._read += 1
            if self._read > LINES_MAX:
                if self._read == LINES_MAX + 1:
                    self._tell(
                        Place(name, number), 1, f"more than {LINES_MAX} lines with all includes: nobody reads on"
                    )
                return
            line = raw
            if "/" in line:
                line = line.partition("//")[0]
            if ";" in line:
                line = line.partition(";")[0]
            if line and not line.isspace():
                self._line(line, Place(name, number), chain)

    def _line(self, line: str, place: Place, chain: tuple[str, ...]) -> None:
        at = 0
        if ":" in line:
            while (label := _LABEL.match(line, at)) is not None:
                self._define(label[1], len(self._lines), place, label.start(1) + 1, self._made.labels)
                at = label.end()
            if not line[at:].strip():
                return
        if "=" in line and (constant := _CONSTANT.match(line, at)) is not None:
            value = self._number(constant[2], place, constant.start(2) + 1)
            if value is not None:
                self._define(constant[1], value, place, constant.start(1) + 1, self._made.constants)
            return
        command = _COMMAND.match(line, at)
        if command is None:
            self._other(line, at, place, chain)
            return
        mnemonic, rest = command[1], command[2]
        instruction = self._instructions.by_mnemonic.get(mnemonic.upper())
        operands = [operand.strip() for operand in rest.split(",")] if rest else []
        if instruction is None and mnemonic.lower() != RAW:
            self._tell(place, command.start(1) + 1, self._unknown(mnemonic, rest or ""))
        else:
            expected = 4 if instruction is None else len(instruction.operands)
            if len(operands) != expected:
                self._tell(place, command.start(1) + 1, _miscounted(instruction, len(operands)))
            else:
                self._lines.append(_Line(place, line, instruction, operands))
                return
        self._lines.append(_Line(place, line, None, ["0"] * 4))  # so that addresses after it stay right

    def _other(self, line: str, at: int, place: Place, chain: tuple[str, ...]) -> None:
        include = _INCLUDE.match(line, at)
        column = len(line[at:]) - len(line[at:].lstrip()) + at + 1
        if include is not None:
            self._include(include[1] or include[2] or include[3], place, column, chain)
            return
        bad = next((place_ for place_, letter in enumerate(line[at:]) if not letter.isascii()), None)
        if bad is not None:
            self._tell(place, at + bad + 1, f"{line[at + bad]!r} means nothing in TMCL: names have letters a to z")
        else:
            self._tell(
                place,
                column,
                f"{line.strip()!r} is no line of a program: expected a label (Name:), a command, Name = number or "
                "#include File",
            )

    def _include(self, name: str, place: Place, column: int, chain: tuple[str, ...]) -> None:
        if name in chain:
            self._tell(place, column, f"{name} includes itself: {' > '.join((*chain, name))}")
        elif len(chain) > INCLUDE_DEPTH:
            self._tell(place, column, f"includes are nested more than {INCLUDE_DEPTH} deep")
        elif name not in self._included:  # twice would define every label twice
            text = self._resolve(name)
            if text is None:
                self._tell(place, column, f"there is no file {name} to include: expected one beside the program")
                return
            self._included.add(name)
            self._file(text, name, (*chain, name))

    def _unknown(self, mnemonic: str, rest: str) -> str:
        if rest.startswith(":"):
            return f"a label has its colon right behind its name: write {mnemonic}:"
        close = get_close_matches(mnemonic.upper(), self._instructions.by_mnemonic, 1)
        return f"no command is called {mnemonic}: expected {f'{close[0]}, or another' if close else 'a'} mnemonic"

    # --- names -----------------------------------------------------------------------------------

    def _define(self, name: str, value: int, place: Place, column: int, table: dict[str, int]) -> None:
        key = name.upper()
        earlier = self._defined.get(key)
        if earlier is None:
            self._defined[key] = place
            self._names[key] = table[name] = value
        elif table is self._made.labels or self._names[key] != value:
            self._tell(
                place, column, f"{name} is defined already, in {earlier.file}:{earlier.line}: expected another name"
            )

    def _number(self, text: str, place: Place, column: int, what: str = "a number") -> int | None:
        """A number or what a name stands for; None, and a problem, for neither."""
        if text.isdecimal():
            return int(text[:20])  # more digits would be out of every range
        number = _NUMBER.match(text)
        if number is not None:
            sign, decimal, hexadecimal, binary = number.groups()
            size = int(decimal[:20]) if decimal else int(hexadecimal, 16) if hexadecimal else int(binary, 2)
            return -size if sign == "-" else size
        name = _NAME.match(text)
        value = None if name is None else self._names.get(name[2].upper())
        if name is None or value is None:
            self._tell(place, column, self._nameless(text, name, what))
            return None
        return -value if name[1] == "-" else value

    def _nameless(self, text: str, name: re.Match[str] | None, what: str) -> str:
        if not text:
            return f"expected {what}, found nothing"
        if name is None:
            return f"expected {what}, found {text!r}: decimal, hexadecimal behind 0x or $, binary behind %"
        key = name[2].upper()
        if key not in self._suggested:
            close = get_close_matches(key, self._names, 1) if len(self._suggested) < PROBLEMS_MAX else ()
            self._suggested[key] = f", such as {close[0]}" if close else ""
        return f"nothing is called {name[2]}: expected {what}{self._suggested[key]}"

    # --- commands --------------------------------------------------------------------------------

    def _command(self, line: _Line) -> Command:
        instruction = line.instruction
        if instruction is None:
            opcode, type_, motor = (self._operand(line, place, 0, 255) for place in range(3))
            return Command(opcode, type_, motor, self._value(line, 3))
        given: dict[Operand, int] = {}
        for place, operand in enumerate(instruction.operands):
            if operand == "value":
                if instruction.jumps:
                    given["value"] = self._operand(line, place, 0, self._limit - 1, "a label or an address")
                else:
                    given["value"] = self._value(line, place)
                continue
            text = line.operands[place]
            if operand == "type" and instruction.type_names:
                code = instruction.type_names.get(text.upper())
                if code is None:
                    code = self._operand(line, place, 0, 255, " or ".join(instruction.type_names))
                given["type"] = code
            else:
                given[operand] = self._operand(line, place, 0, 255)
        return Command(instruction.opcode, given.get("type", 0), given.get("motor", 0), given.get("value", 0))

    def _value(self, line: _Line, place: int) -> int:
        value = self._operand(line, place, -(1 << 31), (1 << 32) - 1)
        return value - (1 << 32) if value >= 1 << 31 else value

    def _operand(self, line: _Line, place: int, least: int, most: int, what: str = "a number") -> int:
        text = line.operands[place]
        if text.isdecimal() and len(text) < 4 and int(text) <= most:
            return int(text)
        before = len(self._made.problems)
        value = self._number(text, line.place, 0, what)
        if value is None:
            self._at_operand(line, place, before)
            return 0
        if not least <= value <= most:
            found = f"{text} is {value}" if _NAME.match(text) else f"{text} is out of range"
            self._tell(line.place, 0, f"{found}, allowed is {least}..{most}")
            self._at_operand(line, place, before)
            return 0
        return value

    # --- problems --------------------------------------------------------------------------------

    def _tell(self, place: Place, column: int, message: str) -> None:
        if len(self._made.problems) < PROBLEMS_MAX:
            self._made.problems.append(Problem(place.file, place.line, column, message))

    def _at_operand(self, line: _Line, place: int, before: int) -> None:
        """Give the problem that was told last the column of an operand, which only a wrong one has to have."""
        if len(self._made.problems) == before:
            return  # there are too many already
        told = self._made.problems[before]
        at = line.text.find(":") + 1
        while _LABEL.match(line.text, at):
            at = line.text.index(":", at) + 1
        command = _COMMAND.match(line.text, at)
        assert command is not None
        column = command.start(2)
        for operand in command[2].split(",")[:place]:
            column += len(operand) + 1
        column += len(line.text[column:]) - len(line.text[column:].lstrip()) + 1
        self._made.problems[before] = Problem(told.file, told.line, column, told.message)


def _miscounted(instruction: Instruction | None, given: int) -> str:
    if instruction is None:
        return f"{RAW} has {given} operands: expected {RAW} opcode, type, motor, value"
    wanted = len(instruction.operands)
    plural = "" if wanted == 1 else "s"
    return f"{instruction.mnemonic} has {wanted or 'no'} operand{plural}, not {given}: expected {instruction.usage}"
