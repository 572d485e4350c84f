"""What calls from outside are in the audit log's words, whether or not they got anywhere. Routes declare theirs.

A call that nobody has described here is entered all the same, in words made of its address: forgetting one hides
nothing. Not entered is what changes nothing, and what drivers and the lease tell of better: their own events.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Container
from itertools import zip_longest
from typing import Any
from urllib.parse import parse_qsl

from ...number_text import plain as plain_number
from ...store.audit_entries import Value
from ..policy import Call, Policy, Said

TEXT_MAX = 200
NAMED = ("recordings", "profiles", "tokens", "register-maps", "studies", "wiring", "motors", "layouts", "macros")
"""Below these in an address is the name of one."""


def taken_apart(method: str, path: str, query: bytes, plain: Container[tuple[str, str]]) -> Call:
    """`path` is below the API's base, without a slash in front; `plain` are calls whose address names nothing."""
    parts = [part for part in path.split("/") if part]
    names: list[str] = []
    device, axis = None, None
    if (method, path) in plain:
        pass  # "compare" is no recording's name
    elif parts[:1] == ["devices"] and len(parts) > 1:
        device = _name(parts, 1, names)
        if parts[2:3] == ["axes"] and len(parts) > 3:
            number = _name(parts, 3, names)
            axis = int(number) if re.fullmatch("[0-9]{1,2}", number) else None
        elif parts[2:3] == ["registers"] and len(parts) > 3:
            _name(parts, 3, names)
    elif len(parts) > 1 and parts[0] in NAMED:
        _name(parts, 1, names)
    asked = dict(parse_qsl(query.decode("latin-1"), keep_blank_values=True))
    if axis is None and re.fullmatch("[0-9]{1,2}", asked.get("axis", "")):
        axis = int(asked["axis"])
    return Call((method, "/".join(parts)), tuple(names), asked, {}, None, device, axis)


def _name(parts: list[str], at: int, names: list[str]) -> str:
    name, parts[at] = parts[at], "{}"
    names.append(name)
    return name


def is_silent(policy: Policy, call: Call) -> bool:
    """Whether nothing is entered for it, whatever comes of it."""
    return policy.audit == "silent" or (policy.audit == "silent as a dry run" and call.query.get("dry_run") == "true")


def in_words(policy: Policy, call: Call) -> Said:
    """The entry of a call; what it asked for, or what came of it where `answer` tells."""
    return _by_address(call) if policy.words is None else policy.words(call)


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


def write(call: Call) -> Said:
    fields = call.body.get("fields")
    detail = compact(fields) if isinstance(fields, dict) else ""
    return Said("write", call.names[1], new=value_of(call.body.get("value")), detail=detail)


def batch(call: Call) -> Said:
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


def move(call: Call) -> Said:
    return _moved(call.answer, call.body) or Said(
        "move",
        "by" if call.body.get("relative") else "to",
        new=value_of(call.body.get("target")),
        detail=str(call.body.get("unit", "microsteps")),
    )


def _moved(started: Any, asked: Any = None) -> Said | None:
    if not isinstance(started, dict) or "target_position" not in started:
        return None
    ends = value_of(started.get("from_position")), value_of(started["target_position"])
    takes_s = started.get("predicted_duration_s")
    detail = "microsteps" if takes_s is None else f"microsteps, in {plain_number(takes_s, 4)} s"
    if isinstance(asked, dict) and (asked.get("relative") or asked.get("unit", "microsteps") != "microsteps"):
        way, unit = "by" if asked.get("relative") else "to", asked.get("unit", "microsteps")
        detail += f", asked {way} {asked.get('target')!r} {unit}"
    return Said("move", "position", *ends, detail=detail, axis=started.get("axis"))


def moves(call: Call) -> Said:
    asked = call.body.get("moves")
    wanted = asked if isinstance(asked, list) else []
    answers = call.answer if isinstance(call.answer, list) else []
    each = [said for started, one in zip_longest(answers, wanted) if (said := _moved(started, one))]
    if not each:
        return Said("move", "several axes", detail=compact(call.body.get("moves")))
    first, *others = each
    return Said(first.action, first.subject, first.old, first.new, first.detail, None, first.axis, tuple(others))


