"""Start-up: a device set up after power-on, so that its axes can move."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query

from ...errors import SoftLimit, StoreUnavailable
from ...profiles import start_up
from ...profiles.errors import ProfileLeft, ProfileTakenBack
from ..audit import wording
from ..deps import CurrentAxis, CurrentBench, CurrentDevice
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from ..schemas import RegisterBatchResult
from .schemas import AxisStartUp, DeviceStartUp, StartUpReport
from .views import axis_wish_of, batch, report, wish_of

router = subject_router(prefix="/devices/{device}", tags=["axes"])

REFUSALS = problems(*DEVICE_PROBLEMS, SoftLimit, ProfileTakenBack, ProfileLeft, StoreUnavailable)


@router.post("/start-up", responses=REFUSALS)
@policy(lease="free as a dry run", whole=True, words=wording.with_body("start up"), changed_nothing=wording.tried_dry)
async def start_device_up(
    bench: CurrentBench,
    device: CurrentDevice,
    body: DeviceStartUp | None = None,
    dry_run: Annotated[
        bool, Query(description="only tell what would be written, as in the body: said here, it needs no lease")
    ] = False,
) -> StartUpReport:
    """Set axes up after power-on, so that they can move: currents, microsteps, switches, ramp, and what all share.

    One transaction, as applying a profile: all of it, each register read back, or everything as it was before. The
    motors stand meanwhile. `dry_run` tells what would be written, and writes nothing.
    """
    asked = body or DeviceStartUp()
    wish = wish_of(asked)
    if dry_run or asked.dry_run:
        return report(device, await start_up.dry_run(device, wish))
    return report(device, await start_up.start_up(bench.profiles, device, wish))


@router.post("/axes/{axis}/start-up", responses=REFUSALS)
@policy(whole=True, words=wording.with_body("start up"))
async def start_axis_up(
    bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis, body: AxisStartUp | None = None
) -> RegisterBatchResult:
    """The same for one axis, told as a batch of writes: `done` are those that were needed."""
    wish = axis_wish_of(axis.index, body or AxisStartUp())
    return batch(device, await start_up.start_up(bench.profiles, device, wish))
