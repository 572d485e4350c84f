"""Shapes of programs: their text, what is wrong with it, and what the device makes of them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints

from ...deferred import DeferredRootModel
from ...procedures.debugging import BREAKPOINTS_MAX
from ...procedures.trial import DURATION_MAX_S
from ..schemas import Answer, Body, Flag, Problem

TEXT_MAX = 500_000
FileName = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=120)]
SourceText = Annotated[str, StringConstraints(strict=True, max_length=TEXT_MAX)]
Address = Annotated[int, Field(strict=True, ge=0, le=65_535)]


class ProgramSource(Body):
    """A program as it is written."""

    text: SourceText = Field(description="one command a line; labels, constants and #include as in the maker's manual")
    name: FileName = Field(default="program", description="what its file is called in messages")
    files: Annotated[dict[FileName, SourceText], Field(max_length=64)] = Field(
        default_factory=dict, description="files that it includes, by name"
    )


class ProgramToAssemble(ProgramSource):
    listing: Flag = Field(default=True, description="whether a listing is wanted")
    binary: Flag = Field(default=False, description="whether the binary file is wanted")


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
    listing: str = Field(description="address, bytes, source and command of each; empty where it was not asked for")
    lines: list[int] = Field(description="of each command the line that it is in, from 1; 0 in an included file")
    binary: str | None = Field(description="eight bytes a command, as base64; null where it was not asked for")


class ProgramBinary(Body):
    """A binary file: eight bytes a command."""

    binary: Annotated[str, StringConstraints(strict=True, max_length=40_000)] = Field(description="as base64")


class ProgramText(Answer):
    """A program that assembles to the same commands."""

    text: str


class ProgramIncludes(Answer):
    """What every program may include."""

    files: dict[str, str] = Field(description="their texts, by name")


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


class ProgramTrialStart(ProgramSource):
    """A program to be tried on an emulator."""

    address: Address = Field(default=0, description="where it begins")
    duration_s: Annotated[float, Field(strict=True, gt=0, le=DURATION_MAX_S)] = Field(
        default=10.0, description="how long, of the emulator's time [s]"
    )


class ProgramTrial(ProgramRun):
    """What an emulated module, set as this one is, did with a program; the columns have a row each 0.02 s."""

    ended: Literal["stopped", "time", "work"] = Field(
        description="by itself; when its time was over; when it had taken too much of the processor"
    )
    flags: list[str]
    stack: list[int]
    time_s: list[float]
    position: list[int] = Field(description="[microsteps]")
    velocity_pps: list[float]
    counters: list[int] = Field(description="address of the command that was next, or waited")


# --- debugger ---------------------------------------------------------------------------------------

Breakpoints = Annotated[list[Annotated[int, Field(strict=True, ge=0, le=65_535)]], Field(max_length=BREAKPOINTS_MAX)]


class DebugStart(Body):
    """A run by single steps, from where the program is."""

    mode: Literal["run", "over", "out"] = Field(
        default="run", description="over: one command, or a whole subroutine; out: until the subroutine has returned"
    )
    breakpoints: Breakpoints = Field(default_factory=list, description="addresses at which it halts")
    from_start: Flag = Field(default=False, description="reset the program first: it begins at address 0")


class DebugBreakpoints(Body):
    breakpoints: Breakpoints


class DebugState(Answer):
    """A run by single steps, or how the latest one ended."""

    state: Literal["idle", "running", "done", "failed", "aborted"]
    mode: Literal["run", "over", "out"]
    breakpoints: list[int]
    halted_at: int | None = Field(description="the breakpoint that ended it")
    steps: int
    steps_per_s: float | None = Field(description="how fast it goes: slower than the device by itself")
    message: str


# --- socket -----------------------------------------------------------------------------------------

SUBPROTOCOL = "stepscope.program.v1"


class ProgramWatched(Body):
    """What a client says: the user variables that it wants to be told."""

    variables: Annotated[list[Annotated[int, Field(strict=True, ge=0, le=255)]], Field(max_length=64)]


class ProgramStarted(Answer):
    """The first message."""

    type: Literal["start"] = "start"
    device: str
    rate_hz: float = Field(description="about how often the device is looked at")


class ProgramSeen(ProgramRun):
    """One look at the program. Said where something differs from the look before."""

    type: Literal["state"] = "state"
    time_s: float = Field(description="device time [s]")
    flags: list[str] | None = Field(description="those that are set; null where the device tells none")
    stack: list[int] | None = Field(
        description="where subroutines return to, the innermost last; null where the device does not tell"
    )
    waits: bool | None = Field(description="a WAIT is not met yet; null where the device does not tell")
    interrupted: bool | None = Field(description="an interrupt is being served; null where the device does not tell")
    debug: DebugState
    trace: list[int] = Field(description="addresses of the commands done by single steps since the last message")


class ProgramLost(Answer):
    """The device is not looked at, or did not answer; what was told before may be so no more."""

    type: Literal["lost"] = "lost"
    problem: Problem


class ProgramAlive(Answer):
    """Nothing has changed for a second, and the server goes on looking."""

    type: Literal["alive"] = "alive"


class ProgramRefused(Answer):
    """Why there is no watch, or not of these variables; where there is none, the socket closes with 4000 + status."""

    type: Literal["refused"] = "refused"
    problem: Problem


ProgramTold = ProgramStarted | ProgramSeen | ProgramLost | ProgramAlive | ProgramRefused


class ProgramMessage(DeferredRootModel[ProgramTold]):
    """Any message of the socket."""

    root: Annotated[ProgramTold, Field(discriminator="type")]
