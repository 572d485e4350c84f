"""Shapes of register maps."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints

from ...registers.maps.reader import BYTES_MAX
from ..schemas import Answer, Body


class RegisterMapText(Body):
    """A register map as its file has it."""

    text: Annotated[str, StringConstraints(strict=True, max_length=BYTES_MAX)] = Field(
        description="the file: docs/register-maps.md says what may stand in it"
    )
    format: Literal["toml", "csv"] = Field(default="toml", description="csv: a table, which becomes a map")


class MapFinding(Answer):
    """Something in a register map that cannot be."""

    line: int
    where: str = Field(description="of which register, field or key; empty where it is the file")
    what: str = Field(description="what is wrong, and what is allowed")


class RegisterMapInfo(Answer):
    """A file in the folder of register maps."""

    name: str = Field(description="of the file without its ending, and of the model")
    title: str = Field(description="empty where the file cannot be read")
    summary: str
    axes: int
    registers: int
    bytes: int
    findings: list[MapFinding] = Field(description="what is wrong with it; empty: it can be used")
    more: int = Field(default=0, description="mistakes beyond those that are told")
    behind: str = Field(
        default="", description="why its devices go by what the file said earlier; empty: they go by what it says"
    )
    devices: list[str] = Field(description="ids of the devices that are made of it")


class RegisterMapList(Answer):
    """The folder of register maps."""

    folder: str = Field(description="on the server: a file that is put there is found at the next look")
    maps: list[RegisterMapInfo]
    passed_over: list[str] = Field(description="files there that are no maps by their name, and why")


class RegisterMapFile(Answer):
    """A register map as its file has it."""

    name: str
    text: str
