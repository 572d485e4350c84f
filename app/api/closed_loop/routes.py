"""Closed loop of one axis: calibrate it, and see what a step or a load does to it. Any other command ends them."""

from __future__ import annotations

from ...errors import OutOfRange, SoftLimit, UnknownThing, UsageError, WrongState
from ..deps import CurrentAxis, CurrentBench, CurrentDevice
from ..devices.views import load_of, response_out
from ..http.problems import problems
from ..policy import policy
from ..router import subject_router
from .schemas import CalibrationStart, CalibrationState, DisturbanceStart, ResponseState, StepResponseStart

router = subject_router(prefix="/devices/{device}/axes/{axis}", tags=["closed loop"])

LOOK = problems(UnknownThing)
START = problems(UnknownThing, WrongState, UsageError, OutOfRange, SoftLimit)


@router.get("/closed-loop-calibration", responses=LOOK)
async def get_calibration(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> CalibrationState:
    """How far the calibration is, or how the latest one ended."""
    return CalibrationState.model_validate(bench.procedures.calibration_state(device, axis.index))


@router.post("/closed-loop-calibration", responses=START)
async def start_calibration(
    bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis, body: CalibrationStart | None = None
) -> CalibrationState:
    """Turn to a full step, take the encoder's offset there and switch closed loop on. Answers when it has started."""
    wanted = body or CalibrationStart()
    state = bench.procedures.start_calibration(
        device, axis.index, wanted.velocity_pps, wanted.settle_s, switch_on=wanted.switch_on
    )
    return CalibrationState.model_validate(state)


@router.delete("/closed-loop-calibration", responses=LOOK)
@policy(stops=True)
async def abort_calibration(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> CalibrationState:
    """End the calibration: regulation off, motor stopped."""
    return CalibrationState.model_validate(await bench.procedures.abort_calibration(device, axis.index))


@router.get("/step-response", responses=LOOK)
async def get_step_response(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> ResponseState:
    """The recording and its score, when it is done."""
    return response_out(bench.procedures.step_response_state(device, axis.index))


@router.post("/step-response", responses=START)
async def start_step_response(
    bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis, body: StepResponseStart
) -> ResponseState:
    """Go by a distance and record how the encoder follows. Answers when it has started."""
    return response_out(
        bench.procedures.start_step_response(device, axis.index, body.distance, body.shape, body.window)
    )


@router.delete("/step-response", responses=LOOK)
@policy(stops=True)
async def abort_step_response(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> ResponseState:
    """End the recording and stop the motor."""
    return response_out(await bench.procedures.abort_step_response(device, axis.index))


@router.get("/disturbance", responses=LOOK)
async def get_disturbance(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> ResponseState:
    """The recording and its score, when it is done."""
    return response_out(bench.procedures.disturbance_state(device, axis.index))


@router.post("/disturbance", responses=START)
async def start_disturbance(
    bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis, body: DisturbanceStart
) -> ResponseState:
    """Load the axis for a while and record how it holds its place. Answers when it has started."""
    load = None if body.load_torque_nm is None else load_of(device, axis.index, body.load_torque_nm)
    return response_out(bench.procedures.start_disturbance(device, axis.index, load, body.load_s, body.window))


@router.delete("/disturbance", responses=LOOK)
@policy(stops=True)
async def abort_disturbance(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> ResponseState:
    """Take the load away and end the recording."""
    return response_out(await bench.procedures.abort_disturbance(device, axis.index))
