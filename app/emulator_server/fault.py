"""`stepscope fault`: one change to an emulator that runs elsewhere, asked for by a name and a word."""

from __future__ import annotations

import http.client
import json
import re
import types
import urllib.error
import urllib.request
from collections.abc import Iterable, Iterator
from typing import Union, get_args, get_origin
from urllib.parse import urlsplit

from pydantic import BaseModel

from ..emulators.line.faults import LinePatch
from ..errors import LinkDown, LinkError, LinkTimeout, UnknownThing, UsageError

TIMEOUT_S = 10.0
WORDS: dict[str, object] = {"on": True, "true": True, "yes": True, "off": False, "false": False, "no": False}


def change(
    url: str, name: str, value: str, *, address: int | None = None, line: bool = False
) -> tuple[str, dict[str, object]]:
    """Set `name` to `value` in the emulator behind `url`; the whole name, and the emulator's state afterwards.

    `url` is the control port of `stepscope emulate` (then `address` picks the module, `line` the line
    itself), or the address of an emulator in a running dashboard: `.../api/v1/devices/NAME/emulator`.
    `name` is a field of the patch, alone (`silence`) or with its path (`faults.silence`).

    Raises UnknownThing for a name that there is not, LinkDown or LinkTimeout where nobody answers, and
    UsageError with the emulator's words where it refuses.
    """
    target = _target(url, address, line=line)
    path = path_of(LinePatch, name) if line else _path_at(target, name)
    body: object = _value(value)
    for part in reversed(path.split(".")):
        body = {part: body}
    return path, _ask(target, json.dumps(body).encode())


def _path_at(target: str, name: str) -> str:
    """What `name` means to the emulator behind `target`, which tells what it is."""
    try:
        model = str(_ask(target).get("model"))
    except LinkError:
        _require_known(name)  # a name that no emulator has is told first
        raise
    # They bring what they need to be computed, which a wrong address need not wait for.
    from ..emulators.board import options as board
    from ..emulators.build import family_of
    from ..registers.catalog import is_model

    if model == board.MODEL:
        return path_of(board.BoardPatch, name)
    if not is_model(model):
        raise LinkError(urlsplit(target).netloc, "does not answer like an emulator")
    return path_of(family_of(model).patch, name)


def _require_known(name: str) -> None:
    """Raises UnknownThing for a fault that no family of emulators has."""
    from ..emulators.families import FAMILIES

    paths = {path for family in FAMILIES for path in names_of(family.patch)}
    if name not in paths and not any(path.endswith(f".{name}") for path in paths):
        raise _unknown(name, paths)


def names_of(model: type[BaseModel]) -> list[str]:
    """The dotted path of every plain field of `model` and of the models in it."""
    return list(_walk(model, ""))


def path_of(model: type[BaseModel], name: str) -> str:
    """The dotted path that `name` means: of several that end in it the shortest.

    Raises UnknownThing; UsageError where several are the shortest.
    """
    known = names_of(model)
    if name in known:
        return name
    fitting = [path for path in known if path.endswith(f".{name}")]
    least = min((path.count(".") for path in fitting), default=0)
    fitting = [path for path in fitting if path.count(".") == least]
    if len(fitting) > 1:
        raise UsageError(f"{name!r} may be {' or '.join(fitting)}")
    if not fitting:
        raise _unknown(name, known)
    return fitting[0]


def _unknown(name: str, known: Iterable[str]) -> UnknownThing:
    return UnknownThing("fault", name, sorted(known, key=lambda path: (not path.startswith("faults."), path)))


def _walk(model: type[BaseModel], prefix: str) -> Iterator[str]:
    for name, field in model.model_fields.items():
        inner = _model_in(field.annotation)
        if inner is None:
            yield prefix + name
        else:
            yield from _walk(inner, f"{prefix}{name}.")


def _model_in(annotation: object) -> type[BaseModel] | None:
    """The model of a field that may be one: `Model` or `Model | None`."""
    choices = get_args(annotation) if get_origin(annotation) in (Union, types.UnionType) else (annotation,)
    for choice in choices:
        if isinstance(choice, type) and issubclass(choice, BaseModel):
            return choice
    return None


def _value(text: str) -> object:
    """A word as the JSON that it stands for: on and off, a number, else itself (`auto`)."""
    if text.casefold() in WORDS:
        return WORDS[text.casefold()]
    if re.fullmatch(r"[+-]?\d+", text):
        return int(text)
    try:
        number = float(text)
    except ValueError:
        return text
    if number != number or number in (float("inf"), float("-inf")):
        raise UsageError(f"{text!r} is no number that can be set")
    return number


def _target(url: str, address: int | None, *, line: bool) -> str:
    if "://" not in url:
        url = f"http://{url}"
    try:
        parts = urlsplit(url)
        fits = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0
    except ValueError:
        fits = False
    if not fits:
        raise UsageError(f"{url!r} is no address like http://127.0.0.1:9000")
    if parts.path.strip("/"):
        return url
    if line:
        return f"{url.rstrip('/')}/line"
    return f"{url.rstrip('/')}/emulator" + (f"/{address}" if address is not None else "")


def _ask(url: str, body: bytes | None = None) -> dict[str, object]:
    """The state of the emulator; with a `body` that of a PATCH."""
    request = urllib.request.Request(
        url, body, {"Content-Type": "application/json"}, method="GET" if body is None else "PATCH"
    )
    where = urlsplit(url).netloc
    try:
        # Loopback, mostly, and never through a proxy that the environment names for the web.
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        with opener.open(request, timeout=TIMEOUT_S) as answer:
            state = json.loads(answer.read())
    except urllib.error.HTTPError as error:
        with error:
            raise UsageError(f"{where} refuses: {_detail(error)}") from None
    except TimeoutError as error:
        raise LinkTimeout(where, TIMEOUT_S, "the change") from error
    except urllib.error.URLError as error:
        if isinstance(error.reason, TimeoutError):
            raise LinkTimeout(where, TIMEOUT_S, "the change") from error
        reason = getattr(error.reason, "strerror", None) or error.reason
        raise LinkDown(where, f"{reason}; is `stepscope emulate ... --control {where}` running?") from error
    except (OSError, http.client.HTTPException, ValueError) as error:
        raise LinkError(where, f"does not answer like an emulator: {error}") from error
    if not isinstance(state, dict):
        raise LinkError(where, "does not answer like an emulator")
    return state


def _detail(error: urllib.error.HTTPError) -> str:
    """What a problem document says, or the status line of anything else."""
    try:
        problem = json.loads(error.read())
        return str(problem.get("detail") or problem["title"])
    except (ValueError, AttributeError, KeyError, TypeError, OSError):
        return f"{error.code} {error.reason}"
