"""Shapes of profiles as scripts."""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict, Field, JsonValue

from ..schemas import Answer, Body
from .schemas import ProfileIn

ScriptLanguage = Literal["python", "tmcl", "c", "curl"]


EXAMPLE: dict[str, JsonValue] = {
    "language": "tmcl",
    "document": {
        "format": "stepscope-profile",
        "version": 1,
        "name": "quiet",
        "model": "pd42-1241",
        "clock_hz": 16e6,
        "parameters": [{"name": "maximum_current", "value": 100}],
    },
}


class ScriptOrder(Body):
    """A script of a profile that need not be saved."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [EXAMPLE]})

    document: ProfileIn
    language: ScriptLanguage


class ScriptCheck(Answer):
    """What the trial on an emulator showed. A script whose trial failed is an error, not an answer."""

    model: str = Field(description="what was emulated")
    registers: int = Field(description="how many were written, and compared with the profile afterwards")
    took_s: float
    how: Literal["run", "sent", "compiled", "read"] = Field(
        description="run as a program against a server, or by the emulated module; sent command by command to one that "
        "has no memory for programs; compiled, and its frames sent; or read back by our own reader, where this machine "
        "has no compiler, shell or curl"
    )
    differences: list[str] = Field(description="always empty: a difference is the error of the call")


class ProfileScript(Answer):
    """A script that was tried, and left an emulator as the profile says."""

    language: ScriptLanguage
    text: str
    file_name: str
    checked: ScriptCheck
