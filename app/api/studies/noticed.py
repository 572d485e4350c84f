"""Moves that are noticed, recorded and scored, whoever makes them."""

from __future__ import annotations

from ...errors import UnknownThing
from ..audit import wording
from ..deps import AxisNumber, CurrentBench, DeviceId
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from .routes import watch_info
from .schemas import MoveWatchInfo

router = subject_router(prefix="/devices/{device}/axes/{axis}/noticed-moves", tags=["studies"])


@router.put("", responses=problems(*DEVICE_PROBLEMS))
@policy(lease="free", words=wording.plain("notice moves"))
async def notice_moves(bench: CurrentBench, device: DeviceId, axis: AxisNumber) -> MoveWatchInfo:
    """Notice, record and score each move of this axis from now on, whoever makes it. Nothing moves by it."""
    return watch_info(bench.studies.watch(bench.manager.get(device), axis))


@router.delete("", status_code=204, responses=problems(UnknownThing))
@policy(lease="free", words=wording.plain("notice no more moves"))
async def notice_no_more_moves(bench: CurrentBench, device: DeviceId, axis: AxisNumber) -> None:
    """Leave them be; what was noticed stays."""
    await bench.studies.unwatch(bench.manager.get(device), axis)
