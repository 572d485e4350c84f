"""From what people call a register, an axis and a value to rows and bits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...errors import OutOfRange, UnknownThing, UsageError, WrongState
from ...registers.model import Access, Bits, Field, Register, RegisterTable

Found = tuple[Register, Field | None]
Changes = Sequence[tuple[Field, int]]
"""Fields with the values they shall have."""


class Lookup:
    """One chip's table, asked by name. What was found once is found again without a search."""

    def __init__(self, table: RegisterTable, axes: int) -> None:
        self._table = table
        self._axes = axes
        self._found: dict[tuple[str, int | None], Found] = {}

    def __call__(self, name: str, axis: int | None) -> Found:
        """A register, or a register and the field that bears the name.

        Raises UnknownThing for an unknown name or axis, UsageError where a register needs an axis.
        """
        known = self._found.get((name, axis))
        if known is not None:
            return known
        if axis is not None and not 0 <= axis < self._axes:
            raise UnknownThing("axis", str(axis), [str(index) for index in range(self._axes)])
        where = 0 if axis is None and self._axes == 1 else axis
        found = self._table.find(name, where)
        if found is None:
            if axis is None and self._table.find(name, 0) is not None:
                raise UsageError(f"{name} belongs to an axis: say which, 0..{self._axes - 1}")
            raise UnknownThing("register", name, self._similar(name))
        if len(self._found) < 4096:  # names come from outside: remember many, but not any number of spellings
            self._found[name, axis] = found
        return found

    def _similar(self, name: str) -> list[str]:
        """Names that share a part with `name` first, then all others."""
        names = dict.fromkeys(
            spelled for register in self._table for spelled in (register.name, *(part.name for part in register.fields))
        )
        wanted = name.casefold()
        return sorted(names, key=lambda known: not (known.casefold() in wanted or wanted in known.casefold()))


def word_of_value(register: Register, value: int) -> int:
    """The bits to send for a whole value. Raises OutOfRange (of fields too), and WrongState where read-only."""
    if not register.access.writable:
        raise WrongState(f"{register.name} is read only")
    if not register.minimum <= value <= register.maximum:
        raise OutOfRange(register.name, value, register.minimum, register.maximum, register.unit)
    word = register.encode(value)
    if not register.fields:
        return word
    unused = word & ~register.mask
    if unused:
        raise OutOfRange(register.name, value, 0, register.mask, f"bits {unused:#x} mean nothing and have to be 0")
    for part in register.fields:
        number = part.unpack(word)
        if part.access.writable and not part.minimum <= number <= part.maximum:
            raise OutOfRange(f"{register.name}.{part.name}", number, part.minimum, part.maximum, part.unit)
    return word


def checked_fields(register: Register, fields: Mapping[str, int | str]) -> Changes:
    """Fields by row, with their values; names of enumerated values are understood.

    Raises UnknownThing, OutOfRange, WrongState where read-only, UsageError where there is none.
    """
    if not register.access.writable:
        raise WrongState(f"{register.name} is read only")
    if not fields:
        raise UsageError(f"no field of {register.name} is given")
    checked: list[tuple[Field, int]] = []
    for name, given in fields.items():
        part = register.field_named(name)
        if part is None:
            raise UnknownThing(f"field of {register.name}", name, [known.name for known in register.fields])
        if any(part is taken for taken, _ in checked):
            raise UsageError(f"{register.name}.{part.name} is given twice")
        if not part.access.writable:
            raise WrongState(f"{register.name}.{part.name} is read only")
        number = number_of(part, given)
        if not part.minimum <= number <= part.maximum:
            raise OutOfRange(f"{register.name}.{part.name}", number, part.minimum, part.maximum, part.unit)
        checked.append((part, number))
    return checked


def number_of(bits: Bits, given: int | str) -> int:
    """A number, or the number behind the name of an enumerated value. Raises OutOfRange for an unknown name."""
    if isinstance(given, bool):
        return int(given)
    if isinstance(given, int):
        return given
    wanted = given.casefold()
    for number, name in bits.values.items():
        if name.casefold() == wanted:
            return number
    names = f"names are {', '.join(bits.values.values())}" if bits.values else "it has no named values"
    raise OutOfRange(bits.name, given, bits.minimum, bits.maximum, names)


def modify(register: Register, word: int, changes: Changes) -> int:
    """`word` with `changes`; flags that a written 1 would clear go out as 0 unless they are among the changes."""
    for part in register.fields:
        if part.access is Access.R_W1C:
            word &= ~part.mask
    for part, number in changes:
        word = part.pack(number, over=word)
    return word & register.write_mask
