"""Calls about profiles as scripts, as values, and the record of one."""

from __future__ import annotations

from dataclasses import dataclass

from .calls import BASE, Call
from .records import Json, record

SCRIPT_TIMEOUT_S = 300.0
"""A script is run on an emulator before it is answered, and others may stand in line for that [s]."""


@dataclass(frozen=True, slots=True)
class Script:
    """A profile as a program, which was tried on an emulator."""

    language: str
    text: str
    file_name: str
    checked: Json
    """What the trial showed: `model`, `registers`, `took_s`, and `how` it was tried."""


def script(profile: Json | int, language: str) -> Call[Script]:
    """Of a kept profile by its number, or of a document."""
    if isinstance(profile, int):
        return Call("GET", f"{BASE}/profiles/{profile}/script", _script, query={"language": language})
    return Call("POST", f"{BASE}/profiles/script", _script, {"document": profile, "language": language})


def _script(answer: Json) -> Script:
    return record(Script, answer)
