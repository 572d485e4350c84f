"""Calls about profiles, as values, and the record of a kept one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

from .calls import BASE, Call
from .records import Json, record

APPLY_TIMEOUT_S = 300.0
"""Hundreds of parameters over a slow wire, each written and read back, and then perhaps written back [s]."""


@dataclass(frozen=True, slots=True)
class SavedProfile:
    """A kept profile without its document."""

    id: int
    name: str
    model: str
    device: str
    """Name of the device that it was taken from."""
    note: str
    created_unix_s: float
    registers: int
    """Registers, parameters and table words that it speaks of."""


def capture(device: str) -> Call[Json]:
    return Call("GET", _of(device), _as_it_is)


def apply(device: str, document: Json, *, dry_run: bool, limits: bool) -> Call[Json]:
    query = {name: "true" for name, wanted in (("dry_run", dry_run), ("limits", limits)) if wanted}
    return Call("PUT", _of(device), _as_it_is, document, query)


def progress(device: str) -> Call[Json]:
    return Call("GET", f"{_of(device)}/apply", _as_it_is)


def way_back(device: str) -> Call[Json]:
    return Call("POST", f"{_of(device)}/apply/way-back", _as_it_is)


def forget(device: str) -> Call[None]:
    return Call("DELETE", f"{_of(device)}/apply", _nothing)


def kept(search: str, model: str) -> Call[list[SavedProfile]]:
    query = {name: text for name, text in (("search", search), ("model", model)) if text}
    return Call("GET", f"{BASE}/profiles", lambda answer: [_saved(each) for each in answer["profiles"]], query=query)


def get(profile: int) -> Call[Json]:
    return Call("GET", f"{BASE}/profiles/{profile}", lambda answer: dict(answer["document"]))


def save(document: Json | None, device: str | None, name: str | None, note: str | None) -> Call[SavedProfile]:
    body = {"document": document, "device": device, "name": name, "note": note}
    return Call("POST", f"{BASE}/profiles", _saved, {key: value for key, value in body.items() if value is not None})


def edit(profile: int, name: str | None, note: str | None) -> Call[SavedProfile]:
    return Call("PATCH", f"{BASE}/profiles/{profile}", _saved, {"name": name, "note": note})


def delete(profile: int) -> Call[None]:
    return Call("DELETE", f"{BASE}/profiles/{profile}", _nothing)


def compare(left: Json | int, right: Json | int) -> Call[Json]:
    return Call("POST", f"{BASE}/profiles/compare", _as_it_is, {"left": left, "right": right})


def _of(device: str) -> str:
    return f"{BASE}/devices/{quote(device, safe='')}/profile"


def _saved(answer: Json) -> SavedProfile:
    return record(SavedProfile, answer)


def _as_it_is(answer: Any) -> Any:
    return answer


def _nothing(answer: Any) -> None:
    del answer
