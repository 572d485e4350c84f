"""Programs by single steps: until a breakpoint, over or out of a subroutine. Any other command to the axis ends it."""

from __future__ import annotations

from ...devices.core.capabilities import ProgramMemory
from ..audit import wording
from ..deps import CurrentBench, CurrentDevice
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from .schemas import DebugBreakpoints, DebugStart, DebugState

router = subject_router(prefix="/devices/{device}/program/debug", tags=["programs"])


@router.get("", responses=problems(*DEVICE_PROBLEMS))
async def get_debug_run(bench: CurrentBench, device: CurrentDevice) -> DebugState:
    """How far the run by single steps is, or how the latest one ended."""
    device.need(ProgramMemory)
    return DebugState.model_validate(bench.procedures.debug_state(device))


@router.post("", responses=problems(*DEVICE_PROBLEMS))
@policy(words=wording.plain("debug program", "mode", "breakpoints"))
async def debug_program(bench: CurrentBench, device: CurrentDevice, body: DebugStart | None = None) -> DebugState:
    """Do the program one command at a time until a breakpoint or its end. Answers when it has started.

    Slower than the device by itself; the motor and its timers do not wait. No command of the module sets a breakpoint
    that any public source tells the arguments of, so it is the server who halts.
    """
    wanted = body or DebugStart()
    state = bench.procedures.start_debugging(device, wanted.mode, wanted.breakpoints, from_start=wanted.from_start)
    return DebugState.model_validate(state)


@router.put("/breakpoints", responses=problems(*DEVICE_PROBLEMS))
@policy(words=wording.plain("set breakpoints", "breakpoints"))
async def set_breakpoints(bench: CurrentBench, device: CurrentDevice, body: DebugBreakpoints) -> DebugState:
    """Other breakpoints for the run under way; without one nothing changes."""
    device.need(ProgramMemory)
    run = bench.procedures.debugging(device)
    if run is not None and run.running:
        run.set_breakpoints(body.breakpoints)
    return DebugState.model_validate(bench.procedures.debug_state(device))


@router.delete("", responses=problems(*DEVICE_PROBLEMS))
@policy(stops=True, words=wording.done("pause program"))
async def pause_program(bench: CurrentBench, device: CurrentDevice) -> DebugState:
    """Halt before the next command. The motor goes on as it was told last: a stop of the axis ends both."""
    device.need(ProgramMemory)
    return DebugState.model_validate(await bench.procedures.pause_debugging(device))
