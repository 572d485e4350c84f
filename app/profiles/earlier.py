"""What a device held before certain entries of the audit log, register by register, as far as the log tells.

The first of the writes that are to be undone says what the register held before it: the driver had read it. Of a
register that none of them wrote, the last write before tells what it should hold still; where it holds something else,
that was changed past the log (a reset, another controller, the chip itself).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from ..registers.catalog import MODELS
from ..registers.model import Access, Register
from ..store.audit_entries import WRITTEN, Entry
from .diff import MECHANICS, UNIT_MODE
from .items import Item, items_by_key, key_of

Place = tuple[str, int | None]
"""A register or setting: its name and axis."""
SETTING_EDITED = "edit device"
SETTINGS = ("name", *MECHANICS)
"""What a profile says of an axis beside its limits, which belong to the machine."""
MOTION = frozenset({"move", "move together", "rotate", "stop", "stop at limit", "start together"})
STORED = frozenset({"download program", "apply profile"})
"""What stores a program in a device's memory; a profile only where it says so."""


@dataclass(frozen=True, slots=True)
class Earlier:
    """A register or setting that was changed, and what it held before.

    was : as people write it; None where nobody knows. logged : what the log says that it holds now; None where the last
    write was not proven. certain : False where the entries to be undone do not speak of it, but an earlier one does.
    since : writes of others that would be undone with it, or lie behind it
    """

    place: Place
    was: int | float | str | None
    logged: int | float | str | None
    certain: bool
    since: Sequence[Entry] = ()
    other_units: bool = False


@dataclass(slots=True)
class Past:
    """What the log tells of a stretch of it."""

    registers: dict[Place, Earlier] = field(default_factory=dict)
    settings: dict[Place, Earlier] = field(default_factory=dict)
    rest: list[Entry] = field(default_factory=list)
    """Other entries to be undone: of what no register holds."""


def past_of(
    model: str, entries: Iterable[Entry], undone: Callable[[Entry], bool], others: Callable[[Entry], bool]
) -> Past:
    """What `entries`, the oldest first, tell of before those among them that are to be `undone`.

    `others` says which entries their writer has to be asked about.
    """
    past = Past()
    writes: dict[Place, list[Entry]] = {}
    edits: dict[Place, list[Entry]] = {}
    first_of_units: int | None = None
    units = items_by_key(model).get(UNIT_MODE)
    for entry in entries:
        if _changed_nothing(entry):
            continue
        if entry.action == WRITTEN:
            writes.setdefault((entry.subject, entry.axis), []).append(entry)
            if units is not None and entry.subject == units.row.name and first_of_units is None and undone(entry):
                first_of_units = entry.id
        elif entry.action == SETTING_EDITED and (setting := _setting_of(entry.subject)) is not None:
            edits.setdefault(setting, []).append(entry)
        elif undone(entry):
            past.rest.append(entry)
    for found, into in ((writes, past.registers), (edits, past.settings)):
        for place, told in found.items():
            earlier = _earlier(place, told, undone, others, first_of_units)
            if earlier is not None:
                into[place] = earlier
    return past


def _earlier(
    place: Place,
    told: Sequence[Entry],
    undone: Callable[[Entry], bool],
    others: Callable[[Entry], bool],
    units_changed: int | None,
) -> Earlier | None:
    at = next((at for at, entry in enumerate(told) if undone(entry)), None)
    if at is None:
        return None
    first, last = told[at], told[-1]
    since = [entry for entry in told[at:] if others(entry)]
    proven = last.outcome.startswith("done")
    # Its number counts in other units than the one that it had before the unit mode was changed.
    restated = units_changed is not None and first.id is not None and first.id > units_changed
    return Earlier(place, first.old, last.new if proven else None, True, since, restated)


def changes_something(entry: Entry) -> bool:
    """Whether an entry says that a register or a setting of an axis was written."""
    written = entry.action == WRITTEN or (entry.action == SETTING_EDITED and _setting_of(entry.subject) is not None)
    return written and not _changed_nothing(entry)


def _changed_nothing(entry: Entry) -> bool:
    return entry.outcome.startswith("refused") and entry.old is None


def _setting_of(subject: str) -> Place | None:
    head, _, name = subject.rpartition(".")
    _, _, axis = head.rpartition(".")
    return (name, int(axis)) if head.startswith("axes.") and axis.isdigit() and name in SETTINGS else None


def last_known(writes: Iterable[Entry], but: Mapping[Place, Earlier]) -> dict[Place, Earlier]:
    """Of registers that nothing to be undone has written: what their last write before has made them."""
    return {
        place: Earlier(place, entry.new, None, False)
        for entry in writes
        if (place := (entry.subject, entry.axis)) not in but and entry.outcome.startswith("done")
    }


def row_of(model: str, place: Place) -> Register | None:
    """The register of that name; None where the model has none (any more)."""
    found = MODELS[model].table.find(place[0], 0 if place[1] is None and MODELS[model].axes == 1 else place[1])
    return None if found is None or found[1] is not None else found[0]


def item_of(model: str, row: Register) -> Item | None:
    """The part of a profile that it is; None where no profile holds it."""
    item = items_by_key(model).get(key_of(row))
    return item if item is not None and item.row is row else None


def why_no_item(row: Register) -> str:
    """Why a register that was written is not put back."""
    if row.read_clears or row.access is Access.R_W1C:
        return "reading or writing it clears it: what it held is gone"
    if not row.access.readable:
        return "it cannot be read, and writing it does something instead of setting something"
    return "it is state, no configuration: where the motor is, or what it was last told to do"


def why_not_undone(entry: Entry) -> str:
    """Why an entry that wrote no register is not put back."""
    if entry.action in MOTION:
        return "motion is not undone: move the axis where it shall be"
    if entry.action in STORED:
        return "a program in a device's memory is not in the log: store it again"
    if entry.action == SETTING_EDITED:
        return "this setting of the connection is edited on the connections page"
    if entry.action == "store":
        return "what EEPROM keeps is not read back: store the parameters again once they are put back"
    return "no register holds it"
