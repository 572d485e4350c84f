"""Programs in the memory of a device: assembled, stored, read back, run, stopped, stepped and looked at."""

from __future__ import annotations

import asyncio
import base64
from collections.abc import Callable
from typing import Annotated, TypeVar

from fastapi import Query

from ...calc.tmcl.assembler import Assembly
from ...calc.tmcl.binary import from_binary, to_binary
from ...calc.tmcl.disassembler import disassemble, listing
from ...errors import OutOfRange, SoftLimit, UsageError, WriteRefused
from ...procedures.trial import Trial
from ...profiles.capture import capture
from ..abilities import CurrentProgram
from ..audit import wording
from ..deps import CurrentBench, CurrentDevice
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from .schemas import (
    AssembledProgram,
    ProgramBinary,
    ProgramIncludes,
    ProgramListing,
    ProgramProblem,
    ProgramRun,
    ProgramSource,
    ProgramStart,
    ProgramText,
    ProgramToAssemble,
    ProgramTrial,
    ProgramTrialStart,
    StoredProgram,
)

router = subject_router(prefix="/devices/{device}/program", tags=["programs"])

T = TypeVar("T")
PROBLEMS_TOLD = 10
VariablesQuery = Annotated[
    list[Annotated[int, Query(ge=0, le=255)]] | None,
    Query(alias="variable", description="user variables to read, by number", max_length=64),
]
FirstQuery = Annotated[int, Query(ge=0, le=65_535, description="address of the first command")]
CountQuery = Annotated[int, Query(ge=1, le=65_536, description="how many commands")]


@router.post("/assemble", responses=problems(*DEVICE_PROBLEMS))
@policy(lease="free", role="look", audit="silent")
async def assemble_program(program: CurrentProgram, body: ProgramToAssemble) -> AssembledProgram:
    """The commands of a program, or everything that is wrong with it. Nothing is sent."""

    def made() -> AssembledProgram:
        assembly = program.assemble(body.text, body.files, body.name)
        if assembly.problems:
            told = [ProgramProblem.model_validate(problem) for problem in assembly.problems]
            return AssembledProgram(problems=told, commands=0, labels={}, listing="", lines=[], binary=None)
        return AssembledProgram(
            problems=[],
            commands=len(assembly.commands),
            labels=assembly.labels,
            listing=listing(assembly, program.instructions) if body.listing else "",
            lines=[place.line if place.file == body.name else 0 for place in assembly.places],
            binary=base64.b64encode(to_binary(assembly.commands)).decode() if body.binary else None,
        )

    return await _aside(made)


@router.post("/disassemble", responses=problems(*DEVICE_PROBLEMS))
@policy(lease="free", role="look", audit="silent")
async def disassemble_program(program: CurrentProgram, body: ProgramBinary) -> ProgramText:
    """A binary file as a program that assembles to the same commands. Nothing is sent."""
    try:
        content = base64.b64decode(body.binary, validate=True)
    except ValueError as error:  # of letters beyond ASCII it is no binascii.Error
        raise UsageError(f"the binary file has to come as base64: {error}") from error
    commands = from_binary(content)
    if len(commands) > program.instructions.memory:
        raise UsageError(f"the file has {len(commands)} commands, the device holds {program.instructions.memory}")
    return ProgramText(text=disassemble(commands, program.instructions))


@router.post("/try", responses=problems(*DEVICE_PROBLEMS, SoftLimit))
@policy(lease="free", role="look", audit="silent")
async def try_program(device: CurrentDevice, program: CurrentProgram, body: ProgramTrialStart) -> ProgramTrial:
    """Run a program on an emulated module that is set as this one is. This one is only read; nothing moves."""
    made = await _aside(lambda: program.assemble(body.text, body.files, body.name))
    _require_right(made)
    if body.address >= len(made.commands):
        raise OutOfRange("address of the program", body.address, 0, len(made.commands) - 1)
    trial = Trial(device, await capture(device), made.commands, body.address, body.duration_s)
    outcome = await _aside(trial.run)
    state, truth = outcome.state, outcome.ground_truth
    assert state is not None
    return ProgramTrial(
        ended=outcome.ended,
        status=state.status,
        downloading=state.downloading,
        counter=state.counter,
        accumulator=state.accumulator,
        x=state.x,
        error=state.error,
        variables={number: value for number, value in state.variables.items() if value},
        flags=[] if truth is None else list(truth.flags),
        stack=[] if truth is None else list(truth.stack),
        time_s=outcome.time_s,
        position=outcome.position,
        velocity_pps=outcome.velocity_pps,
        counters=outcome.counter,
    )