def start_together(call: Call) -> Said:
    """Each axis of its device, by how it started."""
    axes = call.answer.get("axes") if isinstance(call.answer, dict) else None
    if not isinstance(axes, list) or not axes:
        return Said("start together", "several devices", detail=compact(call.body.get("moves")))
    first, *others = [
        Said(
            "move together",
            "to",
            value_of(axis.get("from_position")),
            value_of(axis.get("target_position")),
            f"by {axis.get('how')}",
            axis.get("device"),
            axis.get("axis"),
        )
        for axis in axes
    ]
    return Said(
        first.action, first.subject, first.old, first.new, first.detail, first.device, first.axis, tuple(others)
    )


def rotate(call: Call) -> Said:
    unit = str(call.body.get("unit", "pps"))
    held = call.body.get("hold_s")
    return Said("rotate", "velocity", new=value_of(call.body.get("velocity")), detail=f"{unit}, held" if held else unit)


def named(action: str) -> Callable[[Call], Said]:
    """Something with a name in its body, or else one in its address."""

    def worded(call: Call) -> Said:
        name = call.body.get("name")
        rest = {
            key: value for key, value in call.body.items() if key not in ("name", "document", "link", "axes", "text")
        }
        subject = call.names[-1] if call.names else str(name or "")
        new = value_of(name) if call.names and name else None
        return Said(action, subject, new=new, detail=compact(rest))

    return worded


def add_device(call: Call) -> Said:
    body, answer = call.body, call.answer if isinstance(call.answer, dict) else {}
    link = body.get("link")
    kind = link.get("kind", "") if isinstance(link, dict) else ""
    device = answer.get("id")
    detail = f"{body.get('model', '')}, {kind}"
    return Said(
        "add device", str(body.get("name", "")), detail=detail, device=device if isinstance(device, str) else None
    )


def plain(action: str, *keys: str) -> Callable[[Call], Said]:
    """An action without a subject; `keys` of the body are told."""
    return lambda call: Said(action, detail=compact({key: call.body[key] for key in keys if key in call.body}))


def exchange(call: Call) -> Said:
    return Said("raw frame", str(call.body.get("frame", "")))


def tmcl(call: Call) -> Said:
    text = call.answer.get("text") if isinstance(call.answer, dict) else None
    return Said("TMCL", str(text or compact(call.body)))


def done(action: str, subject: str = "") -> Callable[[Call], Said]:
    """An action that is told the same whatever was asked."""
    return lambda _: Said(action, subject)


def with_body(action: str, subject: str = "") -> Callable[[Call], Said]:
    """An action, and all that was asked for."""
    return lambda call: Said(action, subject, detail=compact(call.body))


def of_register(action: str) -> Callable[[Call], Said]:
    """What happens to the register that is named in the address."""
    return lambda call: Said(action, call.names[1])


def edit_device(call: Call) -> Said:
    """Of a connection; each setting that is another one then has an entry of its own."""
    return Said("edit device", ", ".join(call.body), detail=compact(call.body))


def apply_profile(call: Call) -> Said:
    """By the profile's name, and with the program that was stored, which no register tells."""
    commands = call.answer.get("stored_commands") if isinstance(call.answer, dict) else None
    stored = "" if commands is None else f"a program of {commands} commands is stored"
    return Said("apply profile", str(call.body.get("name", "")), detail=stored)


def undo(call: Call) -> Said:
    """By what the device was put back to."""
    for aim in ("since", "before", "without"):
        if aim in call.body:
            return Said("undo", f"{aim} {'entry ' if aim != 'since' else ''}{call.body[aim]}")
    return Said("undo")


def tried_dry(call: Call) -> bool:
    """Whether a start-up was only planned."""
    return isinstance(call.answer, dict) and call.answer.get("state") == "dry run"


def read_only(call: Call) -> bool:
    """Whether a raw frame has only read, as far as its answer tells."""
    decoded = call.answer.get("decoded") if isinstance(call.answer, dict) else None
    return isinstance(decoded, dict) and decoded.get("rw") == "read"


def run_macro(call: Call) -> Said:
    """By the macro's name, with its revision."""
    state = call.answer if isinstance(call.answer, dict) else {}
    document = call.body.get("document")
    name = state.get("name") or call.body.get("macro") or (document.get("name") if isinstance(document, dict) else "")
    revision = state.get("revision")
    return Said("run macro", str(name or ""), detail=f"revision {revision}" if revision else "")
