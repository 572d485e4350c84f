"""Connections: what there is, add, edit, try, connect, remove."""

from __future__ import annotations

from fastapi import HTTPException

from ...devices import manager
from ...devices.core.config import DeviceConfig
from ...errors import OutOfRange, SoftLimit, UnknownThing, UsageError, WrongState
from ..audit import wording
from ..catalog.routes import loaded
from ..deps import CurrentBench, CurrentDevice, DeviceId
from ..http.problems import problem_of, problems
from ..policy import policy
from ..router import subject_router
from ..schemas import DeviceInfo, LinkTest
from .schemas import DeviceChange, DeviceCreate, DeviceTrial
from .views import axis_settings, clock_of, device_info, link_of, require_suited, suited, with_memory

router = subject_router(prefix="/devices", tags=["devices"])

DEVICES_MAX = 64
"""Each device is watched and remembered all the time; a script that adds in a loop must not drown the others."""


@router.get("")
async def list_devices(bench: CurrentBench) -> list[DeviceInfo]:
    """Every device, in the order they were added."""
    return [device_info(device, bench.conditions, bench.saver.why_not) for device in bench.manager.devices]


@router.post("", status_code=201, responses=problems(WrongState, OutOfRange))
@policy(words=wording.add_device)
async def add_device(body: DeviceCreate, bench: CurrentBench) -> DeviceInfo:
    """Add a connection and try it. One that does not answer is added all the same; `state` and `problem` tell why.

    It is on disk when this answers; where the disk takes nothing, `notes` tells, and it is tried again.
    """
    if len(bench.manager.devices) >= DEVICES_MAX:
        raise WrongState(f"there are {DEVICES_MAX} devices already", "remove one first")
    wanted = body.root
    await loaded(wanted.model)
    config = DeviceConfig(
        name=wanted.name,
        model=wanted.model,
        link=with_memory(link_of(wanted.link, wanted.clock_hz), wanted, bench.manager.devices),
        clock_hz=clock_of(wanted.link, wanted.clock_hz),
        axes=axis_settings(wanted.axes),
        start_up=wanted.start_up,
    )
    return device_info(await bench.manager.add(config), bench.conditions, await bench.saver.settled())


@router.post("/test", responses=problems(OutOfRange))
@policy(audit="silent")
async def test_link(body: DeviceTrial, bench: CurrentBench) -> LinkTest:
    """Try a link without keeping it."""
    await loaded(body.root.model)
    trial = await bench.manager.test(body.root.model, link_of(body.root.link, None))
    problem = None if trial.problem is None else problem_of(trial.problem)
    return LinkTest(ok=trial.ok, detail=trial.detail, round_trip_ms=trial.round_trip_ms, problem=problem)


@router.api_route("/test", methods=["GET", "PATCH", "DELETE"], include_in_schema=False)
async def no_device_is_called_test() -> None:
    """Keep `/devices/{device}` from taking this address for a device."""
    raise HTTPException(405, headers={"Allow": "POST"})


@router.get("/{device}", responses=problems(UnknownThing))
async def get_device(device: CurrentDevice, bench: CurrentBench) -> DeviceInfo:
    """One device: its link, state, axes and telemetry channels. Axes whose condition was judged more than 0.5 s ago
    are looked at first, for 0.25 s at the most."""
    await bench.conditions.freshen(device)
    return device_info(device, bench.conditions, bench.saver.why_not)


@router.patch("/{device}", responses=problems(UnknownThing, UsageError, SoftLimit))
@policy(words=wording.edit_device)
async def edit_device(device: DeviceId, body: DeviceChange, bench: CurrentBench) -> DeviceInfo:
    """Change a connection. A new name gives a new id; only a new link or model interrupts the device."""
    edited = bench.manager.get(device)
    model = (await loaded(body.model or edited.model)).name
    if body.link is None and model != edited.model:
        require_suited(edited.link, model)
    change = manager.DeviceChange(
        name=body.name,
        model=body.model,
        link=None if body.link is None else link_of(suited(body.link, model), body.clock_hz),
        clock_hz=body.clock_hz,
        axes=None if body.axes is None else axis_settings(body.axes),
    )
    return device_info(await bench.manager.edit(device, change), bench.conditions, await bench.saver.settled())


@router.delete("/{device}", status_code=204, responses=problems(UnknownThing))
@policy(words=wording.plain("remove device"))
async def remove_device(device: DeviceId, bench: CurrentBench) -> None:
    """Stop what this server set in motion, disconnect, and forget the connection."""
    await bench.manager.remove(device)
    await bench.saver.settled()  # where the disk takes nothing, the health of the server tells; it is tried again


@router.post("/{device}/connect", responses=problems(UnknownThing))
@policy(words=wording.plain("connect"))
async def connect_device(device: DeviceId, bench: CurrentBench) -> DeviceInfo:
    """Connect, or try again at once; `state` and `problem` tell what came of it."""
    return device_info(await bench.manager.connect(device), bench.conditions, bench.saver.why_not)


@router.post("/{device}/disconnect", responses=problems(UnknownThing))
@policy(words=wording.plain("disconnect"))
async def disconnect_device(device: DeviceId, bench: CurrentBench) -> DeviceInfo:
    """Stop what this server set in motion, and let go of the link until told to connect."""
    return device_info(await bench.manager.disconnect(device), bench.conditions, bench.saver.why_not)
