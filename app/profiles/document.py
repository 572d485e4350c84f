"""A profile as a document: what stands in a file, in the database, and in the answers of the API.

People read it, edit it and compare two of them with any tool: numbers as they are written on the register page, sorted
as the data sheet has them, one register a line (`text_of`). A key that is not known is an error, for it may be a typing
mistake; so is another version. What is there for readers alone (`unit`, `meaning`) is not looked at.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Annotated, Any, Final, Literal

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    StringConstraints,
    ValidationError,
    WithJsonSchema,
    model_validator,
)

from ..deferred import DeferredModel
from ..registers.catalog import MODELS
from ..registers.names import ListedName
from .errors import UnreadableProfile

FORMAT: Final = "stepscope-profile"
VERSION: Final = 1
NAME_MAX, NOTE_MAX = 100, 10_000


def _from_hex(given: object) -> object:
    if isinstance(given, str) and given[:2].lower() == "0x":
        try:
            return int(given, 16)
        except ValueError:
            return given
    return given


Int = Annotated[int, Field(strict=True)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[float, Field(strict=True, gt=0, le=1e12, allow_inf_nan=False)]
Index = Annotated[int, Field(strict=True, ge=0, le=31)]
Word = Annotated[
    int,
    BeforeValidator(_from_hex),
    Field(strict=True, ge=0, le=0xFFFF_FFFF),
    PlainSerializer(lambda word: f"0x{word:08X}", when_used="json"),
    WithJsonSchema({"type": "string", "pattern": "^0x[0-9a-fA-F]{1,8}$", "examples": ["0xAAAAB554"]}),
]
"""A pattern of bits: written as "0xAAAAB554", read as a number too."""
Text = Annotated[str, StringConstraints(strict=True, max_length=200)]
Cell = Annotated[int, Field(strict=True, ge=0, le=63)]


AXES_MAX = 16
"""Of a document: twice as many as any module that is known."""


class Part(DeferredModel):
    """What a document is made of: an unknown key is an error, not a silence."""

    model_config = ConfigDict(extra="forbid", json_schema_serialization_defaults_required=True)


class Limits(Part):
    """Soft limits of an axis, as in POST /devices; null for none."""

    position_min: Int | None = Field(default=None, description="[microsteps]")
    position_max: Int | None = Field(default=None, description="[microsteps]")
    velocity_max_pps: Positive | None = None
    acceleration_max_pps2: Positive | None = None
    current_max_a: Positive | None = Field(default=None, description="of a coil, RMS [A]")
    sense_resistor_ohm: Positive | None = None
    current_full_scale_a: Positive | None = None


class AxisPart(Part):
    """The motor on an axis and what it moves, as in POST /devices."""

    name: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=60)]
    full_steps_per_rev: Annotated[int, Field(strict=True, ge=1, le=100_000)]
    driver_microsteps: Annotated[int, Field(strict=True, ge=1, le=256)] = Field(
        default=16, description="of a step/direction driver; chips with a driver of their own know theirs"
    )
    gear_ratio: Annotated[float, Field(strict=True, gt=0, le=1e6, allow_inf_nan=False)] = 1.0
    travel_mm_per_rev: Annotated[float, Field(strict=True, gt=0, le=1e6, allow_inf_nan=False)] | None = None
    limits: Limits | None = Field(default=None, description="null where the profile does not speak of them")


class RegisterPart(Part):
    """A register of a chip.

    One with fields has them all, but for those that are state; `value` is the whole number. Whoever edits one of them
    leaves the other out, or changes both.
    """

    name: Text
    axis: Index | None = None
    value: Int | None = Field(default=None, description="the whole register, signed where it is")
    fields: dict[str, Int | Text] | None = Field(
        default=None, description="by name; values with names of their own may be written by these"
    )
    unit: Text = Field(default="", description="for readers: what `value` counts in")


class ParameterPart(Part):
    """A parameter of a TMCL module."""

    name: Text
    alias: Text = Field(default="", description="its kind and number, e.g. ap4: for readers, and checked")
    axis: Index | None = Field(default=None, description="of a module with several axes")
    value: Int
    unit: Text = Field(default="", description="for readers: what `value` counts in")
    meaning: Text = Field(default="", description="for readers: what the value stands for")


class MslutPart(Part):
    """A microstep table of one-bit differences, as its registers."""

    axis: Index | None = Field(default=None, description="null where all axes share it")
    words: Annotated[list[Word], Field(min_length=8, max_length=8)]
    select: Word
    start: Word


class Tables(Part):
    """What lies in tables rather than in registers; null where the chip has none, or the profile is silent."""

    microstep: Annotated[list[Cell], Field(min_length=64, max_length=64)] | None = Field(
        default=None, description="TMC428: the quarter wave"
    )
    driver_chain: Annotated[list[Word], Field(min_length=32, max_length=32)] | None = Field(
        default=None, description="TMC428: the chain's RAM, two cells of 6 bits a word"
    )
    mslut: Annotated[list[MslutPart], Field(max_length=2)] | None = None
    user_variables: dict[Annotated[int, Field(ge=0, le=255)], Int] | None = Field(
        default=None, description="PD42-1241: by number; those that are not listed are 0"
    )


SourceLine = Annotated[str, StringConstraints(strict=True, max_length=1000)]
FileText = Annotated[str, StringConstraints(strict=True, max_length=200_000)]
FileName = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=120)]


class ProgramPart(Part):
    """The program of a module, from address 0 of its memory on: as it was written, or as it was read back."""

    name: Text = Field(default="", description="for readers: what its file is called")
    source: Annotated[list[SourceLine], Field(max_length=20_000)] = Field(
        description="its text, line by line; it assembles to the commands that are stored. None: an empty memory"
    )
    files: Annotated[dict[FileName, FileText], Field(max_length=64)] = Field(
        default_factory=dict, description="files that it includes, by name"
    )


class UnknownPart(Part):
    """A register that cannot be read, and of which nobody knew what it holds."""

    name: Text
    axis: Index | None = None


class ProfileDocument(Part):
    """A device's whole configuration.

    Raises ValidationError for what is none; `parse` tells the place in words.
    """

    format: Literal["stepscope-profile"] = FORMAT
    version: Literal[1] = VERSION
    name: Annotated[str, StringConstraints(strict=True, max_length=NAME_MAX, strip_whitespace=True)] = ""
    note: Annotated[str, StringConstraints(strict=True, max_length=NOTE_MAX)] = ""
    model: ListedName
    clock_hz: Annotated[float, Field(strict=True, gt=0, le=1e9, allow_inf_nan=False)]
    device: Text = Field(default="", description="name of the device that it was taken from")
    firmware: Text = Field(default="", description="of a module")
    captured_unix_s: Number = 0.0
    axes: Annotated[list[AxisPart], Field(max_length=AXES_MAX)] = Field(default_factory=list)
    registers: Annotated[list[RegisterPart], Field(max_length=1000)] = Field(default_factory=list)
    parameters: Annotated[list[ParameterPart], Field(max_length=1000)] = Field(default_factory=list)
    tables: Tables = Field(default_factory=Tables)
    program: ProgramPart | None = Field(
        default=None, description="of a module that stores one; null where the profile does not speak of it"
    )
    unknown: Annotated[list[UnknownPart], Field(max_length=1000)] = Field(
        default_factory=list, description="what the profile says nothing of: it could not be read"
    )

    @model_validator(mode="before")
    @classmethod
    def _of_this_format(cls, data: Any) -> Any:
        """First of all whether it is one of ours: findings about its parts would only confuse."""
        if isinstance(data, dict):
            if data.get("format", FORMAT) != FORMAT:
                raise ValueError(f"this is no profile of stepscope: its format is {_shown(data['format'])}")
            version = data.get("version", VERSION)
            if isinstance(version, int) and version > VERSION:
                raise ValueError(f"it is of a newer stepscope: version {version}, known is {VERSION}")
        return data

    @property
    def title(self) -> str:
        """What it is, for people: "TMC5160"."""
        return MODELS[self.model].title


def parse(data: object) -> ProfileDocument:
    """A document of what was read from JSON. Raises UnreadableProfile, which names the first place that is wrong.

    `format` and `version` have to be there: what a file leaves out nobody may guess.
    """
    if not isinstance(data, dict):
        raise UnreadableProfile("", "a profile is a JSON object")
    for key in ("format", "version"):
        if key not in data:
            raise UnreadableProfile(key, f"it is missing: a profile begins with {json.dumps(key)}")
    try:
        return ProfileDocument.model_validate(data)
    except ValidationError as error:
        found = error.errors()
        more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
        raise UnreadableProfile(
            path_of(found[0]["loc"]), found[0]["msg"].removeprefix("Value error, ") + more
        ) from error


def path_of(location: tuple[int | str, ...]) -> str:
    """`registers[3].fields.pmul`."""
    text = ""
    for part in location:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def plain(document: ProfileDocument) -> dict[str, Any]:
    """As JSON has it, without what says nothing: empty texts of readers' parts, nulls of entries."""
    whole = document.model_dump(mode="json")
    for entry in whole["registers"]:
        for key in ("unit", "fields", "axis"):
            if not entry[key] and entry[key] != 0:
                del entry[key]
    for entry in whole["parameters"]:
        for key in ("alias", "unit", "meaning"):
            if not entry[key]:
                del entry[key]
    for entry in whole["axes"]:
        if entry["limits"] is not None:
            entry["limits"] = {name: limit for name, limit in entry["limits"].items() if limit is not None}
    whole["tables"] = {name: table for name, table in whole["tables"].items() if table is not None}
    if whole["program"] is None:
        del whole["program"]
    else:
        whole["program"] = {name: part for name, part in whole["program"].items() if part or name == "source"}
    return whole


