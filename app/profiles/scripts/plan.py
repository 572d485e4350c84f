"""What a script has to write, in its order: the same for every language."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime

from ...devices.core.config import slug
from ...registers.catalog import MODELS, Model
from ...registers.model import Access, Register
from ..document import AxisPart, ProfileDocument
from ..errors import UnreadableProfile
from ..register_bits import RegisterBits, bits_of, check_range
from .preconditions import kept_ready, ready_of


@dataclass(frozen=True, slots=True)
class Write:
    """One register or parameter, and what it gets. Table words are registers as well."""

    want: RegisterBits

    @property
    def register(self) -> Register:
        """The row of the catalog."""
        return self.want.item.row

    @property
    def value(self) -> int:
        """The word as people write it."""
        return self.register.decode(self.want.word)

    @property
    def fields(self) -> Mapping[str, int]:
        """What the word says by field, in the order of the data sheet; empty where there is none, and of tables."""
        if self.want.item.table is not None:
            return {}
        told = (part for part in self.want.item.fields if part.mask & self.want.mask == part.mask)
        return {part.name: part.unpack(self.want.word) for part in told}

    @property
    def number(self) -> str:
        """The value as a program has it: words of a table by their bits."""
        return f"0x{self.want.word:04X}" if self.want.item.table not in (None, "user_variables") else str(self.value)

    @property
    def whole_word(self) -> int:
        """For who cannot read before writing: what the profile does not tell (state, say) is as after a reset."""
        free = sum(part.mask for part in self.register.fields if part.access in KEPT and not part.when)
        return self.want.word | ((self.register.reset or 0) & free & ~self.want.mask)


KEPT = (Access.RW, Access.W)
"""Access of fields that keep what is written; a 1 in others clears something."""


@dataclass(frozen=True, slots=True)
class Part:
    """Writes that follow each other and belong together."""

    title: str
    writes: tuple[Write, ...]


@dataclass(frozen=True, slots=True)
class Plan:
    """A profile as writes in the order that is safe. `name` and `note` are what people wrote: never code."""

    model: str
    device: str
    """Id of the device that the profile is of: what a script writes to unless it is told otherwise."""
    name: str
    note: str
    captured: str
    """Date and time, for people."""
    clock_hz: float
    parts: tuple[Part, ...]
    mechanics: tuple[Mapping[str, float | None], ...] = ()
    """Of each axis what it moves: settings of the connection, which only a program with a server can set."""
    program: bool = False
    """Whether the profile has a program for the device's memory."""

    @property
    def family(self) -> Model:
        """The catalog's entry of the model."""
        return MODELS[self.model]

    @property
    def count(self) -> int:
        """How many writes there are."""
        return sum(len(part.writes) for part in self.parts)

    @property
    def left_out(self) -> tuple[str, ...]:
        """What only a program with a server can set, as a remark for the others; nothing where there is nothing."""
        if not self.mechanics:
            return self.program_left_out
        told = "Not in here, since it belongs to the connection: what the motors move (mechanics and soft limits)."
        return (told, *self.program_left_out)

    @property
    def program_left_out(self) -> tuple[str, ...]:
        """That no script stores the profile's program, as a remark; nothing where it has none."""
        return ("Not in here: the profile's program. `stepscope profile apply` stores it too.",) if self.program else ()

    @property
    def about(self) -> str:
        """What it is of, in a line."""
        clock = "" if self.family.kind == "module" else f", clock {self.clock_hz:.10g} Hz"
        return f"{self.family.title}{clock}, captured {self.captured}"


def plan_of(document: ProfileDocument) -> Plan:
    """The writes of a profile. Raises UnreadableProfile for what no device can hold, and where there is nothing."""
    wants = bits_of(document)
    if not wants:
        raise UnreadableProfile("registers", "the profile says nothing that could be written")
    for want in wants.values():
        check_range(want)
    axes = MODELS[document.model].axes
    ready = tuple(Write(want) for want in ready_of(document.model, wants))
    parts = (
        Part(title, tuple(Write(kept_ready(want)) for want in some))
        for title, some in itertools.groupby(wants.values(), lambda want: _title(want, axes))
    )
    return Plan(
        model=document.model,
        device=slug(document.device or "device"),
        name=document.name or document.device or document.title,
        note=document.note,
        captured=_date(document.captured_unix_s),
        clock_hz=document.clock_hz,
        parts=(*((Part("ready: nowhere to go", ready),) if ready else ()), *parts),
        mechanics=tuple(mechanics_of(axis) for axis in document.axes),
        program=document.program is not None,
    )


def mechanics_of(axis: AxisPart) -> dict[str, float | None]:
    """The motor and what it moves, as the API names it. Names and limits stay those of the machine."""
    return {name: getattr(axis, name) for name in MECHANICS}


MECHANICS = ("full_steps_per_rev", "driver_microsteps", "gear_ratio", "travel_mm_per_rev")


def _title(want: RegisterBits, axes: int) -> str:
    row = want.item.row
    return row.group if row.axis is None or axes == 1 else f"{row.group}, axis {row.axis}"


def _date(unix_s: float) -> str:
    try:
        return datetime.fromtimestamp(unix_s, UTC).strftime("%Y-%m-%d %H:%M UTC") if unix_s else "at an unknown time"
    except (ValueError, OverflowError, OSError):  # a file may say any number
        return "at an unknown time"


ALWAYS_SHOWN = 4
"""Of a register with more fields than these, a remark leaves out those that are 0."""


def meaning(write: Write) -> str:
    """What a written word says, for a remark: its fields, or its value with the unit."""
    fields = write.fields
    if fields:
        told = {name: value for name, value in fields.items() if value or len(fields) <= ALWAYS_SHOWN}
        return ", ".join(f"{name} {value}" for name, value in told.items()) or "all fields 0"
    said = write.register.values.get(write.value)
    return f"{write.number} {write.register.unit if said is None else f'({said})'}".rstrip()
