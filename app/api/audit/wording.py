"""What calls from outside are in the audit log's words: by method and address, whether or not they got anywhere.

A call that nobody has described here is entered all the same, in words made of its address: forgetting one hides
nothing. Not entered is what changes nothing, and what drivers and the lease tell of better: their own events.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import parse_qsl

from ...store.tables import Value

Json = Mapping[str, Any]
SILENT = frozenset(
    {
        ("POST", "devices/test"),
        ("POST", "ports/search"),
        ("DELETE", "ports/search"),
        ("PATCH", "devices/{}/axes/{}/rotate"),  # keeps a rotation up, many times a second
        ("POST", "recordings/compare"),
        ("POST", "profiles/compare"),
        ("POST", "profiles/script"),
        ("POST", "twin"),
        ("DELETE", "twin"),
        ("POST", "twin/cursor"),
    }
)
"""What looks, or shows, and changes nothing. Calculators and the lease are silent as a whole."""
BY_EVENTS = frozenset(
    {
        ("PUT", "devices/{}/registers/{}"),
        ("POST", "devices/{}/registers"),
        ("POST", "devices/{}/registers/{}/restore"),
        ("POST", "devices/{}/exchange"),
        ("POST", "devices/{}/tmcl"),
    }
)
"""What registers hold afterwards, drivers tell: only what they have not told is entered for these."""
PARTLY = frozenset({("POST", "devices/{}/registers"), ("POST", "stop")})
"""Answers that are a success as a whole and may hold failures."""
WHOLE = frozenset(
    {
        ("PUT", "devices/{}/profile"),
        ("POST", "devices/{}/profile/apply/way-back"),
        ("POST", "devices/{}/start-up"),
        ("POST", "devices/{}/axes/{}/start-up"),
    }
)
"""Many writes that are one thing: entered as such too, when one of them has failed and the drivers have told of it."""
TEXT_MAX = 200


@dataclass(frozen=True, slots=True)
class Call:
    """A call from outside, taken apart. `key` is its method and address, with {} for what names something."""

    key: tuple[str, str]
    names: tuple[str, ...]
    """What stood in place of each {}."""
    query: Json
    body: Json
    answer: Any = None
    device: str | None = None
    axis: int | None = None


@dataclass(frozen=True, slots=True)
class Said:
    """A call in words."""

    action: str
    subject: str = ""
    old: Value = None
    new: Value = None
    detail: str = ""
    device: str | None = None
    axis: int | None = None
    more: tuple[Said, ...] = field(default=())
    """Further entries of the same call."""


def taken_apart(method: str, path: str, query: bytes) -> Call:
    """`path` is below the API's base, without a slash in front."""
    parts = [part for part in path.split("/") if part]
    names: list[str] = []
    device, axis = None, None
    if parts[:1] == ["devices"] and len(parts) > 1 and parts[1:] != ["test"]:
        device = _name(parts, 1, names)
        if parts[2:3] == ["axes"] and len(parts) > 3:
            number = _name(parts, 3, names)
            axis = int(number) if re.fullmatch("[0-9]{1,2}", number) else None
        elif parts[2:3] == ["registers"] and len(parts) > 3:
            _name(parts, 3, names)
    elif parts[:1] in (["recordings"], ["profiles"], ["tokens"]) and len(parts) > 1 and (method, path) not in SILENT:
        _name(parts, 1, names)
    asked = dict(parse_qsl(query.decode("latin-1"), keep_blank_values=True))
    if axis is None and re.fullmatch("[0-9]{1,2}", asked.get("axis", "")):
        axis = int(asked["axis"])
    return Call((method, "/".join(parts)), tuple(names), asked, {}, None, device, axis)


def _name(parts: list[str], at: int, names: list[str]) -> str:
    name, parts[at] = parts[at], "{}"
    names.append(name)
    return name


def is_silent(call: Call) -> bool:
    """Whether nothing is entered for it, whatever comes of it."""
    if call.key in SILENT or call.key[1].startswith(("calc/", "lease")):
        return True
    return call.key == ("PUT", "devices/{}/profile") and call.query.get("dry_run") == "true"


