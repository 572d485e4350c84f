"""The parameters of one module as rows, from the classes that the package has for it.

The package tells names and numbers. What it does not tell is unknown, and rows say so: the width is that of a TMCL
value, the value after power-on is None, and whether a parameter can be written the module alone knows. By TMCL's
standard meaning a few names tell more (`STANDARD`), and so do the kinds of inputs and outputs (`PORTS`).
"""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from ...errors import UnreadableModel
from ..model import Access, Register, RegisterTable, Space
from ..tmcl.commands import EXTENDED_ERRORS
from .package import PACKAGE, Listing, version

BITS = 32
NUMBER_MAX = (1 << 12) - 1
"""The greatest number of a parameter that a command can bear."""
UNKNOWN = "the package tells its name alone: range, unit, access and value after power-on are not known"
_BANK = re.compile(r"^GP(\d?)$")
_SPACES = {0: Space.GLOBAL_0, 2: Space.GLOBAL_2, 3: Space.GLOBAL_3}
_PORT_CLASSES = {"DI": Space.DIGITAL_IN, "AIN": Space.ANALOG_IN, "DO": Space.OUTPUT}
_MIXED_PORTS = "IO"
"""A class of ports of all kinds: of which kind each is its own name tells."""
_PORT_NAMES = {
    Space.DIGITAL_IN: re.compile(r"^(IN|GPI)_?\d+$"),
    Space.ANALOG_IN: re.compile(r"^((AIN|ADIN)_?\d+|VIN|Voltage|Temperature)$"),
    Space.OUTPUT: re.compile(r"^(OUT|GPO)_?\d+$"),
}
_CLEARING = re.compile(r"flags", re.IGNORECASE)
"""Names of parameters of which manuals say for some modules, and the package for none, that reading clears them."""


Role = Literal[
    "target_position", "position", "target_speed", "speed", "max_speed", "max_acceleration", "position_reached"
]


@dataclass(frozen=True, slots=True)
class Meaning:
    """What TMCL means by a name, on every module that has it."""

    help: str
    role: Role | None = None
    access: Access = Access.RW
    volatile: bool = False


STANDARD: Mapping[str, Meaning] = {
    "targetposition": Meaning("where a positioning goes; writing it starts one", "target_position"),
    "actualposition": Meaning("the position counter", "position", volatile=True),
    "targetvelocity": Meaning("the speed of a rotation; writing it starts one", "target_speed"),
    "actualvelocity": Meaning("the speed now", "speed", Access.R, volatile=True),
    "maxvelocity": Meaning("the greatest speed of a positioning", "max_speed"),
    "maxpositioningspeed": Meaning("the greatest speed of a positioning", "max_speed"),
    "maxacceleration": Meaning("the greatest acceleration of a ramp", "max_acceleration"),
    "positionreachedflag": Meaning(
        "1 while the axis stands at its target", "position_reached", Access.R, volatile=True
    ),
}
"""By the name in small letters. FM-PD42-1241 and FM-TMCM-1161 mean the same by them."""
PORTS: Mapping[Space, Meaning] = {
    Space.DIGITAL_IN: Meaning("a digital input (GIO, bank 0)", access=Access.R, volatile=True),
    Space.ANALOG_IN: Meaning(
        "an analog input (GIO, bank 1); what it counts in is not known", access=Access.R, volatile=True
    ),
    Space.OUTPUT: Meaning("a digital output (SIO and GIO, bank 2)"),
}
"""What TMCL means by a port of each kind (FM-PD42-1241 3.6.12, 3.6.13)."""
NEEDED: tuple[Role, ...] = ("target_position", "position", "target_speed", "speed", "max_speed", "max_acceleration")
"""Without these nobody could tell where an axis is, or send it anywhere."""


def role_of(row: Register) -> Role | None:
    """What TMCL's standard meaning makes of a parameter; None of most."""
    meaning = STANDARD.get(row.name.casefold()) if row.space is Space.AXIS and not row.when else None
    return None if meaning is None else meaning.role


def _unreadable(listing: Listing, why: str) -> UnreadableModel:
    return UnreadableModel(
        f"{PACKAGE} {version()} lists a {listing.title}, but {why}; another version of it may be understood"
    )


class _Unconnected:
    """Stands for a connection while a module is only looked at."""

    def __getattr__(self, name: str) -> object:
        raise ConnectionError(f"its class asks the module for something ({name}) as it is made")


