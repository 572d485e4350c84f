"""What a register row is. One frozen row serves driver, emulator, API and register page.

A row refuses at import what it can get wrong alone (fields that overlap or leave the register, a
reset that does not fit, an enumeration beyond its width). What only the whole table can get wrong
(two rows on one address, two rows of one name) is refused by `RegisterTable`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import reduce
from operator import or_
from types import MappingProxyType
from typing import Literal, TypedDict, Unpack

Stored = Literal["", "auto", "on request", "unknown"]
Untold = Literal["width", "access", "reset", "clearing"]
"""What a source may leave open of a register: how many bits it has, whether it can be read or written, what it holds
after power-on, and whether a reading clears it."""
GLOBAL_AXIS = None
"""The `axis` of a register that belongs to the whole chip."""


class Space(StrEnum):
    """Where an address counts: a chip has one space, a TMCL module one for each kind of thing."""

    REGISTER = "register"
    AXIS = "ap"
    """Axis parameters (SAP, GAP)."""
    GLOBAL_0 = "gp0"
    """Global parameters of bank 0: interface and application (SGP, GGP)."""
    GLOBAL_2 = "gp2"
    """Bank 2: user variables."""
    GLOBAL_3 = "gp3"
    """Bank 3: interrupts."""
    DIGITAL_IN = "in"
    """Bank 0 of GIO."""
    PULL_UP = "pullup"
    """Bank 0 of SIO, which can only be written."""
    ANALOG_IN = "ain"
    """Bank 1 of GIO."""
    OUTPUT = "out"
    """Bank 2 of SIO and GIO."""
    COORDINATE = "coord"
    """SCO, GCO."""

    def alias(self, address: int) -> str:
        """The short name that needs no table: `ap4`, `gp0_66`, `coord3`; empty for a chip's registers."""
        if self is Space.REGISTER:
            return ""
        return f"{self.value}_{address}" if self.value[-1].isdigit() else f"{self.value}{address}"


class Access(StrEnum):
    """How a register or field answers the wire."""

    R = "R"
    """Read only: a write is ignored."""
    W = "W"
    """Write only: a read answers zero."""
    RW = "RW"
    """Read and write."""
    RW_IF = "RW*"
    """Read; a write works or acts only under the condition that `write_note` tells."""
    R_W1C = "R+WC"
    """Read; writing 1 clears, writing 0 leaves."""
    UNKNOWN = "?"
    """No source tells. Both are tried: what a read brings may mean nothing, and a write may leave no trace."""

    @property
    def readable(self) -> bool:
        return self is not Access.W

    @property
    def writable(self) -> bool:
        return self is not Access.R


def to_signed(raw: int, width: int) -> int:
    """Two's complement of `width` bits to int."""
    return raw - (1 << width) if raw >> (width - 1) & 1 else raw


def to_raw(value: int, width: int) -> int:
    """An int, signed or not, to its `width` raw bits."""
    return value & ((1 << width) - 1)


@dataclass(frozen=True, slots=True)
class Bits:
    """What registers and fields share: a number of some width, with a unit, a range and a meaning."""

    name: str
    width: int
    help: str
    signed: bool = False
    unit: str = ""
    range: tuple[int, int] | None = None
    """Allowed values (lowest, highest), inclusive; None stands for all that the width holds."""
    values: Mapping[int, str] = field(default_factory=dict)
    """Names of enumerated values."""
    when: str = ""
    """Non-empty: a second meaning of bits that another row or field already names, and when it holds."""
    behaviour: str = ""
    """Non-empty: readable and writable here, but not acted on by the emulator, and why."""
    role: str = ""
    """Non-empty: what it is to a ramp generator, where a table says so that is known by no other means."""

    def __post_init__(self) -> None:
        lowest, highest = self._width_range()
        if self.range is not None and not lowest <= self.range[0] <= self.range[1] <= highest:
            raise ValueError(f"{self.name}: range {self.range} does not fit {self.width} bits")
        for value in self.values:
            if not lowest <= value <= highest:
                raise ValueError(f"{self.name}: enumerated value {value} does not fit {self.width} bits")
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))

    def _width_range(self) -> tuple[int, int]:
        if self.signed:
            return -(1 << (self.width - 1)), (1 << (self.width - 1)) - 1
        return 0, (1 << self.width) - 1

    @property
    def minimum(self) -> int:
        """The lowest allowed value."""
        return self.range[0] if self.range else self._width_range()[0]

    @property
    def maximum(self) -> int:
        """The highest allowed value."""
        return self.range[1] if self.range else self._width_range()[1]

    def decode(self, raw: int) -> int:
        """Raw bits (only the lowest `width` count) to the value."""
        raw = to_raw(raw, self.width)
        return to_signed(raw, self.width) if self.signed else raw

    def encode(self, value: int) -> int:
        """A value to raw bits. Raises ValueError outside `minimum`..`maximum`."""
        if not self.minimum <= value <= self.maximum:
            raise ValueError(f"{self.name} is {self.minimum}..{self.maximum}, not {value}")
        return to_raw(value, self.width)


