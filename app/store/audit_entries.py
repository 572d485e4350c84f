"""Entries of the audit log: what they hold, and what they are looked for by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..devices.core.actor import ActorKind
from ..devices.core.changes import DONE

Value = int | float | str | None
WRITTEN, ADDED = "write", "add device"
"""Actions: a register was written, and a device is there from now on."""
LONG = {"who": 100, "address": 60, "device": 80, "action": 60, "subject": 200, "outcome": 500, "detail": 500}
"""How long each text may be: much of it comes from outside."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One thing that a user did, or was refused.

    at_unix_s : Unix time [s]. action : as people say it, "write", "move", "add device"... subject : what it was done
    to, a register by its name. old, new : values where there are any. outcome : "done", "done: note",
    "not proven: why", "refused: why". id : None before it is in the database. call : what entries of one request have
    in common; None where it belongs to none.
    """

    at_unix_s: float
    who: str
    kind: ActorKind
    address: str
    device: str | None
    axis: int | None
    action: str
    subject: str
    old: Value = None
    new: Value = None
    outcome: str = DONE
    detail: str = ""
    id: int | None = None
    call: int | None = None


@dataclass(frozen=True, slots=True)
class EntryFilter:
    """Which entries: all words of `text` anywhere in them, and each of the others where it is given."""

    text: str = ""
    device: str = ""
    who: str = ""
    action: str = ""
    outcome: str = ""
    """What it begins with: "done", "not proven" or "refused"."""
    since_unix_s: float | None = None
    until_unix_s: float | None = None
    after: int | None = None
    """Only entries with higher ids."""


@dataclass(frozen=True, slots=True)
class Known:
    """What there is to filter by."""

    devices: Sequence[str]
    who: Sequence[str]
    actions: Sequence[str]


def row_of(entry: Entry) -> dict[str, object]:
    """The columns of an entry that is new; long texts end in an ellipsis."""
    row: dict[str, object] = {name: getattr(entry, name) for name in entry.__slots__ if name != "id"}
    for name, length in LONG.items():
        text = row[name]
        if isinstance(text, str):
            whole = text.encode("utf-8", "replace").decode()  # half a character of an address is no text for a database
            row[name] = whole if len(whole) <= length else whole[: length - 1] + "…"
    return row