def only_reads(call: Call) -> bool:
    """Whether a raw frame, or a start-up tried dry, has changed nothing, as far as its answer tells."""
    if call.key == ("POST", "devices/{}/start-up") and isinstance(call.answer, dict):
        return call.answer.get("state") == "dry run"
    if call.key == ("POST", "devices/{}/exchange") and isinstance(call.answer, dict):
        decoded = call.answer.get("decoded")
        return isinstance(decoded, dict) and decoded.get("rw") == "read"
    return False


def in_words(call: Call) -> Said:
    """The entry of a call; what it asked for, or what came of it where `answer` tells."""
    worded = WORDS.get(call.key)
    return _by_address(call) if worded is None else worded(call)


def _by_address(call: Call) -> Said:
    method, path = call.key
    verbs = {"POST": "do", "PUT": "set", "PATCH": "change", "DELETE": "end"}
    parts = [part for part in path.split("/") if part != "{}"]
    last = (parts or [""])[-1].replace("-", " ")
    verb = "start" if method == "POST" and call.axis is not None else verbs.get(method, method.lower())
    return Said(f"{verb} {last}", " ".join(call.names[1 + (call.axis is not None) :]), detail=compact(call.body))


def compact(body: Any) -> str:
    """What was asked for, in short."""
    if not body:
        return ""
    text = json.dumps(body, ensure_ascii=False, separators=(", ", ": "), default=str)
    text = text.replace('"', "").removeprefix("{").removesuffix("}")
    return text if len(text) <= TEXT_MAX else text[: TEXT_MAX - 1] + "…"


def value_of(given: Any) -> Value:
    """A number or a text as an entry can hold it; anything else in short."""
    if isinstance(given, bool):
        return int(given)
    if isinstance(given, int | str):
        return given if isinstance(given, int) or len(given) <= TEXT_MAX else given[:TEXT_MAX]
    if isinstance(given, float):
        return given if math.isfinite(given) else None
    return None if given is None else compact(given)


# --- each call that has words of its own -------------------------------------------------------


def _write(call: Call) -> Said:
    fields = call.body.get("fields")
    detail = compact(fields) if isinstance(fields, dict) else ""
    return Said("write", call.names[1], new=value_of(call.body.get("value")), detail=detail)


def _batch(call: Call) -> Said:
    writes = call.body.get("writes")
    done = call.answer.get("done") if isinstance(call.answer, dict) else None
    at = len(done) if isinstance(done, list) else 0
    item = writes[at] if isinstance(writes, list) and at < len(writes) and isinstance(writes[at], dict) else {}
    axis = item.get("axis")
    return Said(
        "write",
        str(item.get("name", "registers")),
        new=value_of(item.get("value")),
        detail=compact(item.get("fields")),
        axis=axis if isinstance(axis, int) else None,
    )


def _move(call: Call) -> Said:
    return _moved(call.answer) or Said(
        "move",
        "by" if call.body.get("relative") else "to",
        new=value_of(call.body.get("target")),
        detail=str(call.body.get("unit", "microsteps")),
    )


def _moved(started: Any) -> Said | None:
    if not isinstance(started, dict) or "target_position" not in started:
        return None
    ends = value_of(started.get("from_position")), value_of(started["target_position"])
    return Said("move", "position", *ends, detail="microsteps", axis=started.get("axis"))


def _moves(call: Call) -> Said:
    each = [said for started in call.answer if (said := _moved(started))] if isinstance(call.answer, list) else []
    if not each:
        return Said("move", "several axes", detail=compact(call.body.get("moves")))
    first, *others = each
    return Said(first.action, first.subject, first.old, first.new, first.detail, None, first.axis, tuple(others))


def _rotate(call: Call) -> Said:
    unit = str(call.body.get("unit", "pps"))
    held = call.body.get("hold_s")
    return Said("rotate", "velocity", new=value_of(call.body.get("velocity")), detail=f"{unit}, held" if held else unit)


