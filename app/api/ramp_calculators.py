"""Ramps over time: from the named parameters of the contract to the calculators, and back as samples."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from app.api.convert import calculating
from app.api.ramp_torque import torque_of
from app.api.schemas_calc import Phase, Ramp, RampResult
from app.api.schemas_sramp import RampTorque
from app.api.sramp_calculator import s_ramp
from app.calc.motor_torque import StepperMotor
from app.calc.ramp import RampParameters, exact_ramp
from app.calc.ramp_curve import RampCurve
from app.calc.ramp_trapezoid import trapezoid_ramp
from app.calc.sixpoint import MotionPlan, SixPoint, position_plan, velocity_plan
from app.links.errors import UsageError

WHOLE = ("v_min", "v_max", "a_max", "ramp_div", "pulse_div", "pmul", "pdiv", "v_target", "v_actual")
NEEDED = ("v_max", "a_max", "ramp_div", "pulse_div")
SIXPOINT = {
    "vstart": "v_start",
    "a1": "a1",
    "v1": "v1",
    "amax": "a_max",
    "vmax": "v_max",
    "dmax": "d_max",
    "d1": "d1",
    "vstop": "v_stop",
    "t_zero_wait_s": "t_zero_wait_s",
}
"""The contract's names of a SixPoint ramp's parameters, and the calculator's."""


def ramp(body: Ramp) -> RampResult:
    with calculating():
        if body.model == "s_ramp":
            return s_ramp(body)
        curve = _CURVES.get(body.model, _exact)(body)
    return RampResult(
        duration_s=curve.duration_s,
        phases=[Phase.model_validate(phase) for phase in curve.phases],
        time_s=curve.time_s.tolist(),
        position=curve.position.tolist(),
        velocity_pps=curve.velocity_pps.tolist(),
        acceleration_pps2=curve.acceleration_pps2.tolist(),
        overshoot_steps=curve.overshoot_steps,
        warnings=[] if curve.settled or _open_ended(body) else ["the motor does not rest at the target at the end"],
        torque=_torque(body, curve),
    )


def _torque(body: Ramp, curve: RampCurve) -> RampTorque | None:
    """Of ideal ramps: a ramp bit for bit changes its velocity in jumps, whose torque nobody could give."""
    if body.motor is None or body.model not in _CURVES:
        return None
    return torque_of(StepperMotor(**body.motor.model_dump()), curve, _number("vmax", body.parameters["vmax"]))


def _trapezoid(body: Ramp) -> RampCurve:
    names = ("vmax", "amax", "dmax")
    given = dict(body.parameters)
    given.setdefault("dmax", given.get("amax", 0.0))
    _check_names(given, names, names)
    vmax, amax, dmax = (_number(name, given[name]) for name in names)
    return trapezoid_ramp(vmax, amax, dmax, body.distance, body.samples)


def _sixpoint(body: Ramp) -> RampCurve:
    given = dict(body.parameters)
    mode = given.pop("ramp_mode", "ramp")
    _check_names(given, (*SIXPOINT, "v_actual", "v_target"), ("amax", "vmax"), ("ramp_mode",))
    numbers = {name: _number(name, value) for name, value in given.items()}
    if mode not in ("ramp", "velocity"):
        raise UsageError(f"ramp_mode of a sixpoint ramp is ramp or velocity, not {mode!r}")
    v_actual = numbers.pop("v_actual", 0.0)
    v_target = numbers.pop("v_target", math.copysign(numbers["vmax"], body.distance))
    if mode == "velocity":
        ramp = SixPoint(**{SIXPOINT[name]: number for name, number in numbers.items()})
        return _rotation(velocity_plan(ramp, v_target, v_actual), body)
    numbers.setdefault("dmax", numbers["amax"])
    if numbers.get("v1"):
        numbers = {"a1": numbers["amax"], "d1": numbers["dmax"], **numbers}
    ramp = SixPoint(**{SIXPOINT[name]: number for name, number in numbers.items()})
    return position_plan(ramp, body.distance, v_actual).curve(body.samples)


def _rotation(plan: MotionPlan, body: Ramp) -> RampCurve:
    """Until the velocity is reached and the distance is behind, whichever is later."""
    speed = abs(plan.end_velocity_pps)
    left = abs(body.distance) - abs(plan.end_position)
    return plan.curve(body.samples, plan.duration_s + (max(left, 0.0) / speed if speed else 0.0))


def _exact(body: Ramp) -> RampCurve:
    given = dict(body.parameters)
    mode = given.pop("ramp_mode", "ramp")
    clock_hz = given.pop("clock_hz", 16e6)
    if not isinstance(mode, str) or isinstance(clock_hz, str):
        raise UsageError("ramp_mode is a name, clock_hz a number")
    _check_names(given, WHOLE, NEEDED, ("ramp_mode", "clock_hz"))
    numbers = {name: _whole(name, value) for name, value in given.items()}
    if mode in ("ramp", "soft") and not {"pmul", "pdiv"} <= numbers.keys():
        raise UsageError(f"pmul and pdiv decide when {mode} mode brakes, and are missing")
    distance = _whole("distance", body.distance)
    # Where nobody says how fast it is to turn: at v_max, the way that the distance says.
    full_speed = numbers["v_max"] if distance >= 0 else -numbers["v_max"]
    if mode == "velocity":
        numbers.setdefault("v_target", full_speed)
    if mode == "hold":
        numbers.setdefault("v_actual", full_speed)
    parameters = RampParameters(**{"v_min": 1, **numbers}, ramp_mode=mode, clock_hz=clock_hz)
    return exact_ramp(parameters, distance, body.samples)


def _check_names(
    given: Mapping[str, object], known: tuple[str, ...], needed: tuple[str, ...], others: tuple[str, ...] = ()
) -> None:
    unknown = [name for name in given if name not in known]
    missing = [name for name in needed if name not in given]
    if unknown:
        raise UsageError(f"there is no parameter {unknown[0]!r}; known: {', '.join((*known, *others))}")
    if missing:
        raise UsageError(f"missing parameters: {', '.join(missing)}")


def _number(name: str, value: float | str) -> float:
    if isinstance(value, str):
        raise UsageError(f"{name} is a number, not {value!r}")
    return value


def _whole(name: str, value: float | str) -> int:
    if isinstance(value, str) or value != int(value):
        raise UsageError(f"{name} is a whole number, not {value!r}")
    return int(value)


def _open_ended(body: Ramp) -> bool:
    return body.parameters.get("ramp_mode") in ("velocity", "hold")


_CURVES: dict[str, Callable[[Ramp], RampCurve]] = {"trapezoid": _trapezoid, "sixpoint": _sixpoint}
