"""A device as it was: at a time, before an entry of the audit log, or without what one request has done to it.

What it held then is told by the log, and what differs from now goes into the device as a profile does: read back,
audited, as one transaction that is taken back where it fails. A preview comes first. What somebody else has written
since, and what was changed past the log, is put back only where that is asked for by its name; what cannot be put back
is told.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from ..devices.core.actor import Actor
from ..devices.core.device import Device
from ..errors import UnknownThing, UsageError, WrongState
from ..registers.model import Register, to_raw
from ..store.audit import AuditLog
from ..store.audit_entries import ADDED, WRITTEN, Entry
from .capture import CapturedConfiguration, axis_part, document_of, read_held
from .diff import units_of_device
from .document import ProfileDocument, Tables
from .earlier import STORED, Earlier, Past, Place, item_of, last_known, past_of, row_of, why_no_item, why_not_undone
from .items import Item, Key, items_of, place_of
from .service import Outcome, ProfileService

State = Literal["ready", "ask", "cannot"]


@dataclass(frozen=True, slots=True)
class Since:
    """To what it was at a time [Unix time, s]."""

    unix_s: float


@dataclass(frozen=True, slots=True)
class Before:
    """To what it was before the entry of that id."""

    entry: int


@dataclass(frozen=True, slots=True)
class Without:
    """To what it was without the entry of that id and all others of its request."""

    entry: int


Aim = Since | Before | Without


@dataclass(frozen=True, slots=True)
class Undone:
    """One register or setting that is not as it was.

    was : then; None where nobody knows. now : as it is. state : "ask" is put back only by its name. since : writes of
    others, the latest last
    """

    name: str
    axis: int | None
    kind: Literal["register", "setting"]
    was: int | float | str | None
    now: int | float | str | None
    state: State
    why: str = ""
    unit: str = ""
    was_physical: str = ""
    now_physical: str = ""
    since: Sequence[Entry] = ()
    item: Item | None = None
    word: int | None = None
    """What its register held, inside the item's mask."""

    @property
    def place(self) -> Place:
        """What it is called by."""
        return self.name, self.axis


@dataclass(frozen=True, slots=True)
class Rest:
    """Entries that nothing puts back."""

    action: str
    subject: str
    count: int
    latest: Entry
    why: str


@dataclass(frozen=True, slots=True)
class Preview:
    """What would be put back. same : registers of the log that are as they were. unseen : of which the log tells
    nothing. seen : the latest entry of the device that it knows of, 0 for none."""

    registers: list[Undone]
    rest: list[Rest]
    same: int
    unseen: list[Place]
    seen: int
    held: CapturedConfiguration = field(repr=False)


@dataclass(frozen=True, slots=True)
class PutBack:
    """What was put back. outcome : None where there was nothing to do"""

    preview: Preview
    outcome: Outcome | None


