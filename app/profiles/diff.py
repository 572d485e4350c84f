"""What differs between a profile and a device, or between two profiles: by register, field, table and mechanics.

Each difference has both numbers as the chip has them and, where they mean something physical, in its units, each
side by its own clock, dividers and mechanics: the same V_MAX may be another speed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from pydantic import ConfigDict, Field

from ..deferred import DeferredModel
from ..devices.core.device import Device
from ..registers.model import Space
from .capture import CapturedConfiguration, axis_part, read_held
from .document import AxisPart, ProfileDocument
from .errors import ProfileMisfit
from .items import Item, Key, items_of
from .physical import Physical, UnitContext
from .program import ProgramDifference, ProgramStep, commands_of, compared, step_of
from .register_bits import RegisterBits, bits_of

CLOCK_TOLERANCE = 0.005
"""By how much two clocks may differ and count as the same: a crystal's error and some rounding."""
UNIT_MODE = (Space.AXIS, 255, 0)
"""AP 255: in which units a module counts speeds."""

Kind = Literal["register", "parameter", "table", "mechanics", "limits", "clock"]


class _Part(DeferredModel):
    model_config = ConfigDict(from_attributes=True, json_schema_serialization_defaults_required=True)


class FieldDifference(_Part):
    """A field of a packed register."""

    name: str
    left: int | None
    right: int
    left_meaning: str = ""
    right_meaning: str = ""


class Difference(_Part):
    """One register, parameter, table word or setting that is not the same on both sides.

    Compared with a device, `left` is what it holds and `right` what the profile wants.
    """

    kind: Kind
    name: str
    axis: int | None = None
    table: str | None = Field(default=None, description="the table that it is a word of")
    left: int | float | str | None = Field(description="as the chip has it; null where nobody knows")
    right: int | float | str | None
    unit: str = Field(default="", description="what both count in")
    left_physical: str | None = Field(default=None, description="in people's units, by that side's clock and dividers")
    right_physical: str | None = None
    fields: list[FieldDifference] = Field(default_factory=list, description="those that differ")
    written: bool = Field(default=True, description="whether apply would write it")
    why: str = Field(default="", description="what to know about it, or why it is not written")


class TableDifference(_Part):
    """How much of a table is not the same; its words are among the differences."""

    name: str
    axis: int | None
    differing: int
    of: int


class Diff(_Part):
    """All differences between two sides, in the order in which they would be written."""

    left: str
    right: str
    model: str
    differences: list[Difference]
    tables: list[TableDifference]
    program: ProgramDifference | None = Field(
        default=None, description="of programs in a module's memory; null where they are the same, or nobody asks"
    )
    same: int = Field(description="how many registers and parameters are the same on both sides")
    warnings: list[str]

    @property
    def writes(self) -> int:
        """How many of them apply would write, a program as one."""
        return sum(difference.written for difference in self.differences) + (self.program is not None)


@dataclass(frozen=True, slots=True)
class Side:
    """One side of a comparison."""

    title: str
    units: UnitContext
    firmware: str = ""


def _apart(left: tuple[str, str], right: tuple[str, str]) -> tuple[str, str]:
    """The names of both sides; where they are the same, each with what it is beside it."""
    if left[0] != right[0]:
        return left[0], right[0]
    return f"{left[0]} ({left[1]})", f"{right[0]} ({right[1]})"


# --- against a device -------------------------------------------------------------------------------


def require_fit(device: Device, document: ProfileDocument) -> None:
    """Raises ProfileMisfit for a profile of another model, or of another clock.

    Another chip of the same family is refused too: it scales currents and counts thresholds otherwise, so that the
    same registers would make another motor of it. And at another clock the same registers are other speeds.
    """
    if document.model != device.model:
        raise ProfileMisfit(
            f"this profile is of a {document.title}, {device.name} is a {device.family.title}"
            f"{_what_differs(document.model, device.model)}",
            f"apply it to a {document.title}",
        )
    if abs(document.clock_hz / device.clock_hz - 1) > CLOCK_TOLERANCE:
        theirs, ours = f"{document.clock_hz / 1e6:g} MHz", f"{device.clock_hz / 1e6:g} MHz"
        raise ProfileMisfit(
            f"this profile is of a chip at {theirs}, {device.name} runs at {ours}: its speeds would be others",
            "correct clock_hz of the connection, or of the profile together with its speeds",
        )


