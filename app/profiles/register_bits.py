"""Between the document and the chip: what a document says as bits of registers, and registers as a document."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from ..calc.microsteps.datagrams import table_ram_words, values_from_ram_words
from ..devices.core.lookup import number_of
from ..errors import OutOfRange
from ..registers.catalog import MODELS
from ..registers.model import Field, Register, Space, to_raw
from .document import MslutPart, ParameterPart, ProfileDocument, RegisterPart, Tables, UnknownPart
from .errors import UnreadableProfile
from .items import Item, Key, TableName, items_by_key, items_of, key_of, place_of

RAM_MASK = 0x3F3F
"""Two cells of six bits; the other bits of a RAM word mean nothing."""
MSLUT_WORDS = 10
"""MSLUT[0..7], MSLUTSEL, MSLUTSTART."""


@dataclass(frozen=True, slots=True)
class RegisterBits:
    """What a document says of one register."""

    item: Item
    word: int
    """The bits, 0 outside of `mask`."""
    mask: int
    """Bits that the document speaks of: some fields, or all of the item."""
    place: str
    """Where in the document: `registers[3]`."""


# --- from the document ------------------------------------------------------------------------------


def bits_of(document: ProfileDocument) -> dict[Key, RegisterBits]:
    """All that a document says, in the order in which it is safe to write.

    Raises UnreadableProfile, naming the place, for what the model does not have, what does not fit, and what is said
    twice. Whether a number is allowed only `check_range` tells: a chip may hold what nobody may write.
    """
    found: dict[Key, RegisterBits] = {}
    for want in _all_bits(document):
        before = found.get(want.item.key)
        if before is not None:
            raise UnreadableProfile(want.place, f"{want.item.place} is told twice, first in {before.place}")
        found[want.item.key] = want
    order = {item.key: index for index, item in enumerate(items_of(document.model))}
    return dict(sorted(found.items(), key=lambda entry: order[entry[0]]))


def check_range(want: RegisterBits) -> None:
    """Raises UnreadableProfile where one of the numbers may not be written."""
    row = want.item.row
    if not want.item.fields:
        _require(want.place, row, row.decode(want.word))
    for part in want.item.fields:
        if part.mask & want.mask == part.mask:
            _require(f"{want.place}.fields.{part.name}", part, part.unpack(want.word))


def _require(place: str, bits: Register | Field, number: int) -> None:
    # Of a parameter whose unit depends on the mode that the profile itself sets, the device tells the range.
    internal = bits.internal_range if isinstance(bits, Register) else None
    low, high = bits.minimum, bits.maximum
    if internal is not None:
        low, high = min(low, internal[0]), max(high, internal[1])
    if not low <= number <= high:
        unit = f" {bits.unit}" if bits.unit else ""
        raise UnreadableProfile(place, f"{bits.name} is {number}, allowed is {low}..{high}{unit}")


def _all_bits(document: ProfileDocument) -> Iterator[RegisterBits]:
    kind = MODELS[document.model].kind
    if kind == "module" and document.registers:
        raise UnreadableProfile("registers[0]", f"a {document.title} has parameters, no registers")
    if kind == "chip" and document.parameters:
        raise UnreadableProfile("parameters[0]", f"a {document.title} has registers, no parameters")
    if len(document.axes) > MODELS[document.model].axes:
        raise UnreadableProfile("axes", f"a {document.title} has {MODELS[document.model].axes} of them")
    for index, entry in enumerate(document.registers):
        yield _register(document, entry, f"registers[{index}]")
    for index, parameter in enumerate(document.parameters):
        yield _parameter(document, parameter, f"parameters[{index}]")
    yield from _table_wants(document)


def _item(document: ProfileDocument, name: str, axis: int | None, place: str) -> Item:
    axes = MODELS[document.model].axes
    if axis is not None and axis >= axes:
        raise UnreadableProfile(f"{place}.axis", f"a {document.title} has axes 0..{axes - 1}, no axis {axis}")
    table = MODELS[document.model].table
    found = table.find(name, 0 if axis is None and axes == 1 else axis)
    if found is None and axis is None and table.find(name, 0) is not None:
        raise UnreadableProfile(f"{place}.axis", f"{name} belongs to an axis: say which, 0..{axes - 1}")
    if found is None or (axis is not None and found[0].axis is None):
        raise UnreadableProfile(f"{place}.name", f"a {document.title} has no {place_of(name, axis)}")
    if found[1] is not None:
        raise UnreadableProfile(f"{place}.name", f"{name} is a field of {found[0].name}: tell it among its fields")
    item = items_by_key(document.model).get(key_of(found[0]))
    if item is None or item.row is not found[0]:
        also = f"; its address is told as {item.row.name}" if item is not None else ""
        raise UnreadableProfile(f"{place}.name", f"{found[0].name} is not configuration, no profile holds it{also}")
    if item.table is not None:
        raise UnreadableProfile(
            f"{place}.name", f"{found[0].name} is part of a table: it belongs into tables.{item.table}"
        )
    return item


def _register(document: ProfileDocument, entry: RegisterPart, place: str) -> RegisterBits:
    item = _item(document, entry.name, entry.axis, place)
    if entry.value is None and entry.fields is None:
        raise UnreadableProfile(place, f"{item.place} has neither value nor fields")
    word, mask = 0, item.mask
    if entry.value is not None:
        word = _word_of(item, entry.value, f"{place}.value")
    if entry.fields is not None:
        told, told_mask = _word_of_fields(item, entry.fields, f"{place}.fields")
        if entry.value is not None and told != word & told_mask:
            changed = ", ".join(
                f"{part.name} {part.unpack(word)} or {part.unpack(told)}"
                for part in item.row.fields
                if part.mask & told_mask == part.mask and (told ^ word) & part.mask
            )
            raise UnreadableProfile(place, f"value and fields say different things ({changed}): leave one of them out")
        if entry.value is None:
            word, mask = told, told_mask
    return RegisterBits(item, word, mask, place)


def _word_of(item: Item, value: int, place: str) -> int:
    row = item.row
    low, high = (-(1 << row.width - 1), 1 << row.width - 1) if row.signed else (0, 1 << row.width)
    if not low <= value < high:
        raise UnreadableProfile(place, f"{row.name} is {value}, and has {row.width} bits: {low}..{high - 1}")
    word = to_raw(value, row.width)
    if word & ~item.mask:
        raise UnreadableProfile(place, f"bits {word & ~item.mask:#x} of {row.name} are not configuration: make them 0")
    return word


def _word_of_fields(item: Item, fields: Mapping[str, int | str], place: str) -> tuple[int, int]:
    """The bits that some fields say, and which bits these are."""
    word = mask = 0
    for name, given in fields.items():
        part = item.row.field_named(name)
        if part is None:
            known = ", ".join(part.name for part in item.fields) or "none"
            raise UnreadableProfile(f"{place}.{name}", f"{item.row.name} has no such field; it has {known}")
        if part.mask & ~item.mask:
            raise UnreadableProfile(f"{place}.{name}", f"{part.name} is not configuration, no profile holds it")
        if part.mask & mask:
            raise UnreadableProfile(f"{place}.{name}", f"bits of {part.name} have another name before it")
        try:
            number = number_of(part, given)
        except OutOfRange as error:
            raise UnreadableProfile(f"{place}.{name}", str(error)) from error
        if part.decode(to_raw(number, part.width)) != number:
            raise UnreadableProfile(f"{place}.{name}", f"{part.name} is {number}, and has {part.width} bits")
        word |= to_raw(number, part.width) << part.lsb
        mask |= part.mask
    if not mask:
        raise UnreadableProfile(place, f"no field of {item.row.name} is told")
    return word, mask


def _parameter(document: ProfileDocument, entry: ParameterPart, place: str) -> RegisterBits:
    item = _item(document, entry.name, entry.axis, place)
    if entry.alias and entry.alias.casefold() != item.row.alias:
        raise UnreadableProfile(f"{place}.alias", f"{item.row.name} is {item.row.alias}, not {entry.alias}")
    return RegisterBits(item, _word_of(item, entry.value, f"{place}.value"), item.mask, place)


def _table_wants(document: ProfileDocument) -> Iterator[RegisterBits]:
    tables = document.tables
    for name in ("microstep", "driver_chain", "mslut", "user_variables"):
        if getattr(tables, name) is not None and not any(item.table == name for item in items_of(document.model)):
            raise UnreadableProfile(f"tables.{name}", f"a {document.title} has no such table")
    if tables.microstep is not None:
        yield from _ram(document, "microstep", table_ram_words(tables.microstep))
    if tables.driver_chain is not None:
        yield from _ram(document, "driver_chain", tables.driver_chain)
    for index, part in enumerate(tables.mslut or ()):
        yield from _mslut(document, part, f"tables.mslut[{index}]")
    if tables.user_variables is not None:
        for item in items_of(document.model):
            if item.table == "user_variables":
                place = f"tables.user_variables.{item.row.address}"
                value = tables.user_variables.get(item.row.address, 0)
                yield RegisterBits(item, _word_of(item, value, place), item.mask, place)


def _ram(document: ProfileDocument, table: TableName, words: tuple[int, ...] | list[int]) -> Iterator[RegisterBits]:
    rows = [item for item in items_of(document.model) if item.table == table]
    for index, (item, word) in enumerate(zip(rows, words, strict=True)):
        if word & ~RAM_MASK:
            place = f"tables.{table}[{index}]"
            raise UnreadableProfile(place, f"{word:#x} is no pair of cells of 6 bits: only bits of {RAM_MASK:#x}")
        yield RegisterBits(item, word, item.mask, f"tables.{table}[{index}]")


def _mslut(document: ProfileDocument, part: MslutPart, place: str) -> Iterator[RegisterBits]:
    rows = mslut_rows(document.model, part.axis)
    if len(rows) != MSLUT_WORDS:
        axes = sorted({str(item.row.axis).lower() for item in items_of(document.model) if item.table == "mslut"})
        raise UnreadableProfile(
            f"{place}.axis", f"a {document.title} has no table of that axis; it has {', '.join(axes)}"
        )
    for item, word in zip(rows, (*part.words, part.select, part.start), strict=True):
        if word & ~item.mask:
            bits = f"{word & ~item.mask:#x}"
            raise UnreadableProfile(place, f"bits {bits} of {item.row.name} mean nothing and have to be 0")
        yield RegisterBits(item, word, item.mask, place)


def mslut_rows(model: str, axis: int | None) -> list[Item]:
    """MSLUT[0..7], MSLUTSEL and MSLUTSTART of an axis, or of all of them where `axis` is None or the chip has one."""
    rows = [item for item in items_of(model) if item.table == "mslut"]
    if axis is None and MODELS[model].axes == 1:
        axis = rows[0].row.axis if rows else None
    return sorted((item for item in rows if item.row.axis == axis), key=lambda item: item.row.address)


# --- to the document --------------------------------------------------------------------------------

Said = Callable[[Item], int | None]
"""What a register holds of its configuration; None where nobody knows."""


def register_parts(model: str, word: Said, *, but: Mapping[Key, int] | None = None) -> list[RegisterPart]:
    """A chip's registers that are in no table, sorted by axis and address. `but`: bits that are state at present."""
    parts = []
    for item in _sorted(model):
        held = word(item)
        if item.table is not None or held is None or MODELS[model].kind == "module":
            continue
        left_out = (but or {}).get(item.key, 0)
        fields = [part for part in item.fields if not part.mask & left_out]
        if item.fields:
            told = {part.name: part.unpack(held) for part in fields}
            whole = None if left_out else item.row.decode(held & item.mask)
            parts.append(RegisterPart(name=item.row.name, axis=item.row.axis, value=whole, fields=told))
        else:
            value = item.row.decode(held & item.mask)
            parts.append(RegisterPart(name=item.row.name, axis=item.row.axis, value=value, unit=item.row.unit))
    return parts


