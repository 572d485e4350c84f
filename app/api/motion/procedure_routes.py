"""What moves an axis on its own for a while: reference search and shuttle. Any other command to the axis ends them."""

from __future__ import annotations

from ...devices.core.device import Device
from ...errors import OutOfRange, SoftLimit, UnknownThing, UsageError, WrongState
from ...procedures.stall_search import StallWanted
from ...procedures.velocity_profile import judge
from ..deps import CurrentAxis, CurrentBench, CurrentDevice
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from .schemas import (
    ReferenceSearchStart,
    ReferenceSearchState,
    ShuttleStart,
    ShuttleState,
    VelocityProfileBody,
    VelocityProfileLateness,
    VelocityProfileState,
    VelocityProfileSummary,
)

router = subject_router(prefix="/devices/{device}/axes/{axis}", tags=["procedures"])

LOOK = problems(UnknownThing)
START = problems(UnknownThing, WrongState, UsageError, OutOfRange, SoftLimit)


@router.get("/reference-search", responses=LOOK)
async def get_reference_search(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> ReferenceSearchState:
    """How far the search is, or how the latest one ended."""
    return ReferenceSearchState.model_validate(bench.procedures.search_state(device, axis.index))


@router.post("/reference-search", responses=START)
async def start_reference_search(
    bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis, body: ReferenceSearchStart | None = None
) -> ReferenceSearchState:
    """Search a switch at both its edges and set zero to its centre; a module does so by itself, in one of its modes.
    With `stall`, search the end of the stage without a switch.

    Answers when it has started.
    """
    wanted = body or ReferenceSearchStart()
    if wanted.stall is not None:
        _check_alone(wanted)
        stall = wanted.stall.model_dump()
        by_stall = StallWanted(velocity_pps=stall.pop("velocity"), max_travel=wanted.max_travel, **stall)
        return ReferenceSearchState.model_validate(bench.procedures.start_stall_search(device, axis.index, by_stall))
    _check_family(wanted, device)
    state = bench.procedures.start_search(
        device,
        axis.index,
        "reference" if wanted.switch == "home" else wanted.switch,
        wanted.velocity,
        wanted.max_travel,
        mode=wanted.mode,
        search_speed_pps=wanted.search_speed_pps,
        switch_speed_pps=wanted.switch_speed_pps,
    )
    return ReferenceSearchState.model_validate(state)


def _check_alone(wanted: ReferenceSearchStart) -> None:
    """Raises UsageError for what goes with a search for a switch, and not with one by stall."""
    given = [
        name
        for name in ("switch", "velocity", "mode", "search_speed_pps", "switch_speed_pps")
        if name in wanted.model_fields_set and getattr(wanted, name) is not None
    ]
    if given:
        raise UsageError(f"a search by stall knows no {given[0]}: its side and speed stand in stall")


def _check_family(wanted: ReferenceSearchStart, device: Device) -> None:
    """Raises UsageError for what this family's search does not take: better than not to do what was asked for."""
    others = ("switch",) if device.family.kind == "module" else ("mode", "search_speed_pps", "switch_speed_pps")
    given = [name for name in others if name in wanted.model_fields_set and getattr(wanted, name) is not None]
    if given:
        way = "by mode, search_speed_pps and switch_speed_pps" if "switch" in given else "by switch and velocity"
        raise UsageError(f"a {device.family.title} knows no {given[0]}; it searches {way}")


@router.delete("/reference-search", responses=LOOK)
@policy(stops=True)
async def abort_reference_search(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> ReferenceSearchState:
    """End the search and stop the motor."""
    return ReferenceSearchState.model_validate(await bench.procedures.abort_search(device, axis.index))


@router.get("/shuttle", responses=LOOK)
async def get_shuttle(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> ShuttleState:
    """Whether the axis shuttles, and how often it did."""
    return ShuttleState.model_validate(bench.procedures.shuttle_state(device, axis.index))


@router.post("/shuttle", responses=START)
async def start_shuttle(
    bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis, body: ShuttleStart
) -> ShuttleState:
    """Move back and forth between two positions until stopped. Answers when it has started."""
    state = bench.procedures.start_shuttle(device, axis.index, body.first, body.second, body.dwell_s)
    return ShuttleState.model_validate(state)


@router.delete("/shuttle", responses=LOOK)
@policy(stops=True)
async def stop_shuttle(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> ShuttleState:
    """End the shuttle and stop the motor."""
    return ShuttleState.model_validate(await bench.procedures.stop_shuttle(device, axis.index))


@router.get("/velocity-profile", responses=LOOK)
async def get_velocity_profile(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> VelocityProfileState:
    """How a velocity profile goes, or how the latest one ended."""
    return VelocityProfileState.model_validate(bench.procedures.profile_state(device, axis.index))


@router.get("/velocity-profile/lateness", responses=LOOK)
async def get_velocity_profile_lateness(
    bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis
) -> VelocityProfileLateness:
    """How late each point of the present profile was, or of the latest one."""
    play = bench.procedures.profile_play(device, axis.index)
    if play is None:
        return VelocityProfileLateness(time_s=[], late_ms=[])
    return VelocityProfileLateness(time_s=play.times_s(), late_ms=play.lateness_ms())


@router.post("/velocity-profile/check", responses=problems(*DEVICE_PROBLEMS, SoftLimit))
@policy(lease="free", role="look", audit="silent")
async def check_velocity_profile(
    device: CurrentDevice, axis: CurrentAxis, body: VelocityProfileBody
) -> VelocityProfileSummary:
    """Judge a profile by what the chip and the soft limits allow. Nothing moves."""
    wanted = await judge(device, axis.index, body.time_s, body.velocity_pps, body.rate_hz)
    return VelocityProfileSummary.model_validate(wanted.summary)


@router.post("/velocity-profile", responses=problems(*DEVICE_PROBLEMS, SoftLimit))
async def start_velocity_profile(
    bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis, body: VelocityProfileBody
) -> VelocityProfileState:
    """Play a velocity over time on an axis that stands. It is judged first; answers when it has started."""
    state = await bench.procedures.start_profile(device, axis.index, body.time_s, body.velocity_pps, body.rate_hz)
    return VelocityProfileState.model_validate(state)


@router.delete("/velocity-profile", responses=LOOK)
@policy(stops=True)
async def stop_velocity_profile(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> VelocityProfileState:
    """End it and stop the motor."""
    return VelocityProfileState.model_validate(await bench.procedures.stop_profile(device, axis.index))