@dataclass(frozen=True, slots=True)
class Field(Bits):
    """Some bits of a register that have a name of their own.

    Fields do not overlap, but for those that say `when`: a TMC4361 gives some bits another meaning
    with another driver chip or encoder, and a reader has to see both names.
    """

    lsb: int = 0
    access: Access = Access.RW
    reset: int | None = 0
    """Value after power-on; None where no source tells."""

    @property
    def mask(self) -> int:
        """The field's bits inside its register."""
        return ((1 << self.width) - 1) << self.lsb

    def unpack(self, word: int) -> int:
        """The field's value out of a register word."""
        return self.decode(word >> self.lsb)

    def pack(self, value: int, over: int = 0) -> int:
        """`over` with this field replaced by `value`. Raises ValueError out of range."""
        return (over & ~self.mask) | self.encode(value) << self.lsb


class Particulars(TypedDict, total=False):
    """What a row may tell beyond address, name, width, access and meaning: see `Register`."""

    signed: bool
    unit: str
    range: tuple[int, int] | None
    values: Mapping[int, str]
    when: str
    behaviour: str
    axis: int | None
    reset: int | None
    source: str
    write_note: str
    volatile: bool
    read_clears: bool
    space: Space
    stored: Stored
    internal_range: tuple[int, int]


@dataclass(frozen=True, slots=True)
class DriverPlace:
    """What a module's parameter is in the driver chip under it: `raw` there is `raw * step + offset` here.

    A parameter in pps or pps^2 is converted by the clock instead, and counts like the chip while unit mode is 0.
    """

    name: str
    """Of the register."""
    field: str = ""
    """Empty where the whole register is one value."""
    step: int = 1
    offset: int = 0


@dataclass(frozen=True, slots=True)
class Register(Bits):
    """One addressable word of a chip.

    `address` is the chip's own (TMC428: 7 bits with RRS as bit 6), counted in `space`; `axis` the
    motor it belongs to or None. `source` names document and section, `write_note` says when a conditional write works
    and what it does.
    """

    address: int = 0
    axis: int | None = GLOBAL_AXIS
    access: Access = Access.RW
    reset: int | None = 0
    group: str = "motion"
    source: str = ""
    write_note: str = ""
    volatile: bool = False
    """The chip changes it by itself, so a read-back may differ from what was written."""
    space: Space = Space.REGISTER
    stored: Stored = ""
    """Whether EEPROM keeps it: "auto" as it is written, "on request" by a command of its own; empty: it does not."""
    read_clears: bool = False
    """Reading it changes it, so only a caller that asks for it by name may."""
    untold: frozenset[Untold] = frozenset()
    """What no source tells of it: where the width is not told, it is that of the datagram."""
    internal_range: tuple[int, int] | None = None
    """Of a TMCL parameter in pps or pps^2: what is allowed while unit mode is 0 (the driver chip's own units)."""
    driver: DriverPlace | None = None
    """Of a TMCL parameter: the register of the module's driver chip that it sets."""
    fields: tuple[Field, ...] = ()

    def __post_init__(self) -> None:
        super(Register, self).__post_init__()
        if not self.source:
            raise ValueError(f"{self.name}: a row without a source")
        taken: dict[str, int] = {}
        for part in self.fields:
            if part.lsb + part.width > self.width:
                raise ValueError(f"{self.name}.{part.name} leaves the register's {self.width} bits")
            if taken.get(part.when, 0) & part.mask:
                raise ValueError(f"{self.name}.{part.name} overlaps another field")
            taken[part.when] = taken.get(part.when, 0) | part.mask
        if self.reset is not None and not 0 <= self.reset < 1 << self.width:
            raise ValueError(f"{self.name}: reset {self.reset:#x} does not fit {self.width} bits")

    @property
    def alias(self) -> str:
        """The short name by space and number, e.g. `ap4`; empty for a chip's registers."""
        return self.space.alias(self.address)

    @property
    def mask(self) -> int:
        """Every bit that means something: of a packed register, those of its fields."""
        if not self.fields:
            return (1 << self.width) - 1
        return reduce(or_, (part.mask for part in self.fields))

    @property
    def write_mask(self) -> int:
        """Every bit that a write may change (or, with write-1-to-clear, act on)."""
        if not self.access.writable:
            return 0
        if not self.fields:
            return self.mask
        return reduce(or_, (part.mask for part in self.fields if part.access.writable), 0)

    def having(self, *fields: Field, **particulars: Unpack[Particulars]) -> Register:
        """The row with these fields, and with what else is particular to it."""
        return replace(self, fields=fields, **particulars)

    def completed(self, axis: int | None) -> Register:
        """The row on `axis`, its fields with the word's access and their part of its reset.

        A word is read and written whole, so a field differs from it in nothing but that a write may leave it alone:
        one that says `Access.R` stays so. A word that cannot be read says that in its note.
        """
        parts = tuple(
            replace(
                part,
                access=Access.R if part.access is Access.R else self.access,
                reset=None if self.reset is None else part.unpack(self.reset),
            )
            for part in self.fields
        )
        note = self.write_note or ("cannot be read back" if self.access is Access.W else "")
        return replace(self, axis=axis, write_note=note, fields=parts)

    def field_named(self, name: str) -> Field | None:
        """The field of that name, without regard to case, or None."""
        wanted = name.casefold()
        return next((part for part in self.fields if part.name.casefold() == wanted), None)

    def unpack(self, raw: int) -> dict[str, int]:
        """Every field's value, by name, in the row's order."""
        return {part.name: part.unpack(raw) for part in self.fields}


