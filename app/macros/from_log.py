"""Steps of a macro, made of what the audit log tells of a device: pauses between them become waits."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from pydantic import TypeAdapter, ValidationError

from ..deferred import DEFERRED
from ..number_text import plain
from ..store.audit_entries import Entry
from .document import STEPS_MAX, MoveStep, RotateStep, Step

NO_PAUSE_S = 0.1
"""A shorter pause is none [s]."""
ARRIVES_LEAST_S = 10.0
_FIELD = re.compile(r"([A-Za-z0-9_]+) (?:-?\d+ )?-> (-?\d+)")
_ASKED = re.compile(r"asked (by|to) (\S+) (\w+)")
_TAKES = re.compile(r"in (\S+) s\b")
_RECORDED = re.compile(r"device: ([^,]+), channels: \[([^\]]*)\](?:.*?rate_hz: ([0-9.]+))?")
_STEP: TypeAdapter[Step] = TypeAdapter(Step, config=DEFERRED)
WITHOUT_DEVICE = ("stop everything", "start recording", "stop recording")
"""Actions whose entries name no device, and may be about it all the same."""
NO_STEP = ("lease", "add device", "edit device", "connect", "disconnect", "keep macro", "save macro", "macro over")
"""What such an action begins with is nothing that a macro would do, and nobody misses it."""


@dataclass(slots=True)
class Draft:
    """Steps, and what the log tells that none could be made of."""

    steps: list[Step] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class _Made:
    """A step of an entry. arrives_s : how long the move that it starts takes [s]; None where it starts none."""

    at_s: float
    step: Step
    arrives_s: float | None = None
    call: int | None = None


def draft_of(
    entries: Sequence[Entry], device: str, longest_pause_s: float, profile_of: Callable[[str], int | None]
) -> Draft:
    """Of entries, the oldest first. `profile_of` finds the number of a kept profile by its name, None for none."""
    draft, made = Draft(), list[_Made]()
    whole = {entry.call: entry for entry in entries if entry.action in ("apply profile", "run macro") and entry.call}
    recording: str | None = None
    for entry in entries:
        told = whole.get(entry.call) if entry.call else None
        if told is not None and told is not entry:
            continue  # a profile's own writes, a macro's own steps
        if entry.action.startswith(NO_STEP) or (entry.device not in (None, device)):
            continue
        text = " ".join(filter(None, (entry.action, entry.subject)))
        if entry.outcome.startswith("refused"):
            draft.left_out.append(f"{text}: it was {entry.outcome}")
            continue
        moved = sorted({one.step.axis for one in made if isinstance(one.step, MoveStep | RotateStep)})
        found, why = _step_of(entry, device, moved, profile_of)
        if entry.action == "start recording" and found is not None:
            recording = entry.subject
        if entry.action == "stop recording":
            found, why = ({"do": "record stop"}, "") if recording is not None else (None, "")
            recording = None
        if found is None:
            if why:
                draft.left_out.append(f"{text}: {why}")
            continue
        for each in found if isinstance(found, list) else [found]:
            try:
                step = _STEP.validate_python(each)
            except ValidationError:
                draft.left_out.append(f"{text}: no step can say this")
                continue
            made.append(_Made(entry.at_unix_s, step, _takes_s(entry), entry.call))
    draft.steps = _with_waits(made, longest_pause_s)
    if recording is not None:
        draft.steps.append(_STEP.validate_python({"do": "record stop"}))
    if len(draft.steps) > STEPS_MAX:
        draft.left_out.append(f"{len(draft.steps) - STEPS_MAX} steps behind the first {STEPS_MAX}")
        draft.steps = draft.steps[:STEPS_MAX]
    return draft


def _step_of(
    entry: Entry, device: str, moved: Sequence[int], profile_of: Callable[[str], int | None]
) -> tuple[dict[str, Any] | list[dict[str, Any]] | None, str]:
    """A step as JSON, or why there is none; "" where nobody would miss it."""
    axis = 0 if entry.axis is None else entry.axis
    match entry.action:
        case "write":
            fields = {name: int(new) for name, new in _FIELD.findall(entry.detail)}
            if fields and entry.detail != _fields_text(entry.detail):
                return None, "it is a word of a table: keep the table as a profile, and apply that"
            if fields:
                return {"do": "write", "name": entry.subject, "axis": entry.axis, "fields": fields}, ""
            if not isinstance(entry.new, int):
                return None, "nobody knows what was written"
            return {"do": "write", "name": entry.subject, "axis": entry.axis, "value": entry.new}, ""
        case "move" | "move together":
            asked = _ASKED.search(entry.detail)
            if asked is not None:
                way, unit = asked[1] == "by", asked[3]
                return {
                    "do": "move",
                    "axis": axis,
                    "target": float(asked[2]),
                    "relative": way,
                    "unit": unit,
                }, ""
            return {"do": "move", "axis": axis, "target": entry.new}, ""
        case "rotate":
            unit = entry.detail.partition(",")[0]
            return {"do": "rotate", "axis": axis, "velocity": entry.new, "unit": unit}, ""
        case "stop":
            return {"do": "stop", "axis": axis, "mode": _mode(entry)}, ""
        case "stop everything":
            return [{"do": "stop", "axis": each, "mode": _mode(entry)} for each in moved], ""
        case "start recording":
            found = _RECORDED.search(entry.detail)
            if found is None:
                return None, "the log does not tell of which channels: add the step by hand"
            if found[1] != device:
                return None, ""
            channels = [name.strip() for name in found[2].split(",") if name.strip()]
            rate_hz = float(found[3]) if found[3] else 200.0
            return {
                "do": "record start",
                "name": entry.subject or "macro",
                "channels": channels,
                "rate_hz": rate_hz,
            }, ""
        case "apply profile":
            number = profile_of(entry.subject)
            if number is None:
                return None, "no profile of that name is kept: keep it first"
            return {"do": "profile", "profile": number, "name": entry.subject}, ""
    return None, "a macro has no step for it"


def _mode(entry: Entry) -> str:
    return "immediate" if "immediate" in entry.detail else "ramp"


def _fields_text(detail: str) -> str:
    """As much of a detail as tells of fields: all of it where the word is of no table."""
    return ", ".join(found[0] for found in re.finditer(_FIELD, detail))


def _takes_s(entry: Entry) -> float | None:
    if entry.action not in ("move", "move together"):
        return None
    found = _TAKES.search(entry.detail)
    return float(found[1]) if found else 0.0


def _with_waits(made: Sequence[_Made], longest_pause_s: float) -> list[Step]:
    """Between a move that had ended and what came next stands a wait for its end; other pauses are waits for a time."""
    steps: list[Step] = []
    under_way: dict[int, float] = {}  # axis: when its move is over

    def add(step: dict[str, Any]) -> None:
        steps.append(_STEP.validate_python(step))

    def arrive(until_s: float) -> float:
        """Wait for what has arrived until then; when the latest of it had [s]."""
        latest_s = 0.0
        for axis, over_s in sorted(under_way.items()):
            if over_s <= until_s:
                add({"do": "wait position", "axis": axis, "at_most_s": _bound(over_s - begun[axis])})
                latest_s = max(latest_s, over_s)
                del under_way[axis]
        return latest_s

    begun: dict[int, float] = {}
    for one, after in pairwise([*made, None]):
        assert one is not None
        steps.append(one.step)
        axis = getattr(one.step, "axis", None)
        if one.arrives_s is not None and axis is not None:
            under_way[axis], begun[axis] = one.at_s + one.arrives_s, one.at_s
        elif one.step.do in ("stop", "rotate") and axis is not None:
            under_way.pop(axis, None)
        if after is None:
            arrive(float("inf"))
            break
        if after.call is not None and after.call == one.call:
            continue  # of one request: nobody paused
        since_s = max(one.at_s, arrive(after.at_s))
        pause_s = min(after.at_s - since_s, longest_pause_s)
        if pause_s >= NO_PAUSE_S:
            add({"do": "wait", "seconds": float(plain(pause_s, 3))})
    return steps


def _bound(takes_s: float) -> float:
    """How long a move may take that took so long: twice that, and some seconds."""
    return float(plain(min(3600.0, max(ARRIVES_LEAST_S, 2 * takes_s)), 2))