def parameter_parts(model: str, word: Said, unit_of: Callable[[Register], str]) -> list[ParameterPart]:
    """A module's parameters that are in no table, sorted by kind and number."""
    parts = []
    for item in _sorted(model):
        held = word(item)
        if item.table is not None or held is None or MODELS[model].kind == "chip":
            continue
        row, value = item.row, item.row.decode(held)
        parts.append(
            ParameterPart(
                name=row.name,
                alias=row.alias,
                axis=row.axis if MODELS[model].axes > 1 else None,
                value=value,
                unit=unit_of(row),
                meaning=row.values.get(value, "")[:200],
            )
        )
    return parts


def tables_of(model: str, word: Said) -> Tables:
    """The tables; None those that the model does not have, or of which nobody knows all."""
    rows = {name: [item for item in items_of(model) if item.table == name] for name in TABLES}
    held = {name: [word(item) for item in items] for name, items in rows.items()}
    microstep, chain = _whole(held["microstep"]), _whole(held["driver_chain"])
    msluts = []
    for axis in dict.fromkeys(item.row.axis for item in rows["mslut"]):
        words = _whole([word(item) for item in mslut_rows(model, axis)])
        if words is not None:
            msluts.append(MslutPart(axis=axis, words=words[:8], select=words[8], start=words[9]))
    variables = {
        item.row.address: item.row.decode(value)
        for item, value in zip(rows["user_variables"], held["user_variables"], strict=True)
        if value
    }
    return Tables(
        microstep=None if microstep is None else list(values_from_ram_words(microstep)),
        driver_chain=chain,
        mslut=msluts or None,
        user_variables=variables if rows["user_variables"] else None,
    )


TABLES: tuple[TableName, ...] = ("microstep", "driver_chain", "mslut", "user_variables")


def unknown_parts(model: str, words: Mapping[Key, int | None]) -> list[UnknownPart]:
    """What nobody knows, of what was asked for."""
    unknown = {key for key, word in words.items() if word is None}
    return [UnknownPart(name=item.row.name, axis=item.row.axis) for item in _sorted(model) if item.key in unknown]


def _sorted(model: str) -> list[Item]:
    """As people look for them: those of the whole chip, then axis by axis, by address; a module's by kind."""
    spaces = list(Space)
    return sorted(
        items_of(model),
        key=lambda item: (
            spaces.index(item.row.space),
            -1 if item.row.axis is None else item.row.axis,
            item.row.address,
        ),
    )


def _whole(words: list[int | None]) -> list[int] | None:
    """The words where there are any and all of them are known."""
    known = [word for word in words if word is not None]
    return known if known and len(known) == len(words) else None
