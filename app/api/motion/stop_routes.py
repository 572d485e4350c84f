"""Stopping. Nothing here waits for anything but the wire: stops overtake every queue."""

from __future__ import annotations

from ..audit import wording
from ..deps import CurrentAxis, CurrentBench, CurrentDevice
from ..devices.views import stop_result
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router, work_out
from .schemas import Stop, StopReport, StopResult

router = subject_router(tags=["stop"])


@router.post("/stop")
@policy(stops=True, partly=True, words=wording.plain("stop everything", "mode"))
async def stop_everything(bench: CurrentBench, body: Stop | None = None) -> StopReport:
    """Stop every axis of every device, ahead of all queues. Always answers, within a second; each result tells for
    itself."""
    outcomes = await bench.manager.stop_all((body or Stop()).mode)
    return StopReport(results=[stop_result(outcome) for outcome in outcomes])


@router.post("/devices/{device}/axes/{axis}/stop", responses=problems(*DEVICE_PROBLEMS))
@policy(stops=True, words=wording.plain("stop", "mode"))
async def stop_axis(
    bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis, body: Stop | None = None
) -> StopResult:
    """Stop one axis, ahead of its device's queue."""
    return stop_result(await bench.manager.stop_axis(device, axis.index, (body or Stop()).mode))


work_out(router)  # a stop never waits for that
