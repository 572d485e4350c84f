"""The program of a device in a profile: read back from its memory or written by hand, compared, stored, taken back.

It is the device's memory from address 0 on. Behind a program there is nothing: where a device holds more commands than
the profile's program has, these are written over with empty ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import zip_longest

from pydantic import ConfigDict, Field

from ..calc.tmcl.assembler import assemble
from ..calc.tmcl.disassembler import disassemble, spell
from ..calc.tmcl.instructions import Command
from ..deferred import DeferredModel
from ..devices.core.capabilities import ProgramMemory
from ..devices.core.device import Device
from ..errors import BenchError, LinkError, WrongState
from .document import ProfileDocument, ProgramPart
from .errors import Change, UnreadableProfile
from .families import rules_of

NAME = "program"
"""What it is called among the changes and differences of a profile."""
EMPTY = Command(0, 0, 0, 0)
_EMPTIES = frozenset({EMPTY, Command(255, 255, 255, -1)})
"""Memory that holds nothing: as it is delivered, and as erased flash reads."""
BLOCK = 64
"""So many empty commands in a row are the end: a program that goes on behind them is not seen."""
TOLD = 50
"""Differing commands that are told one by one."""


class CommandDifference(DeferredModel):
    """A command that is not the same on both sides; empty where there is none."""

    model_config = ConfigDict(json_schema_serialization_defaults_required=True)

    address: int
    left: str
    right: str


class ProgramDifference(DeferredModel):
    """Two programs that are not the same."""

    model_config = ConfigDict(json_schema_serialization_defaults_required=True)

    left_commands: int
    right_commands: int
    differing: int = Field(description="commands that are not the same, or that only one of them has")
    commands: list[CommandDifference] = Field(description=f"the first {TOLD} of them")


@dataclass(frozen=True, slots=True)
class ProgramStep:
    """A program that is to be stored, and what it is stored over. Both without empty commands at the end."""

    was: tuple[Command, ...]
    wanted: tuple[Command, ...]

    def change(self, now: int | None, why: str = "") -> Change:
        """As it is told: by numbers of commands."""
        return Change(NAME, None, None, len(self.was), now, len(self.wanted), why)


# --- of a document ----------------------------------------------------------------------------------


def commands_of(document: ProfileDocument) -> tuple[Command, ...] | None:
    """The commands of a profile's program; None where it does not speak of one.

    Raises UnreadableProfile for a model that stores none, and for text that does not assemble.
    """
    part = document.program
    if part is None:
        return None
    language = rules_of(document.model).language
    if language is None:
        raise UnreadableProfile(NAME, f"a {document.title} stores no program")
    made = assemble(
        "\n".join(part.source),
        language.instructions,
        name=part.name or NAME,
        resolve=lambda file: part.files[file] if file in part.files else language.include(document.model, file),
    )
    if made.problems:
        more = f" (and {len(made.problems) - 1} more)" if len(made.problems) > 1 else ""
        raise UnreadableProfile(NAME, f"{made.problems[0]}{more}")
    return without_end(made.commands)


def without_end(commands: Sequence[Command]) -> tuple[Command, ...]:
    """Without the empty ones behind the last that is none."""
    length = next((at for at in range(len(commands), 0, -1) if commands[at - 1] not in _EMPTIES), 0)
    return tuple(commands[:length])


def part_of(model: str, commands: Sequence[Command]) -> ProgramPart | None:
    """A program as a profile has it; None for no commands, of which a profile does not speak."""
    language = rules_of(model).language
    if not commands or language is None:
        return None
    return ProgramPart(source=disassemble(commands, language.instructions).splitlines())


# --- of a device ------------------------------------------------------------------------------------


async def read_stored(device: Device, at_least: int = 0) -> tuple[Command, ...]:
    """What a device's memory holds, up to the first empty stretch behind `at_least` commands.

    Raises WrongState where the memory is protected; BenchError.
    """
    memory = device.need(ProgramMemory)
    size = memory.instructions.memory
    commands: list[Command] = []
    while len(commands) < size:
        block = await memory.read_program(len(commands), min(BLOCK, size - len(commands)))
        commands += block
        if len(commands) >= at_least and all(command in _EMPTIES for command in block):
            break
    return without_end(commands)


async def read_part(device: Device) -> tuple[ProgramPart | None, str]:
    """The program of a device, if it has any, and why it cannot be told ("" where it can). Raises LinkError."""
    if device.part(ProgramMemory) is None or rules_of(device.model).language is None:
        return None, ""
    try:
        return part_of(device.model, await read_stored(device)), ""
    except LinkError:
        raise
    except BenchError as error:  # its memory is protected from reading
        return None, str(error)


async def step_of(device: Device, document: ProfileDocument) -> ProgramStep | None:
    """What a profile's program is stored over; None where it speaks of none, or the device holds it already.

    Raises UnreadableProfile, WrongState, BenchError.
    """
    wanted = commands_of(document)
    if wanted is None:
        return None
    if device.part(ProgramMemory) is None:
        raise WrongState(f"{device.name} stores no program", "take the program out of the profile")
    was = await read_stored(device, len(wanted))
    return None if was == wanted else ProgramStep(was, wanted)


async def store(device: Device, over: int, commands: Sequence[Command]) -> None:
    """Store `commands` where `over` were, and read them back. Raises what `ProgramMemory.download` does."""
    padded = [*commands, *[EMPTY] * (over - len(commands))]
    await device.need(ProgramMemory).download(padded)


async def restore(device: Device, step: ProgramStep) -> Change | None:
    """Bring back what was there before; None where that is done, else what is told of it. Never raises BenchError."""
    try:
        there = await read_stored(device, max(len(step.was), len(step.wanted)))
    except BenchError:
        there = None  # it may be in download mode still: storing ends that
    if there == step.was:
        return None
    try:
        await store(device, len(step.wanted), step.was)
    except BenchError as error:
        return step.change(None, str(error))
    return None


# --- compared ---------------------------------------------------------------------------------------


def compared(model: str, left: Sequence[Command], right: Sequence[Command]) -> ProgramDifference | None:
    """What differs between two programs of one model; None where nothing does."""
    language = rules_of(model).language
    if language is None or tuple(left) == tuple(right):
        return None
    differing = [(at, one, other) for at, (one, other) in enumerate(zip_longest(left, right)) if one != other]

    def told(command: Command | None) -> str:
        return "" if command is None else spell(command, language.instructions)

    return ProgramDifference(
        left_commands=len(left),
        right_commands=len(right),
        differing=len(differing),
        commands=[
            CommandDifference(address=at, left=told(one), right=told(other)) for at, one, other in differing[:TOLD]
        ],
    )
