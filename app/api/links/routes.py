"""The wire of a device: what goes over it, how much more could, and what went wrong."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query

from ...errors import UnknownThing
from ..deps import CurrentBench, CurrentDevice
from ..http.problems import problems
from ..router import subject_router
from .schemas import FrameLog, LinkInfo
from .views import frame_log, link_info

router = subject_router(prefix="/devices/{device}", tags=["links"])

After = Annotated[int, Query(description="number of the first entry wanted: `next` of the answer before", ge=0)]
Limit = Annotated[int, Query(description="at most so many, the newest ones", ge=1, le=2000)]


@router.get("/frames", responses=problems(UnknownThing))
async def get_frames(device: CurrentDevice, after: After = 0, limit: Limit = 500) -> FrameLog:
    """The latest transactions, decoded: of telemetry, of commands and of stops."""
    return frame_log(device, after, limit)


@router.get("/link", responses=problems(UnknownThing))
async def get_link(bench: CurrentBench, device: CurrentDevice) -> LinkInfo:
    """What this device's wire can carry and carries, its counts and its latest incidents."""
    return link_info(device, bench.manager.devices)