class UndoService:
    """Finds out what a device held earlier, and puts it back."""

    def __init__(self, audit: AuditLog, profiles: ProfileService) -> None:
        self._audit, self._profiles = audit, profiles

    async def preview(self, device: Device, aim: Aim, by: Actor) -> Preview:
        """What is not as it was, as `by` would put it back. Nothing is written.

        Raises UnknownThing, UsageError for what the log does not reach; StoreUnavailable, BenchError.
        """
        first, entries, past = await self._past(device, aim, by)
        known = (
            {}
            if isinstance(aim, Without)
            else last_known(await self._audit.last_writes(device.id, first), past.registers)
        )
        told = {**past.registers, **known}
        keys = {item.key for place in told if (item := self._item(device, place)) is not None}
        held = await read_held(device, keys)
        differing: list[Undone] = []
        same = 0
        for place, earlier in told.items():
            row = row_of(device.model, place)
            if row is None:
                continue  # a table of another version had it
            found = _compared(device, held, row, earlier)
            same += found is None
            if found is not None:
                differing.append(found)
        order = {item.key: index for index, item in enumerate(items_of(device.model))}
        differing.sort(key=lambda each: len(order) if each.item is None else order[each.item.key])
        differing += [found for earlier in past.settings.values() if (found := _setting(device, earlier)) is not None]
        unseen = [item.row for item in items_of(device.model) if item.key in held.words and item.key not in keys]
        return Preview(
            _tables_known(device, held, differing),
            _rest(past.rest),
            same,
            [] if isinstance(aim, Without) else [(row.name, row.axis) for row in unseen],
            max((entry.id or 0 for entry in entries), default=first - 1),
            held,
        )

    async def put_back(
        self, device: Device, aim: Aim, by: Actor, places: Collection[Place] | None = None, seen: int | None = None
    ) -> PutBack:
        """Put back what is ready, or exactly `places`.

        `seen` is that of the preview on which `places` were chosen. Raises WrongState where one of them was written
        since; UsageError for one that cannot be put back; and what `preview` and `ProfileService.apply` raise.
        """
        preview = await self.preview(device, aim, by)
        chosen = _chosen(preview, places)
        if seen is not None:
            await self._unchanged_since(device, seen, {each.place for each in chosen})
        if not chosen:
            return PutBack(preview, None)
        document = _document(device, preview.held, chosen)
        return PutBack(preview, await self._profiles.apply(device, document))

    # --- the log --------------------------------------------------------------------------------

    async def _past(self, device: Device, aim: Aim, by: Actor) -> tuple[int, list[Entry], Past]:
        first = await self._first(device, aim)
        entries = await self._audit.of_device(device.id, first)
        undone: Callable[[Entry], bool]
        others: Callable[[Entry], bool]
        if isinstance(aim, Without):
            chosen = next((entry for entry in entries if entry.id == aim.entry), None)
            if chosen is None:
                raise UnknownThing("entry of the audit log of this device", str(aim.entry))
            call = chosen.call

            def undone(entry: Entry) -> bool:
                return entry.id == aim.entry if call is None else entry.call == call

            def others(entry: Entry) -> bool:
                return not undone(entry)

        else:
            added = next((entry for entry in entries if entry.action == ADDED and entry.outcome == "done"), None)
            if added is not None:
                raise UsageError(f"{device.name} is there since entry {added.id} only: ask for a time behind it")

            def undone(entry: Entry) -> bool:
                return True

            def others(entry: Entry) -> bool:
                return entry.who != by.name

        return first, entries, past_of(device.model, entries, undone, others)

    async def _first(self, device: Device, aim: Aim) -> int:
        if isinstance(aim, Since):
            first, begins_s = await self._audit.first_since(aim.unix_s)
            if begins_s is None or aim.unix_s < begins_s:
                raise UsageError("the audit log does not reach back so far: ask for a time that it has entries of")
            return first
        if isinstance(aim, Before):
            return aim.entry
        # Entries of one request may stand before the one that is named.
        named = await self._audit.of_device(device.id, aim.entry)
        call = named[0].call if named and named[0].id == aim.entry else None
        return aim.entry if call is None else await self._audit.first_of_call(call)

    async def _unchanged_since(self, device: Device, seen: int, places: set[Place]) -> None:
        for entry in await self._audit.of_device(device.id, seen + 1):
            if entry.action == WRITTEN and (entry.subject, entry.axis) in places:
                raise WrongState(
                    f"{place_of(entry.subject, entry.axis)} was written by {entry.who} since the preview",
                    "have another preview, and choose again",
                )

    @staticmethod
    def _item(device: Device, place: Place) -> Item | None:
        row = row_of(device.model, place)
        return None if row is None else item_of(device.model, row)


# --- what differs -------------------------------------------------------------------------------------


def _compared(device: Device, held: CapturedConfiguration, row: Register, earlier: Earlier) -> Undone | None:
    """The register as it is told; None where it holds what it held."""
    item = item_of(device.model, row)
    was = earlier.was if isinstance(earlier.was, int) else None
    if item is None:
        # What it holds is nobody's setting: told only where a write of the log has made it another one.
        if not earlier.certain or was == earlier.logged:
            return None
        return Undone(row.name, row.axis, "register", was, earlier.logged, "cannot", why_no_item(row), row.unit)
    now = held.words.get(item.key)
    mask = item.mask & ~held.state.get(item.key, 0)
    word = None if was is None else _word(device, item, was)
    if word is not None and now is not None and not (word ^ now) & mask:
        return None
    logged = earlier.logged
    expected = _word(device, item, logged) if isinstance(logged, int) else None
    past_the_log = now is not None and expected is not None and bool((expected ^ now) & mask)
    state, why = _state(row, earlier, was, past_the_log=past_the_log)
    units = units_of_device(device, held)
    shown = None if now is None else row.decode(now)
    return Undone(
        row.name,
        row.axis,
        "register",
        None if word is None else row.decode(word),
        shown,
        state,
        why,
        row.unit,
        "" if word is None else str(units.physical(row, row.decode(word)) or ""),
        "" if shown is None else str(units.physical(row, shown) or ""),
        earlier.since,
        item,
        word,
    )


def _word(device: Device, item: Item, told: int) -> int:
    """A number of the log as one would have to write it, inside the item's mask."""
    return device.configuration.as_written(item.row, to_raw(told, item.row.width)) & item.mask


