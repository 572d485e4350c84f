"""A register map read out of its file: the table of a chip, or every mistake in the file with its line."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from ..listed.chips import ADDRESS_MAX, table_of, word_bits
from ..listed.ramp import NAMES, ramps_of
from ..model import Access, Field, Register, RegisterTable, Untold
from ..spi_format import WORD_BITS_MAX, SpiFormat
from .findings import Finding, UnreadableMap
from .lines import Lines, Place, TooDeep
from .shapes import AXES_MAX, REGISTERS_MAX, BitsShape, FieldShape, HeadShape, Limits, RegisterShape, SpiShape

BYTES_MAX = 256 * 1024
NAME = re.compile(r"[a-z0-9][a-z0-9-]{0,39}")
"""Of a map: that of its file, and of the model."""
_AT = re.compile(r" \(at line (\d+), column (\d+)\)$|\(at end of document\)$")
WIDTH = 32
"""Of a register that does not say any."""
_MODE = "the mode has 2 bits, can be read and written, as can the target; position and speed can be read"
_LONG = re.compile(r"[0-9_]{1000}")

S = TypeVar("S", bound=BaseModel)
LineOf = Callable[[Place], int]


@dataclass(frozen=True, slots=True)
class RegisterMap:
    """A map without mistakes."""

    name: str
    head: HeadShape
    table: RegisterTable


def read(name: str, content: bytes) -> RegisterMap:
    """The map in a TOML file. Raises UnreadableMap with all that is wrong; UsageError for a name that cannot be."""
    text = text_of(name, content)
    try:
        lines = Lines(text)
        data = tomllib.loads(text)
    except TooDeep as error:
        raise UnreadableMap(name, [Finding(error.line, "", f"{error}; a register map needs 3")]) from error
    except (ValueError, RecursionError) as error:
        raise UnreadableMap(name, [_no_toml(str(error), text)]) from error
    return checked(name, data, lines.of)


def text_of(name: str, content: bytes) -> str:
    """The text of a file. Raises UnreadableMap."""
    if len(content) > BYTES_MAX:
        raise UnreadableMap(name, [Finding(1, "", f"{len(content)} bytes, at most {BYTES_MAX} are read")])
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise UnreadableMap(name, [Finding(line, "", "no text in UTF-8")]) from error


def checked(name: str, data: Mapping[str, Any], line_of: LineOf) -> RegisterMap:
    """What a file says as a map; `line_of` tells the line of each of its values. Raises UnreadableMap."""
    check = _Check(line_of)
    head = check.shape(HeadShape, data, ())
    check.limits = check.format(data)
    entries = data.get("register")
    rows: list[tuple[int, Register]] = []
    for index, entry in enumerate(entries[:REGISTERS_MAX] if isinstance(entries, list) else ()):
        place: Place = ("register", index)
        shape = check.shape(RegisterShape, entry, place)
        row = None if shape is None else check.row(shape, AXES_MAX if head is None else head.axes, place)
        if row is not None:
            rows.append((index, row))
    check.table(rows)
    check.roles(rows)
    if not check.findings and head is not None:
        check.ramps([row for _, row in rows], head.axes)
    if check.findings:
        raise UnreadableMap(name, check.findings)
    assert head is not None  # else something was found
    return RegisterMap(name, head, table_of(name, (row for _, row in rows)))


def _no_toml(message: str, text: str) -> Finding:
    """What the TOML parser says, and where."""
    found, long = _AT.search(message), _LONG.search(text)
    if found is None and long is not None:  # Python makes no number of so many digits, and does not say where
        return Finding(text.count("\n", 0, long.start()) + 1, "", "a number of so many digits is none of a chip")
    line = int(found[1]) if found is not None and found[1] else text.rstrip().count("\n") + 1
    return Finding(line, "", f"no TOML: {_AT.sub('', message).strip()}"[:200])


class _Check:
    """Collects what is wrong."""

    def __init__(self, line_of: LineOf) -> None:
        self._line_of = line_of
        self.findings: list[Finding] = []
        self.limits = Limits(ADDRESS_MAX, WORD_BITS_MAX)

    def say(self, place: Place, where: str, what: str) -> None:
        self.findings.append(Finding(self._line_of(place), where, what))

    # --- shapes ---------------------------------------------------------------------------------

    def shape(self, shape: type[S], data: object, place: Place) -> S | None:
        """`data` as a `shape`; None where it is none."""
        try:
            return shape.model_validate(data, context=self.limits)
        except ValidationError as error:
            for finding in error.errors(include_url=False, include_context=True):
                at = tuple(part for part in finding["loc"] if part != "[key]")
                self.say((*place, *at), _where(place, at, data), _what(finding, shape, at))
            return None

    def format(self, data: Mapping[str, Any]) -> Limits:
        """What the datagrams of this file hold, as far as its head is right."""
        spi = self._spi(data.get("spi"))
        form, uart = format_of(spi), "uart" in data
        told = None if spi is None else spi.datagram_bits
        if form is not None and told is not None and told != 8 * form.frame_bytes:
            what = f"is {told}, and the other keys make {8 * form.frame_bytes}"
            self.say(("spi", "datagram_bits"), "spi, datagram_bits", what)
        most = ADDRESS_MAX if form is None else form.address_max
        return Limits(min(most, ADDRESS_MAX) if uart else most, word_bits(form, uart=uart))

    @staticmethod
    def _spi(data: object) -> SpiShape | None:
        """What is wrong with it is told with the head."""
        try:
            return SpiShape.model_validate(data)
        except ValidationError:
            return None

    # --- rows -----------------------------------------------------------------------------------

    def row(self, shape: RegisterShape, axes: int, place: Place) -> Register | None:
        """The row of a register; None where something in it cannot be."""
        before, where = len(self.findings), f"register {shape.name}"
        width = min(WIDTH, self.limits.word_bits) if shape.width is None else shape.width
        if shape.axis is not None and shape.axis >= axes:
            allowed = f"0..{axes - 1}" if axes else "none: say `axes` at the head of the file"
            self.say((*place, "axis"), where, f"axis is {shape.axis}, allowed is {allowed}")
        if shape.reset is not None and not 0 <= shape.reset < 1 << width:
            what = f"reset is {shape.reset}, allowed is 0..{(1 << width) - 1}: its bits as a number"
            self.say((*place, "reset"), where, what)
        values = self._bits(shape, width, place, where)
        fields: list[Field] = []
        names: dict[str, int] = {}
        taken = 0
        for index, part in enumerate(shape.field):
            inside: Place = (*place, "field", index)
            called = f"{where}, field {part.name}"
            named = self._bits(part, part.width, inside, called)
            mask = ((1 << part.width) - 1) << part.lsb
            if part.lsb + part.width > width:
                last = part.lsb + part.width - 1
                self.say((*inside, "lsb"), called, f"has bits {part.lsb}..{last}, its register 0..{width - 1}")
            elif taken & mask:
                self.say((*inside, "lsb"), called, "has bits that another field has")
            taken |= mask
            if (first := names.setdefault(part.name.casefold(), index)) != index:
                line = self._line_of((*place, "field", first, "name"))
                self.say((*inside, "name"), called, f"the field on line {line} is called so")
            if len(self.findings) == before:
                fields.append(_field(part, named))
        if len(self.findings) > before:
            return None
        return Register(
            shape.name,
            width,
            shape.help,
            signed=shape.signed,
            unit=shape.unit,
            range=_range(shape),
            values=values,
            address=shape.address,
            access=Access(shape.access),
            reset=shape.reset,
            group=shape.group or ("chip" if shape.axis is None else f"axis {shape.axis}"),
            source="your register map",
            role=shape.role or "",
            volatile=shape.volatile,
            read_clears=shape.read_clears,
            untold=frozenset[Untold]({"reset"}) if shape.reset is None else frozenset[Untold](),
            fields=tuple(fields),
        ).completed(shape.axis)

    def _bits(self, shape: BitsShape, width: int, place: Place, where: str) -> dict[int, str]:
        """Its range and names of values, which have to fit its width."""
        low, high = (-(1 << width - 1), (1 << width - 1) - 1) if shape.signed else (0, (1 << width) - 1)
        if shape.range is not None and not low <= shape.range[0] <= shape.range[1] <= high:
            told = f"range is {shape.range[0]}..{shape.range[1]}"
            what = f"{told}, allowed is {low}..{high} or less of it, the lowest first"
            self.say((*place, "range"), where, what)
        values: dict[int, str] = {}
        for key, name in shape.values.items():
            try:
                value = int(key, 0)
            except ValueError:
                self.say((*place, "values", key), where, f"values are named by whole numbers, not by {key!r}")
                continue
            if not low <= value <= high:
                self.say((*place, "values", key), where, f"value {value} does not fit, allowed is {low}..{high}")
            elif value in values:
                self.say((*place, "values", key), where, f"value {value} is named twice")
            values[value] = name
        return values

    def ramps(self, rows: list[Register], axes: int) -> None:
        """Whether there are as many ramp generators as axes: without one nobody could tell where an axis is."""
        found = len(ramps_of(rows))
        if found != axes:
            names = ", ".join(name.upper() for name in NAMES)
            what = f"is {axes}, and the registers make {found} ramp generators: each axis has one, of {names}"
            self.say(("axes",), "axes", f"{what}, or of registers that tell their `role`; {_MODE}")

    def roles(self, rows: list[tuple[int, Register]]) -> None:
        """Whether each role of an axis is told once."""
        first: dict[tuple[int, str], tuple[Place, str]] = {}
        for index, row in rows:
            place: Place = ("register", index)
            told = [((*place, "role"), row.name, row.role)]
            told += [((*place, "field", at, "role"), part.name, part.role) for at, part in enumerate(row.fields)]
            for at, name, role in told:
                if role and (earlier := first.setdefault((row.axis or 0, role), (at, name))) != (at, name):
                    line = self._line_of(earlier[0])
                    self.say(
                        at, name, f"the role {role} of axis {row.axis or 0} is that of {earlier[1]} on line {line}"
                    )

    # --- the table ------------------------------------------------------------------------------

    def table(self, rows: list[tuple[int, Register]]) -> None:
        """What two rows cannot both have: a name on one axis, an address to read at or to write to."""
        names: dict[tuple[str, int | None], int] = {}
        addresses: dict[tuple[int, bool], int] = {}
        for index, row in rows:
            first = names.setdefault((row.name.casefold(), row.axis), index)
            if first != index:
                line = self._line_of(("register", first, "name"))
                self.say(("register", index, "name"), f"register {row.name}", f"the one on line {line} is called so")
            ways = [write for write in (False, True) if (row.access.writable if write else row.access.readable)]
            clashes = [addresses.setdefault((row.address, write), index) for write in ways]
            other = next((clash for clash in clashes if clash != index), None)
            if other is not None:
                line = self._line_of(("register", other, "address"))
                what = f"address {row.address:#04x} is that of the one on line {line}"
                self.say(("register", index, "address"), f"register {row.name}", what)


def format_of(spi: SpiShape | None) -> SpiFormat | None:
    """Its datagrams on SPI."""
    if spi is None:
        return None
    return SpiFormat(spi.data_bits, spi.address_bits, spi.write_bit, spi.write_is, spi.byte_order, spi.answer)


def _field(shape: FieldShape, values: dict[int, str]) -> Field:
    return Field(
        shape.name,
        shape.width,
        shape.help,
        signed=shape.signed,
        unit=shape.unit,
        range=_range(shape),
        values=values,
        lsb=shape.lsb,
        role=shape.role or "",
        access=Access(shape.access),
        reset=None,
    )


def _range(shape: BitsShape) -> tuple[int, int] | None:
    return None if shape.range is None else (shape.range[0], shape.range[1])


# --- what pydantic finds, in the file's words -----------------------------------------------------

_KINDS = {
    "int_type": "has to be a whole number",
    "string_type": "has to be text in quotes",
    "bool_type": "has to be true or false",
    "list_type": "has to be a list in square brackets",
    "dict_type": "has to be a table",
    "model_type": "has to be a table",
    "missing": "is missing",
}
_PATTERNS = {
    "name": "begins with a letter, then letters, digits and _, 40 at most",
}


def _where(place: Place, at: Place, data: object) -> str:
    """`register XTARGET, field pol, lsb` for people."""
    said: list[str] = []
    if place and isinstance(data, Mapping):
        name = data.get("name")
        said.append(f"register {name[:40]}" if isinstance(name, str) else f"register {int(place[-1]) + 1} of the file")
    inner: object = data
    for part in at:
        if isinstance(part, int):
            inner = inner[part] if isinstance(inner, list) and part < len(inner) else None
            name = inner.get("name") if isinstance(inner, Mapping) else None
            said[-1:] = [f"{said[-1] if said else 'entry'} {name[:40] if isinstance(name, str) else part + 1}"]
        else:
            inner = inner.get(part) if isinstance(inner, Mapping) else None
            said.append(str(part)[:40])
    return ", ".join(said)


def _what(finding: Mapping[str, Any], shape: type[BaseModel], at: Place) -> str:
    kind, limits = finding["type"], finding.get("ctx", {})
    given = finding.get("input")
    shown = f" is {_short(given)}," if isinstance(given, int | float | str) else ""
    if kind == "extra_forbidden":
        return f"no such key; there {_are(_keys(shape, at))}"
    if kind == "literal_error":
        return f"{shown[1:]} allowed is {limits['expected']}".strip()
    if kind in ("greater_than_equal", "less_than_equal", "less_than", "greater_than"):
        return f"{shown[1:]} allowed is {_bound(limits)}".strip()
    if kind == "string_pattern_mismatch":
        return f"{shown[1:]} it {_PATTERNS.get(str(at[-1]), 'is one line of text')}".strip()
    if kind in ("too_long", "too_short"):
        most = limits.get("max_length", limits.get("min_length"))
        return f"has {limits['actual_length']}, allowed is {'at most' if kind == 'too_long' else 'at least'} {most}"
    if kind in ("string_too_long", "string_too_short"):
        most = limits.get("max_length", limits.get("min_length"))
        return f"allowed {'are at most' if kind == 'string_too_long' else 'is at least'} {most} characters"
    return _KINDS.get(kind, str(finding["msg"]))


def _bound(limits: Mapping[str, Any]) -> str:
    for name, words in (("ge", "{} or more"), ("le", "{} or less"), ("lt", "less than {}"), ("gt", "more than {}")):
        if name in limits:
            return words.format(limits[name])
    return "something else"


def _keys(shape: type[BaseModel], at: Place) -> list[str]:
    """The keys that the table has in which the last of `at` stands."""
    inner: type[BaseModel] = shape
    for part in at[:-1]:
        if isinstance(part, str):
            inner = next((each for each in _models(inner.model_fields[part].annotation)), inner)
    return [field.alias or name for name, field in inner.model_fields.items()]


def _models(annotation: object) -> Iterator[type[BaseModel]]:
    """The tables that an annotation speaks of."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in getattr(annotation, "__args__", ()):
        yield from _models(argument)


def _are(keys: list[str]) -> str:
    return f"are {', '.join(keys)}"


def _short(given: object) -> str:
    text = repr(given) if isinstance(given, str) else str(given)
    return text if len(text) <= 60 else f"{text[:57]}..."
