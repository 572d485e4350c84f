"""The registers of one chip as rows, from the classes that the package has for it: an older one that names addresses
and fields, or a newer map that also tells access, signs, flags and names of values.

What the package does not tell is unknown, and rows say so (`Register.untold`).
"""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from ...errors import UnreadableModel
from ..model import Access, Field, Register, RegisterTable, Untold
from ..spi_format import Spi, TaggedFormat
from .chips import UART_BITS, table_of, word_bits
from .modules import choices_of, numbers_of
from .package import PACKAGE, Listing, version

NAMES_ALONE = "the package tells its name, address and fields alone"
COUNTER = "IFCNT"
"""Counts what was written over the UART (TMC5160A data sheet 1.14, 5.1.1)."""
_CLEARING = re.compile(
    r"(?:^|_)(?:gstat|ramp_?stat|(?<!drv_)(?<!pwm_)status|status_flags|events?|flags|faults?\d*|int(?:errupts?)?)$",
    re.IGNORECASE,
)
"""Names of registers of which data sheets say for some chips, and the package for none, that reading clears them.
DRV_STATUS and PWM_STATUS tell what is so at the moment (DS-TMC5160 6.5)."""
_MEASURED = re.compile(r"actual|_raw$|latch", re.IGNORECASE)
"""Names of what a chip changes by itself."""
_ACCESS = {"R": Access.R, "W": Access.W, "RW": Access.RW, "RWC": Access.R_W1C, "RC": Access.R, "D": Access.RW}


def unreadable(listing: Listing, why: str) -> UnreadableModel:
    """The error that says why the registers of a listed chip are not known."""
    return UnreadableModel(
        f"{PACKAGE} {version()} lists a {listing.title}, but {why}; another version of it may be understood"
    )


def read(listing: Listing) -> RegisterTable:
    """All of its registers. Raises UnreadableModel: it is whatever the installed version has there."""
    try:
        kind = getattr(importlib.import_module(listing.module), listing.class_name)
        rows = tuple(_distinct(_rows_of(kind, listing)))
        table = table_of(listing.name, rows)
    except Exception as error:  # whatever foreign code may raise, of the version that happens to be installed
        raise unreadable(listing, f"reading it fails ({type(error).__name__}: {error})") from error
    if not rows:
        raise unreadable(listing, "its class names no register")
    return table


def _rows_of(kind: type[Any], listing: Listing) -> Iterator[Register]:
    source = f"PyTrinamic {listing.class_name}"
    if hasattr(kind, "REG"):
        yield from _older(kind, listing.spi, source)
    else:
        yield from _newer(kind, listing, source)


# --- older classes: names, addresses, masks -------------------------------------------------------


def _older(kind: type[Any], spi: Spi | None, source: str) -> Iterator[Register]:
    """Registers of `REG`, those that are there once a motor with an address for each; fields of every `FIELD` class.

    What a register's datagrams cannot say of it (a read, a write, more bits) it does not have.
    """
    tagged = spi if isinstance(spi, TaggedFormat) else None
    bits = word_bits(spi, uart=True)
    masks: dict[int, dict[str, int]] = {}
    for holder, inner in vars(kind).items():
        if holder.startswith("FIELD") and inspect.isclass(inner):
            for name, told in vars(inner).items():
                if not name.startswith("_") and isinstance(told, tuple | list):
                    for address, mask in _masks(told):
                        masks.setdefault(address, {}).setdefault(name, mask)
    named = numbers_of(getattr(kind, "ENUM", None))
    for name, place in vars(kind.REG).items():
        if name.startswith("_") or not isinstance(place, int | tuple):
            continue
        for axis, address in enumerate(place if isinstance(place, tuple) else (place,)):
            width = bits if tagged is None else tagged.width_of(address)
            found = [(part, mask) for part, mask in masks.get(address, {}).items() if _contiguous(mask, width)]
            parts = [_field(part, mask, named) for part, mask in found]
            access = Access.R if name == COUNTER else Access.UNKNOWN
            if tagged is not None:
                access = Access.W if tagged.is_written(address) else Access.R
            row = Register(
                name,
                width,
                NAMES_ALONE,
                address=address,
                axis=axis if isinstance(place, tuple) else None,
                access=access,
                reset=None,
                group=f"axis {axis}" if isinstance(place, tuple) else "registers",
                source=source,
                read_clears=_CLEARING.search(name) is not None or (tagged is not None and access is Access.R),
                volatile=name == COUNTER or _MEASURED.search(name) is not None,
                values=choices_of(name, named),
                untold=frozenset({"width", "access", "reset", "clearing"} if tagged is None else {"reset"}),
                fields=tuple(_apart(parts)),
            )
            yield _collapsed(row if tagged is None else row.completed(row.axis))


def _masks(told: Any) -> Iterator[tuple[int, int]]:
    """(address, mask) of a field, which may be there once a motor."""
    if told and isinstance(told[0], tuple | list):
        for each in told:
            yield from _masks(each)
    elif len(told) == 3:
        yield told[0], told[1]