def _state(row: Register, earlier: Earlier, was: int | None, *, past_the_log: bool) -> tuple[State, str]:
    if was is None:
        return "cannot", "nobody knew what it held before it was written"
    if earlier.other_units and row.internal_range is not None:
        return "cannot", "what it held is known only in the units that the unit mode was changed to"
    if earlier.since:
        names = ", ".join(dict.fromkeys(entry.who for entry in earlier.since))
        return "ask", f"written by {names} since"
    if past_the_log or not earlier.certain:
        return "ask", "it was changed past the log: by a reset, another controller or the chip itself"
    return "ready", "" if row.access.readable else "it cannot be read back"


def _setting(device: Device, earlier: Earlier) -> Undone | None:
    name, axis = earlier.place
    if axis is None or axis >= len(device.axes):
        return None
    now = getattr(axis_part(device.axes[axis].settings), name)
    if now == earlier.was:
        return None
    names = ", ".join(dict.fromkeys(entry.who for entry in earlier.since))
    why = f"edited by {names} since" if names else ""
    state: State = "ask" if names else "ready"
    return Undone(name, axis, "setting", earlier.was, now, state, why, since=earlier.since)


def _tables_known(device: Device, held: CapturedConfiguration, found: Sequence[Undone]) -> list[Undone]:
    """A word of a table goes back with its table, all of which has to be known."""
    unknown = {
        (item.table, item.row.axis if item.table == "mslut" else None)
        for item in items_of(device.model)
        if item.table is not None and held.words.get(item.key) is None
    }
    incomplete = "other words of its table cannot be read"
    return [
        replace(each, state="cannot", why=incomplete)
        if each.item is not None
        and each.state != "cannot"
        and (each.item.table, each.axis if each.item.table == "mslut" else None) in unknown
        else each
        for each in found
    ]


def _rest(entries: Sequence[Entry]) -> list[Rest]:
    """What is left, the same things together. A profile or a table is told by its registers."""
    found: dict[tuple[str, str], Rest] = {}
    for entry in entries:
        if entry.action in TOLD_BY_REGISTERS and not (entry.action in STORED and entry.detail):
            continue
        key = entry.action, entry.subject if entry.action != "move" else ""
        count = found[key].count + 1 if key in found else 1
        found[key] = Rest(entry.action, entry.subject, count, entry, why_not_undone(entry))
    return list(found.values())


TOLD_BY_REGISTERS = frozenset({"apply profile", "undo", "take profile back", "write table", "start up"})


# --- what is put back ---------------------------------------------------------------------------------


def _chosen(preview: Preview, places: Collection[Place] | None) -> list[Undone]:
    if places is None:
        return [each for each in preview.registers if each.state == "ready"]
    found = {each.place: each for each in preview.registers}
    for place in places:
        each = found.get(place)
        if each is None:
            raise UsageError(f"{place_of(*place)} is as it was, or the log does not tell what it was")
        if each.state == "cannot":
            raise UsageError(f"{place_of(*place)} cannot be put back: {each.why}")
    return [found[place] for place in places]


def _document(device: Device, held: CapturedConfiguration, chosen: Sequence[Undone]) -> ProfileDocument:
    """A profile of what is put back alone, and of whole tables where it is words of these."""
    words: dict[Key, int | None] = dict(held.words)
    for each in chosen:
        if each.item is not None:
            words[each.item.key] = each.word
    whole = document_of(device, replace(held, words=words), "as it was", "", 0.0)
    places = {each.place for each in chosen}
    whole.registers = [part for part in whole.registers if (part.name, part.axis) in places]
    one = len(device.axes) == 1
    whole.parameters = [
        part for part in whole.parameters if {(part.name, part.axis), (part.name, 0 if one else part.axis)} & places
    ]
    tables = {each.item.table for each in chosen if each.item is not None}
    of_axes = {each.axis for each in chosen if each.item is not None and each.item.table == "mslut"}
    whole.tables = Tables(**{name: part for name, part in whole.tables if name in tables})
    if whole.tables.mslut is not None:
        one_axis = len(whole.tables.mslut) == 1
        whole.tables.mslut = [part for part in whole.tables.mslut if one_axis or part.axis in of_axes]
    whole.unknown = []
    settings = {each.place: each.was for each in chosen if each.kind == "setting"}
    if not settings:
        whole.axes = []
    for index, part in enumerate(whole.axes):
        part.limits = None
        for (name, axis), was in settings.items():
            if axis == index:
                setattr(part, name, was)
    return whole
