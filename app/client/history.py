"""Calls about a device's history and undo, as values."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from typing import Any, TypeAlias
from urllib.parse import quote

from .calls import BASE, Call
from .records import Json

Place: TypeAlias = "str | tuple[str, int | None]"
"""A register: its name, of an axis with its number."""


def history(device: str, limit: int, before: int | None) -> Call[Json]:
    query: dict[str, str | int | list[str]] = {"limit": limit, **({} if before is None else {"before": before})}
    return Call("GET", f"{_of(device)}/history", _as_it_is, query=query)


def undo(
    device: str,
    since: datetime | None,
    before: int | None,
    without: int | None,
    registers: Sequence[Place] | None,
    seen: int | None,
    *,
    dry_run: bool,
) -> Call[Json]:
    body: Json = {
        "since": None if since is None else since.astimezone().isoformat(),
        "before": before,
        "without": without,
        "registers": None if registers is None else [_place(each) for each in registers],
        "seen": seen,
    }
    given = {name: value for name, value in body.items() if value is not None}
    return Call("POST", f"{_of(device)}/undo", _as_it_is, given, {"dry_run": "true"} if dry_run else {})


def _place(given: Place) -> Json:
    name, axis = (given, None) if isinstance(given, str) else given
    return {"name": name, "axis": axis}


def _of(device: str) -> str:
    return f"{BASE}/devices/{quote(device, safe='')}"


def _as_it_is(answer: Any) -> Any:
    return answer