def read(listing: Listing) -> RegisterTable:
    """All of its parameters. Raises UnreadableModel: it is whatever the installed version has there."""
    try:
        made = getattr(importlib.import_module(listing.module), listing.class_name)(_Unconnected())
        axes, rows = len(made.motors), list(_rows_of(made, f"PyTrinamic {listing.class_name}"))
        table = RegisterTable(listing.name, tuple(_named_once(rows)))
    except Exception as error:  # whatever foreign code may raise, of the version that happens to be installed
        raise _unreadable(listing, f"reading it fails ({type(error).__name__}: {error})") from error
    if axes != listing.axes or not axes:
        raise _unreadable(listing, f"its file tells of {listing.axes} axes, and its class of {axes}")
    for axis in range(axes):
        there = {role_of(row) for row in rows if row.axis == axis}
        if missing := [role for role in NEEDED if role not in there]:
            raise _unreadable(listing, f"its class names nothing that would be the {missing[0]} of axis {axis}")
    return table


def _rows_of(made: Any, source: str) -> Iterator[Register]:
    """Those of each axis, then those of the module. Raises whatever a class that is made otherwise leads to."""
    for axis, motor in enumerate(made.motors):
        yield from _rows(numbers_of(motor.AP), Space.AXIS, axis, source, numbers_of(getattr(motor, "ENUM", None)))
    for name, kind in vars(type(made)).items():
        bank = _BANK.match(name)
        space = _SPACES.get(int(bank[1] or 0)) if bank is not None else None
        if space is not None and inspect.isclass(kind):
            yield from _rows(numbers_of(kind), space, None, source, {})
    for space, ports in ports_of(type(made)).items():
        yield from _rows(ports, space, None, source, {})


def ports_of(kind: type) -> dict[Space, dict[str, int]]:
    """Inputs and outputs that a module's class names, by kind. One whose kind nothing tells is left out."""
    found: dict[Space, dict[str, int]] = {space: {} for space in PORTS}
    for name, space in _PORT_CLASSES.items():
        found[space].update(numbers_of(vars(kind).get(name)))
    for name, number in numbers_of(vars(kind).get(_MIXED_PORTS)).items():
        for space, pattern in _PORT_NAMES.items():
            if pattern.match(name):
                found[space][name] = number
    return found


def numbers_of(constants: object) -> dict[str, int]:
    """The numbers that a class names."""
    named = {} if constants is None else vars(constants)
    return {
        name: number
        for name, number in named.items()
        if isinstance(number, int) and not isinstance(number, bool) and not name.startswith("_")
    }


def _rows(
    numbers: Mapping[str, int], space: Space, axis: int | None, source: str, choices: Mapping[str, int]
) -> Iterator[Register]:
    """A row a name; of several names of one number the first is the row, and others say so."""
    first: dict[int, str] = {}
    for name, number in sorted(numbers.items(), key=lambda item: item[1]):
        if not 0 <= number <= (NUMBER_MAX if space is Space.AXIS else 255):
            raise ValueError(f"{name} has the number {number}, which no command can bear")
        standard = _meaning(name, space)
        clears = space is Space.AXIS and (number == EXTENDED_ERRORS or bool(_CLEARING.search(name)))
        yield Register(
            name,
            BITS,
            f"{standard.help}; reading it may clear it" if clears else standard.help,
            signed=True,
            range=(0, 1) if space is Space.OUTPUT else None,
            values=choices_of(name, choices),
            when=f"another name of {first[number]}" if number in first else "",
            address=number,
            axis=axis,
            access=standard.access,
            reset=None,
            group=f"axis {axis}" if axis is not None else "inputs/outputs" if space in PORTS else "global",
            stored="" if space in PORTS else "unknown",
            source=source,
            volatile=standard.volatile,
            space=space,
            read_clears=clears,
        )
        first.setdefault(number, name)


def _meaning(name: str, space: Space) -> Meaning:
    known = STANDARD.get(name.casefold()) if space is Space.AXIS else PORTS.get(space)
    return known or Meaning(UNKNOWN)


def choices_of(parameter: str, choices: Mapping[str, int]) -> dict[int, str]:
    """Names of values: constants whose name begins with the parameter's."""
    begin = _letters(parameter)
    named: dict[int, str] = {}
    for name, number in choices.items():
        if _letters(name).startswith(begin) and len(_letters(name)) > len(begin):
            named.setdefault(number, name[_length(name, len(begin)) :].lstrip("_"))
    return named


def _letters(name: str) -> str:
    return name.replace("_", "").casefold()


def _length(name: str, letters: int) -> int:
    """How many characters of `name` hold so many that are not underscores."""
    seen = 0
    for index, character in enumerate(name):
        seen += character != "_"
        if seen == letters:
            return index + 1
    return len(name)


def _named_once(rows: list[Register]) -> Iterator[Register]:
    """Rows whose names differ, without regard to case: of two that do not, the later gets its number."""
    taken: set[tuple[str, int | None]] = set()
    for row in rows:
        key = (row.name.casefold(), row.axis)
        if key in taken:
            row = replace(row, name=f"{row.name}_{row.alias}")
        taken.add((row.name.casefold(), row.axis))
        yield row