def _what_differs(one: str, other: str) -> str:
    """Registers that only one of two siblings has; empty where they are no siblings."""
    if not (one.startswith("tmc5") and other.startswith("tmc5")):
        return ""
    here, there = ({item.row.name for item in items_of(model)} for model in (one, other))
    missing = sorted(here - there)
    return f", which lacks {', '.join(missing[:4])}{' and more' * (len(missing) > 4)}" if missing else ""


async def diff(device: Device, document: ProfileDocument) -> Diff:
    """What `apply` would change. Nothing is written. Raises ProfileMisfit, UnreadableProfile, BenchError."""
    require_fit(device, document)
    wants = bits_of(document)
    program = await step_of(device, document)
    return difference_of(device, await read_held(device, wants), document, wants, program)


def difference_of(
    device: Device,
    held: CapturedConfiguration,
    document: ProfileDocument,
    wants: Mapping[Key, RegisterBits],
    program: ProgramStep | None = None,
) -> Diff:
    """The same of what was read already; `program` is what has to be stored."""
    names = _apart((device.name, "as it is"), (document.name or "the profile", "profile"))
    left = Side(names[0], units_of_device(device, held), device.configuration.firmware)
    right = Side(names[1], units_of_document(document, wants, held), document.firmware)
    found = list(_registers(left, right, held.words, wants))
    axes = [axis_part(axis.settings) for axis in device.axes]
    settings = [*_axes(axes, document.axes, against_device=True)]
    found_all = _diff(left, right, document.model, found, settings, len(wants))
    if program is not None:
        found_all.program = compared(document.model, program.was, program.wanted)
    return found_all


def units_of_device(device: Device, held: CapturedConfiguration) -> UnitContext:
    """What converts the registers of a device to physical units."""
    return UnitContext(
        device.model, device.clock_hz, tuple(axis_part(axis.settings) for axis in device.axes), held.words
    )


# --- two documents ----------------------------------------------------------------------------------


def compare(left: ProfileDocument, right: ProfileDocument) -> Diff:
    """What differs between two profiles. Raises ProfileMisfit for two models, UnreadableProfile."""
    if left.model != right.model:
        raise ProfileMisfit(
            f"one profile is of a {left.title}, the other of a {right.title}", "compare two of the same model"
        )
    ours, theirs = bits_of(left), bits_of(right)
    names = _apart((left.name or "the first", "first"), (right.name or "the second", "second"))
    one = Side(names[0], units_of_document(left, ours), left.firmware)
    other = Side(names[1], units_of_document(right, theirs), right.firmware)
    words = {key: want.word for key, want in ours.items()}
    found = list(_registers(one, other, words, theirs))
    missing = [_missing(one, want) for key, want in ours.items() if key not in theirs]
    settings = [*_clock(left, right), *_axes(left.axes, right.axes, against_device=False)]
    found_all = _diff(one, other, left.model, [*found, *missing], settings, len(theirs))
    ours_stored, theirs_stored = commands_of(left), commands_of(right)
    if ours_stored is not None and theirs_stored is not None:
        found_all.program = compared(left.model, ours_stored, theirs_stored)
    elif (ours_stored is None) != (theirs_stored is None):
        found_all.warnings.append(f"only {(right if ours_stored is None else left).name or 'one'} speaks of a program")
    return found_all


def units_of_document(
    document: ProfileDocument, wants: Mapping[Key, RegisterBits], held: CapturedConfiguration | None = None
) -> UnitContext:
    """What converts the registers of a document to physical units; of what it does not say, as the device has it."""
    words: dict[Key, int | None] = dict(held.words) if held is not None else {}
    words |= {key: want.word | ((words.get(key) or 0) & ~want.mask) for key, want in wants.items()}
    return UnitContext(document.model, document.clock_hz, tuple(document.axes), words)


def _missing(one: Side, want: RegisterBits) -> Difference:
    item = want.item
    value = item.row.decode(want.word)
    return Difference(
        kind=_kind(item),
        name=item.row.name,
        axis=item.row.axis,
        table=item.table,
        left=value,
        right=None,
        unit=item.row.unit,
        left_physical=_text(one.units.physical(item.row, value)),
        written=False,
        why="the second profile does not speak of it",
    )


