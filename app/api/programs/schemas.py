"""Shapes of programs: their text, what is wrong with it, and what the device makes of them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints

from ..schemas import Answer, Body

TEXT_MAX = 500_000
FileName = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=120)]
ProgramText = Annotated[str, StringConstraints(strict=True, max_length=TEXT_MAX)]
Address = Annotated[int, Field(strict=True, ge=0, le=65_535)]


class ProgramSource(Body):
    """A program as it is written."""

    text: ProgramText = Field(description="one command a line; labels, constants and #include as in the maker's manual")
    name: FileName = Field(default="program", description="what its file is called in messages")
    files: Annotated[dict[FileName, ProgramText], Field(max_length=64)] = Field(
        default_factory=dict, description="files that it includes, by name"
    )


class ProgramStart(Body):
    address: Address | None = Field(default=None, description="null: where it stopped")


class ProgramProblem(Answer):
    """Something wrong with a program. Lines and columns count from 1."""

    file: str
    line: int
    column: int
    message: str = Field(description="what is wrong, and what was expected")


class AssembledProgram(Answer):
    """A program as commands; with problems there is none."""

    problems: list[ProgramProblem]
    commands: int
    labels: dict[str, int] = Field(description="addresses by name")
    listing: str = Field(description="address, bytes, source and command of each")


class StoredProgram(Answer):
    """A program that was stored from address 0 on, and read back."""

    commands: int
    labels: dict[str, int] = Field(description="addresses by name")
    sent_again: int = Field(description="commands that were sent again, for their answers were lost or garbled")


class ProgramListing(Answer):
    """A stretch of the device's program memory."""

    address: int
    commands: int
    text: str = Field(description="a program that assembles to the same commands")


class ProgramRun(Answer):
    """What the device's interpreter does, as far as the device tells it."""

    status: Literal["stopped", "running", "stepping", "reset"]
    downloading: bool
    counter: int = Field(description="address of the command that is done next, or waits")
    accumulator: int
    x: int
    error: int | None = Field(description="status of the latest command that was refused; null where it is not told")
    variables: dict[int, int] = Field(description="those that were asked for, by number")
