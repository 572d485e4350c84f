"""Ramps over time: from the named parameters of the contract to the calculators, and back as samples."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ...calc.motor_torque import StepperMotor
from ...calc.ramps.curve import RampCurve
from ...calc.ramps.sixpoint import MotionPlan, position_plan, velocity_plan
from ...calc.ramps.ticked import RampParameters, exact_ramp
from ...calc.ramps.trapezoid import trapezoid_ramp
from ...errors import UsageError
from ..devices.views import calculating
from .ramp_parameters import check_names, number_of, whole_of
from .ramp_torque import torque_of
from .schemas import Phase, Ramp, RampResult
from .sixpoint import ramp_findings, ramp_registers, sixpoint_wish
from .sramp_schemas import RampFinding, RampRegister, RampTorque
from .tmc4361.sramp import s_ramp

WHOLE = ("v_min", "v_max", "a_max", "ramp_div", "pulse_div", "pmul", "pdiv", "v_target", "v_actual")
NEEDED = ("v_max", "a_max", "ramp_div", "pulse_div")


def ramp(body: Ramp) -> RampResult:
    with calculating():
        if body.model == "s_ramp":
            return s_ramp(body)
        curve = _CURVES.get(body.model, _exact)(body)
        registers, findings = _held(body)
    warnings = [] if curve.settled or _open_ended(body) else ["the motor does not rest at the target at the end"]
    return RampResult(
        duration_s=curve.duration_s,
        phases=[Phase.model_validate(phase) for phase in curve.phases],
        time_s=curve.time_s.tolist(),
        position=curve.position.tolist(),
        velocity_pps=curve.velocity_pps.tolist(),
        acceleration_pps2=curve.acceleration_pps2.tolist(),
        overshoot_steps=curve.overshoot_steps,
        warnings=[*warnings, *(finding.text for finding in findings)],
        torque=_torque(body, curve),
        registers=registers,
        findings=findings,
    )


def _held(body: Ramp) -> tuple[list[RampRegister], list[RampFinding]]:
    """What a SixPoint ramp becomes in a chip's registers; nothing where no clock says that there is a chip."""
    if body.model != "sixpoint" or "clock_hz" not in body.parameters:
        return [], []
    wanted = sixpoint_wish(body)
    return ramp_registers(wanted), ramp_findings(wanted)


def _torque(body: Ramp, curve: RampCurve) -> RampTorque | None:
    """Of ideal ramps: a ramp bit for bit changes its velocity in jumps, whose torque nobody could give."""
    if body.motor is None or body.model not in _CURVES:
        return None
    return torque_of(StepperMotor(**body.motor.model_dump()), curve, number_of("vmax", body.parameters["vmax"]))


def _trapezoid(body: Ramp) -> RampCurve:
    names = ("vmax", "amax", "dmax")
    given = dict(body.parameters)
    given.setdefault("dmax", given.get("amax", 0.0))
    check_names(given, names, names)
    vmax, amax, dmax = (number_of(name, given[name]) for name in names)
    return trapezoid_ramp(vmax, amax, dmax, body.distance, body.samples)


def _sixpoint(body: Ramp) -> RampCurve:
    wanted = sixpoint_wish(body)
    if not wanted.positioning:
        return _rotation(velocity_plan(wanted.ramp, wanted.v_target, wanted.v_actual), body)
    return position_plan(wanted.ramp, body.distance, wanted.v_actual).curve(body.samples)


def _rotation(plan: MotionPlan, body: Ramp) -> RampCurve:
    """Until the velocity is reached and the distance is behind, whichever is later."""
    speed = abs(plan.end_velocity_pps)
    left = abs(body.distance) - abs(plan.end_position)
    return plan.curve(body.samples, plan.duration_s + (max(left, 0.0) / speed if speed else 0.0))


def _exact(body: Ramp) -> RampCurve:
    return exact_ramp(*exact_parameters(body.parameters, body.distance), body.samples)


def exact_parameters(named: Mapping[str, float | str], wanted: float) -> tuple[RampParameters, int]:
    """The registers of a chip's own ramp, and its distance [microsteps].

    Raises UsageError for names and numbers that it has not, ValueError outside the ranges.
    """
    given = dict(named)
    mode = given.pop("ramp_mode", "ramp")
    clock_hz = given.pop("clock_hz", 16e6)
    if not isinstance(mode, str) or isinstance(clock_hz, str):
        raise UsageError("ramp_mode is a name, clock_hz a number")
    check_names(given, WHOLE, NEEDED, ("ramp_mode", "clock_hz"))
    numbers = {name: whole_of(name, value) for name, value in given.items()}
    if mode in ("ramp", "soft") and not {"pmul", "pdiv"} <= numbers.keys():
        raise UsageError(f"pmul and pdiv decide when {mode} mode brakes, and are missing")
    distance = whole_of("distance", wanted)
    # Where nobody says how fast it is to turn: at v_max, the way that the distance says.
    full_speed = numbers["v_max"] if distance >= 0 else -numbers["v_max"]
    if mode == "velocity":
        numbers.setdefault("v_target", full_speed)
    if mode == "hold":
        numbers.setdefault("v_actual", full_speed)
    return RampParameters(**{"v_min": 1, **numbers}, ramp_mode=mode, clock_hz=clock_hz), distance


def _open_ended(body: Ramp) -> bool:
    return body.parameters.get("ramp_mode") in ("velocity", "hold")


_CURVES: dict[str, Callable[[Ramp], RampCurve]] = {"trapezoid": _trapezoid, "sixpoint": _sixpoint}