# --- both ------------------------------------------------------------------------------------------


def _registers(
    left: Side, right: Side, words: Mapping[Key, int | None], wants: Mapping[Key, RegisterBits]
) -> Iterator[Difference]:
    for key, want in wants.items():
        held = words.get(key)
        if held is not None and (held ^ want.word) & want.mask == 0:
            continue
        yield _difference(left, right, held, want)


def _difference(left: Side, right: Side, held: int | None, want: RegisterBits) -> Difference:
    item, row = want.item, want.item.row
    before = None if held is None else row.decode(held & item.mask)
    after = row.decode(want.word | ((held or 0) & item.mask & ~want.mask))
    fields = [
        FieldDifference(
            name=part.name,
            left=None if held is None else part.unpack(held),
            right=part.unpack(want.word),
            left_meaning="" if held is None else part.values.get(part.unpack(held), ""),
            right_meaning=part.values.get(part.unpack(want.word), ""),
        )
        for part in item.fields
        if part.mask & want.mask == part.mask and (held is None or (held ^ want.word) & part.mask)
    ]
    return Difference(
        kind=_kind(item),
        name=row.name,
        axis=row.axis,
        table=item.table,
        left=before,
        right=after,
        unit=row.unit,
        left_physical=None if before is None else _text(left.units.physical(row, before)),
        right_physical=_text(right.units.physical(row, after)),
        fields=fields,
        why="" if held is not None else "it cannot be read, and nobody here has written it since its reset",
    )


def _diff(
    left: Side, right: Side, model: str, registers: list[Difference], settings: list[Difference], wants: int
) -> Diff:
    counts: dict[tuple[str, int | None], int] = {}
    for difference in registers:
        if difference.table is not None:
            key = difference.table, difference.axis
            counts[key] = counts.get(key, 0) + 1
    tables = [
        TableDifference(
            name=name,
            axis=axis,
            differing=count,
            of=sum(item.table == name and item.row.axis == axis for item in items_of(model)),
        )
        for (name, axis), count in counts.items()
    ]
    same = wants - sum(difference.right is not None for difference in registers)
    warnings = []
    if left.firmware and right.firmware and left.firmware != right.firmware:
        warnings.append(f"firmware {left.firmware} and {right.firmware}: parameters may mean other things")
    return Diff(
        left=left.title,
        right=right.title,
        model=model,
        differences=[*registers, *settings],
        tables=tables,
        same=same,
        warnings=warnings,
    )


def _kind(item: Item) -> Kind:
    if item.table is not None:
        return "table"
    return "register" if item.row.space is Space.REGISTER else "parameter"


def _text(physical: Physical | None) -> str | None:
    return None if physical is None else str(physical)


# --- mechanics --------------------------------------------------------------------------------------

MECHANICS = {"full_steps_per_rev": "full steps", "driver_microsteps": "", "gear_ratio": "", "travel_mm_per_rev": "mm"}


def _clock(left: ProfileDocument, right: ProfileDocument) -> Iterator[Difference]:
    if left.clock_hz != right.clock_hz:
        yield Difference(
            kind="clock", name="clock_hz", left=left.clock_hz, right=right.clock_hz, unit="Hz", written=False
        )


def _axes(left: list[AxisPart], right: list[AxisPart], *, against_device: bool) -> Iterator[Difference]:
    for index, (one, other) in enumerate(zip(left, right, strict=False)):
        for name, unit in (("name", ""), *MECHANICS.items()):
            before, after = getattr(one, name), getattr(other, name)
            if before != after:
                yield Difference(kind="mechanics", name=name, axis=index, left=before, right=after, unit=unit)
        if one.limits is None or other.limits is None:
            continue
        for name in type(one.limits).model_fields:
            before, after = getattr(one.limits, name), getattr(other.limits, name)
            if before != after:
                why = (
                    "limits are the machine's: they are applied only where that is asked for" if against_device else ""
                )
                yield Difference(
                    kind="limits", name=name, axis=index, left=before, right=after, written=not against_device, why=why
                )