class RegisterTable:
    """All registers of one chip; names are matched without regard to case.

    One address may hold one register for reading and another for writing. Rows that say `when` are
    further names of a word that has its row already: they answer to their names, not at their address.
    """

    def __init__(self, chip: str, registers: tuple[Register, ...]) -> None:
        self.chip = chip
        self.registers = registers
        self._by_name: dict[tuple[str, int | None], Register] = {}
        self._by_address: dict[tuple[Space, int, bool, int | None], Register] = {}
        self._by_field: dict[tuple[str, int | None], tuple[Register, Field]] = {}
        for register in registers:
            key = (register.name.casefold(), register.axis)
            if key in self._by_name:
                raise ValueError(f"{chip}: two rows are called {register.name} on axis {register.axis}")
            self._by_name[key] = register
        for register in registers:
            if register.alias:  # where another row is called that, its name counts
                self._by_name.setdefault((register.alias, register.axis), register)
        self._place(registers)
        ambiguous: set[tuple[str, int | None]] = set()
        for register in registers:
            for part in register.fields:
                key = (part.name.casefold(), register.axis)
                if key in self._by_field or key in self._by_name:
                    ambiguous.add(key)
                self._by_field[key] = (register, part)
        for key in ambiguous:  # y_even of 32 table words: only the packed name tells which
            del self._by_field[key]

    def _place(self, registers: tuple[Register, ...]) -> None:
        """Give every address its register for reading and its register for writing."""
        for register in registers:
            for write in (False, True):
                place = (register.space, register.address, write, self._of_axis(register.space, register.axis))
                serves = register.access.writable if write else register.access.readable
                if register.when or not serves:
                    continue
                if place in self._by_address:
                    raise ValueError(f"{self.chip}: two rows stand on address {register.address:#04x}")
                self._by_address[place] = register
        for (space, address, write, axis), register in list(self._by_address.items()):
            self._by_address.setdefault((space, address, not write, axis), register)
        for register in registers:
            if self.at(register.address, register.space, axis=register.axis) is None:
                raise ValueError(f"{self.chip}: {register.name} is another name of a word that has no row")

    def __iter__(self) -> Iterator[Register]:
        return iter(self.registers)

    def __len__(self) -> int:
        return len(self.registers)

    @staticmethod
    def _of_axis(space: Space, axis: int | None) -> int | None:
        """What tells rows of one number apart: of axis parameters the axis, of all others nothing."""
        return axis or 0 if space is Space.AXIS else None

    def at(
        self, address: int, space: Space = Space.REGISTER, write: bool = False, axis: int | None = None
    ) -> Register | None:
        """The register that a read (or a write) of that address reaches, or None where the chip has none.

        An address with a register for one of the two only answers both with it. `axis` is that of an axis parameter,
        by default the first.
        """
        return self._by_address.get((space, address, write, self._of_axis(space, axis)))

    def meanings(self, address: int, space: Space = Space.REGISTER) -> tuple[Register, ...]:
        """Every row at that address: for reading, for writing, and those that hold only `when` they say."""
        return tuple(row for row in self.registers if (row.space, row.address) == (space, address))

    def find(self, name: str, axis: int | None = None) -> tuple[Register, Field | None] | None:
        """A register, or a field by its own name, on `axis`; global ones answer on every axis.

        Returns (register, None), (register, field), or None where nothing has that name.
        """
        for where in (axis, GLOBAL_AXIS):
            key = (name.casefold(), where)
            if key in self._by_name:
                return self._by_name[key], None
            if key in self._by_field:
                return self._by_field[key]
        return None

    def get(self, name: str, axis: int | None = None) -> Register:
        """The register of that exact kind. Raises KeyError: for code, whose names are constants."""
        found = self._by_name.get((name.casefold(), axis)) or self._by_name.get((name.casefold(), GLOBAL_AXIS))
        if found is None:
            raise KeyError(f"{self.chip} has no register {name} on axis {axis}")
        return found