@router.get("/includes", responses=problems(*DEVICE_PROBLEMS))
async def program_includes(program: CurrentProgram) -> ProgramIncludes:
    """The files that every program may include: names of parameters and of interrupts."""
    return ProgramIncludes(files=dict(program.includes()))


@router.put("", responses=problems(*DEVICE_PROBLEMS, SoftLimit, WriteRefused))
@policy(words=wording.plain("download program", "name"))
async def write_program(program: CurrentProgram, body: ProgramSource) -> StoredProgram:
    """Assemble a program, store it in the device and read it back. One that runs is stopped; the motor has to rest."""
    made = await _aside(lambda: program.assemble(body.text, body.files, body.name))
    _require_right(made)
    stored = await program.download(made.commands)
    return StoredProgram(commands=stored.commands, labels=made.labels, sent_again=stored.sent_again)


@router.get("", responses=problems(*DEVICE_PROBLEMS))
async def read_program(program: CurrentProgram, address: FirstQuery = 0, count: CountQuery = 64) -> ProgramListing:
    """What a stretch of the memory holds, as text that assembles to the same commands.

    From address 0 on jumps go to labels, from another on to addresses as numbers.
    """
    commands = await program.read_program(address, count)
    text = disassemble(commands, program.instructions, first=address)
    return ProgramListing(address=address, commands=count, text=text)


@router.post("/run", status_code=204, responses=problems(*DEVICE_PROBLEMS))
@policy(audit="told by drivers", words=wording.plain("run program", "address"))
async def run_program(program: CurrentProgram, body: ProgramStart | None = None) -> None:
    """Run the program from an address, or from where it stopped. It may move the motor."""
    await program.run_program((body or ProgramStart()).address)


@router.post("/stop", status_code=204, responses=problems(*DEVICE_PROBLEMS))
@policy(stops=True, audit="told by drivers", words=wording.done("stop program"))
async def stop_program(bench: CurrentBench, device: CurrentDevice, program: CurrentProgram) -> None:
    """Stop the program. The motor goes on as it was told last: a stop of the axis ends both."""
    await bench.procedures.pause_debugging(device)
    await program.stop_program()


@router.post("/step", status_code=204, responses=problems(*DEVICE_PROBLEMS))
@policy(audit="told by drivers", words=wording.done("step program"))
async def step_program(program: CurrentProgram) -> None:
    """Do one command of the program."""
    await program.step_program()


@router.post("/reset", status_code=204, responses=problems(*DEVICE_PROBLEMS))
@policy(audit="told by drivers", words=wording.done("reset program"))
async def reset_program(program: CurrentProgram) -> None:
    """Stop the program and go to its start; registers are cleared."""
    await program.reset_program()


@router.get("/state", responses=problems(*DEVICE_PROBLEMS))
async def program_state(program: CurrentProgram, variables: VariablesQuery = None) -> ProgramRun:
    """What the interpreter does now: counter, registers, and those user variables that are asked for."""
    return ProgramRun.model_validate(await program.program_state(variables or ()))


_assembling = asyncio.Semaphore(2)


async def _aside(work: Callable[[], T]) -> T:
    """Done beside everything else, by two threads at most: a long text must not hold up a stop."""
    async with _assembling:
        return await asyncio.to_thread(work)


def _require_right(made: Assembly) -> None:
    """Raises UsageError with what is wrong."""
    if made.problems:
        told = "; ".join(str(problem) for problem in made.problems[:PROBLEMS_TOLD])
        more = len(made.problems) - PROBLEMS_TOLD
        raise UsageError(f"the program is not right: {told}{f'; and {more} more' if more > 0 else ''}")