def text_of(document: ProfileDocument) -> str:
    """The document as a file: one register a line, so that any tool shows what differs between two of them."""
    return "\n".join(_lines(plain(document))) + "\n"


def _lines(whole: dict[str, Any]) -> Iterator[str]:
    yield "{"
    last = list(whole)[-1]
    for key, value in whole.items():
        comma = "" if key == last else ","
        head = f"  {json.dumps(key)}: "
        if isinstance(value, list) and value:
            yield f"{head}["
            yield from (f"    {_json(entry)}{',' * (index < len(value) - 1)}" for index, entry in enumerate(value))
            yield f"  ]{comma}"
        elif isinstance(value, dict) and value:
            yield f"{head}{{"
            ends = list(value)[-1]
            for name, part in value.items():
                yield from _entry(name, part, last=name == ends)
            yield f"  }}{comma}"
        else:
            yield f"{head}{_json(value)}{comma}"
    yield "}"


def _entry(name: str, part: object, *, last: bool) -> Iterator[str]:
    """A part of an object on a line of its own; a text of several lines with as many."""
    comma = "" if last else ","
    if name != "source" or not isinstance(part, list) or not part:
        yield f"    {json.dumps(name)}: {_json(part)}{comma}"
        return
    yield f"    {json.dumps(name)}: ["
    yield from (f"      {_json(line)}{',' * (index < len(part) - 1)}" for index, line in enumerate(part))
    yield f"    ]{comma}"


def _json(value: object) -> str:
    return json.dumps(_short(value), ensure_ascii=False, allow_nan=False)


def _short(value: object) -> object:
    """Whole numbers without a decimal point."""
    if isinstance(value, dict):
        return {name: _short(part) for name, part in value.items()}
    if isinstance(value, list):
        return [_short(part) for part in value]
    return int(value) if isinstance(value, float) and value.is_integer() and abs(value) < 1e15 else value


def _shown(value: object) -> str:
    return json.dumps(value, default=str)[:60]