def _named(action: str) -> Callable[[Call], Said]:
    """Something with a name in its body, or else one in its address."""

    def worded(call: Call) -> Said:
        name = call.body.get("name")
        rest = {key: value for key, value in call.body.items() if key not in ("name", "document", "link", "axes")}
        subject = call.names[-1] if call.names else str(name or "")
        new = value_of(name) if call.names and name else None
        return Said(action, subject, new=new, detail=compact(rest))

    return worded


def _add_device(call: Call) -> Said:
    body, answer = call.body, call.answer if isinstance(call.answer, dict) else {}
    link = body.get("link")
    kind = link.get("kind", "") if isinstance(link, dict) else ""
    device = answer.get("id")
    detail = f"{body.get('model', '')}, {kind}"
    return Said(
        "add device", str(body.get("name", "")), detail=detail, device=device if isinstance(device, str) else None
    )


def _plain(action: str, *keys: str) -> Callable[[Call], Said]:
    """An action without a subject; `keys` of the body are told."""
    return lambda call: Said(action, detail=compact({key: call.body[key] for key in keys if key in call.body}))


def _exchange(call: Call) -> Said:
    return Said("raw frame", str(call.body.get("frame", "")))


def _tmcl(call: Call) -> Said:
    text = call.answer.get("text") if isinstance(call.answer, dict) else None
    return Said("TMCL", str(text or compact(call.body)))


WORDS: Mapping[tuple[str, str], Callable[[Call], Said]] = {
    ("PUT", "devices/{}/registers/{}"): _write,
    ("POST", "devices/{}/registers"): _batch,
    ("POST", "devices/{}/registers/{}/store"): lambda call: Said("store", call.names[1]),
    ("POST", "devices/{}/registers/{}/restore"): lambda call: Said("restore", call.names[1]),
    ("POST", "devices/{}/start-up"): lambda call: Said("start up", detail=compact(call.body)),
    ("POST", "devices/{}/axes/{}/start-up"): lambda call: Said("start up", detail=compact(call.body)),
    ("POST", "devices/{}/exchange"): _exchange,
    ("POST", "devices/{}/tmcl"): _tmcl,
    ("PUT", "devices/{}/microstep-table"): lambda _: Said("write table", "microstep table"),
    ("PUT", "devices/{}/driver-chain"): lambda call: Said("write table", "driver chain", detail=compact(call.body)),
    ("PUT", "devices/{}/profile"): lambda call: Said("apply profile", str(call.body.get("name", ""))),
    ("POST", "devices/{}/profile/apply/way-back"): lambda _: Said("take profile back"),
    ("DELETE", "devices/{}/profile/apply"): lambda _: Said("forget half a profile"),
    ("POST", "devices/{}/axes/{}/move"): _move,
    ("POST", "devices/{}/move"): _moves,
    ("POST", "devices/{}/axes/{}/rotate"): _rotate,
    ("POST", "devices/{}/axes/{}/stop"): _plain("stop", "mode"),
    ("POST", "stop"): _plain("stop everything", "mode"),
    ("POST", "tokens"): _named("add token"),
    ("DELETE", "tokens/{}"): _named("revoke token"),
    ("POST", "access/log-out"): lambda _: Said("log out"),
    ("POST", "devices"): _add_device,
    ("PATCH", "devices/{}"): lambda call: Said("edit device", ", ".join(call.body), detail=compact(call.body)),
    ("DELETE", "devices/{}"): _plain("remove device"),
    ("POST", "devices/{}/connect"): _plain("connect"),
    ("POST", "devices/{}/disconnect"): _plain("disconnect"),
    ("POST", "recordings"): _named("start recording"),
    ("PATCH", "recordings/{}"): _named("edit recording"),
    ("POST", "recordings/{}/stop"): _named("stop recording"),
    ("POST", "recordings/{}/marks"): _named("mark recording"),
    ("POST", "recordings/{}/replay"): _named("replay recording"),
    ("DELETE", "recordings/{}"): _named("delete recording"),
    ("POST", "profiles"): _named("save profile"),
    ("PATCH", "profiles/{}"): _named("edit profile"),
    ("DELETE", "profiles/{}"): _named("delete profile"),
}
