"""Shapes of profiles: differences, what came of applying one, and those that are kept."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, JsonValue, StringConstraints, model_validator

from ...profiles.diff import Diff, Difference
from ...profiles.document import NAME_MAX, NOTE_MAX, ProfileDocument
from ..schemas import Answer, Body

ProfileName = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=NAME_MAX, strip_whitespace=True)]
ProfileNote = Annotated[str, StringConstraints(strict=True, max_length=NOTE_MAX)]
EXAMPLE: dict[str, JsonValue] = {
    "format": "stepscope-profile",
    "version": 1,
    "name": "quiet",
    "model": "tmc428",
    "clock_hz": 16_000_000,
    "registers": [
        {"name": "v_max", "axis": 0, "value": 1200},
        {"name": "pmul_pdiv", "axis": 0, "fields": {"pmul": 100, "pdiv": 4}},
    ],
}
"""A short profile: what it does not speak of stays as the device has it."""


class ProfileIn(ProfileDocument):
    """A profile as a request brings it: its format and version have to be there, so that nobody guesses."""

    model_config = ConfigDict(json_schema_extra={"examples": [EXAMPLE]})

    @model_validator(mode="before")
    @classmethod
    def _says_what_it_is(cls, data: object) -> object:
        if isinstance(data, dict):
            for key in ("format", "version"):
                if key not in data:
                    raise ValueError(f'{key} is missing: a profile begins with "format" and "version"')
        return data


class RegisterChange(Answer):
    """A register: what it was, is and was to be; null where nobody knows."""

    name: str
    axis: int | None
    table: str | None = Field(description="the table that it is a word of")
    was: int | None
    now: int | None
    wanted: int
    why: str = ""


class ProfileApplied(Diff):
    """What differs, and what was done about it. A dry run does nothing."""

    state: Literal["dry run", "applied", "unchanged"]
    written: list[RegisterChange] = Field(description="registers that were written and read back, in their order")
    prepared: list[str] = Field(description="what was done before, so that nothing moves; it stays")
    stored_commands: int | None = Field(
        default=None, description="how long the program is that was stored and read back; null where none was"
    )
    settings: list[Difference] = Field(description="mechanics and limits that were changed with them")
    took_s: float | None = None


class HalfApplied(RegisterChange):
    """A register of a transaction that did not come to its end."""

    state: Literal["written", "perhaps written", "not begun", "left"] = Field(
        description='how far it got; "left": the rollback did not bring it back'
    )


class UnfinishedProfile(Answer):
    """A profile that was half applied when the server ended, or whose rollback failed."""

    profile: str
    model: str
    started_unix_s: float
    by: str
    crashed: bool = Field(description="whether the server ended in the middle; else the rollback failed")
    registers: list[HalfApplied]


class ApplyProgress(Answer):
    """What is under way with a device's profile."""

    state: Literal["idle", "running", "unfinished"]
    phase: Literal["comparing", "writing", "checking", "way back", "over"] | None = None
    done: int = 0
    total: int = 0
    register_name: str = Field(default="", description="what is being written")
    unfinished: UnfinishedProfile | None = None


class TakenBack(Answer):
    """What an unfinished transaction had written, and what is as before now."""

    registers: list[RegisterChange]


# --- kept ones --------------------------------------------------------------------------------------


class ProfileSave(Body):
    """Either a document, or a device whose configuration is captured now."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"document": EXAMPLE}]})

    document: ProfileIn | None = None
    device: Annotated[str, StringConstraints(max_length=200)] | None = Field(default=None, description="its id")
    name: ProfileName | None = Field(default=None, description="by default as the document, or the device, is called")
    note: ProfileNote | None = None

    @model_validator(mode="after")
    def _one_of_them(self) -> ProfileSave:
        if (self.document is None) == (self.device is None):
            raise ValueError("give either a document or a device")
        return self


class ProfileLabel(Body):
    """Another name or note; null leaves as it is."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"name": "quiet"}]})

    name: ProfileName | None = None
    note: ProfileNote | None = None


class ProfileInfo(Answer):
    """A kept profile without its document."""

    id: int
    name: str
    model: str
    title: str = Field(description="of the model, for people")
    device: str = Field(description="name of the device that it was taken from")
    note: str
    created_unix_s: float
    version: int
    registers: int = Field(description="registers, parameters and table words that it speaks of")


class TriedParameter(Answer):
    name: str
    axis: int | None


class TriedWrites(Answer):
    """What a device took of what it holds."""

    settable: int = Field(description="parameters of which it is known that they can be set: those a profile has")
    refused: list[TriedParameter] = Field(description="what it lacks, does not let be written, or changes by itself")


class ProfileDetail(ProfileInfo):
    """A kept profile."""

    document: ProfileDocument


class ProfileList(Answer):
    profiles: list[ProfileInfo]


class ProfilePair(Body):
    """Two profiles, each as a document or as the id of a kept one."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"left": EXAMPLE, "right": EXAMPLE}]})

    left: ProfileIn | Annotated[int, Field(strict=True, ge=1)]
    right: ProfileIn | Annotated[int, Field(strict=True, ge=1)]