def _contiguous(mask: int, width: int) -> bool:
    low = mask & -mask
    return mask > 0 and (mask + low) & mask == 0 and mask < 1 << width


def _field(name: str, mask: int, named: Mapping[str, int]) -> Field:
    lsb = (mask & -mask).bit_length() - 1
    width = mask.bit_count()
    values = {value: word for value, word in choices_of(name, named).items() if value < 1 << width}
    return Field(name, width, "", lsb=lsb, access=Access.UNKNOWN, reset=None, values=values)


# --- newer maps: groups of register objects -------------------------------------------------------


def _newer(kind: type[Any], listing: Listing, source: str) -> Iterator[Register]:
    slot = listing.slot
    for title, group in _groups(kind):
        for told in group.registers():
            block = int(group.block or 0) if slot is not None and slot.blocks else 0
            shift = 0 if slot is None else slot.address_bits
            yield _mapped(told, title, int(group.width or UART_BITS), block << shift | told.address, source)


def _groups(kind: type[Any]) -> Iterator[tuple[str, Any]]:
    """Groups of registers with what they are called: by themselves, or where they stand."""
    for name, held in vars(kind).items():
        if callable(getattr(held, "groups", None)):
            for group in held.groups():
                yield str(group.name).lower(), group
        elif callable(getattr(held, "registers", None)):
            yield ("registers" if name == "REGMAP" else name.lower()), held


def _mapped(told: Any, group: str, width: int, address: int, source: str) -> Register:
    fields = told.fields()
    accesses = {part.access.name for part in fields} | {told.access.name}
    parts = [
        Field(
            part.name,
            part.mask.bit_count(),
            "",
            lsb=(part.mask & -part.mask).bit_length() - 1,
            signed=bool(part.signed),
            access=_ACCESS[part.access.name],
            reset=None,
            values=_options(part),
        )
        for part in fields
        if _contiguous(part.mask, width)
    ]
    untold: set[Untold] = {"reset"}
    row = Register(
        told.name,
        width,
        "",
        signed=bool(told.signed),
        address=address,
        access=_ACCESS[told.access.name],
        reset=None,
        group=group,
        source=source,
        read_clears="RC" in accesses,
        volatile=_MEASURED.search(told.name) is not None,
        untold=frozenset(untold),
        fields=tuple(_apart(parts)),
    )
    return _collapsed(row)


def _options(part: Any) -> dict[int, str]:
    """Names of values: of a class with options, or a dictionary of them."""
    choice = getattr(part, "choice", None)
    if choice is None:
        return {}
    if isinstance(choice, Mapping):
        found = {int(option.value): str(name) for name, option in choice.items()}
    else:
        found = {int(option.value): str(option.name) for option in choice.options()}
    return {value: name for value, name in found.items() if 0 <= value < 1 << part.mask.bit_count()}


# --- rows that make a table -----------------------------------------------------------------------


def _apart(parts: Iterable[Field]) -> Iterator[Field]:
    """Fields from the lowest bit on; one whose bits have a name already says so, and names are used once."""
    taken: dict[str, int] = {}
    names: set[str] = set()
    for part in sorted(parts, key=lambda each: each.lsb):
        if part.name.casefold() in names:
            continue
        names.add(part.name.casefold())
        number, when = 0, ""
        while taken.get(when, 0) & part.mask:
            number += 1
            when = f"another name of these bits ({number + 1})"
        taken[when] = taken.get(when, 0) | part.mask
        yield replace(part, when=when)


def _collapsed(row: Register) -> Register:
    """A register whose only field has its name, or all of its bits, is that number: then its width is known."""
    if len(row.fields) != 1:
        return row
    (part,) = row.fields
    same = row.name.casefold() in (part.name.casefold(), part.name.casefold().replace("__", "_"))
    ends = row.name.casefold().endswith(part.name.casefold())
    if part.lsb or not (same or ends):
        return row
    return replace(
        row,
        width=part.width,
        signed=part.signed or row.signed,
        values=part.values or {key: name for key, name in row.values.items() if key < 1 << part.width},
        access=row.access if part.access in (Access.UNKNOWN, Access.R_W1C) else part.access,
        untold=row.untold - {"width"},
        fields=(),
    )


def _distinct(rows: Iterable[Register]) -> Iterator[Register]:
    """Rows whose names differ and whose address has one: of several names of an address the first is the row."""
    rows = list(rows)
    counted: dict[tuple[str, int | None], int] = {}
    for row in rows:
        counted[row.name.casefold(), row.axis] = counted.get((row.name.casefold(), row.axis), 0) + 1
    first: dict[int, str] = {}
    for row in rows:
        name = row.name if counted[row.name.casefold(), row.axis] == 1 else f"{row.group.upper()}_{row.name}"
        when = f"another name of {first[row.address]}" if row.address in first else ""
        first.setdefault(row.address, name)
        yield replace(row, name=name, when=when)
