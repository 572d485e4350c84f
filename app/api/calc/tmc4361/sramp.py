"""A TMC4361's ramps over REST: from the contract's parameters to the planner, and back with registers and rivals."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

from ....calc.motor_torque import FastMove, StepperMotor, fastest_move, fastest_trapezoid
from ....calc.ramps.sramp import RampWarning, SRamp, SRampPlan, position_plan, velocity_plan
from ....calc.ramps.sramp_trapezoid import (
    Trapezoid,
    hold_position_plan,
    hold_velocity_plan,
    trapezoid_position_plan,
    trapezoid_velocity_plan,
)
from ....calc.ramps.trapezoid import trapezoid_ramp
from ....calc.units.tmc4361 import CLOCK_HZ_DEFAULT, Units
from ....errors import UsageError
from ..ramp_parameters import number_of
from ..ramp_torque import torque_of
from ..schemas import Phase, Ramp, RampResult
from ..sramp_schemas import RampFinding, RampLimit, RampRegister, RampRival, RampTorque

VALUES = tuple(field.name for field in fields(SRamp) if field.name != "use_astart_and_vstart")
"""The parameters that are registers, by their names in lower case; VBREAK besides, of trapezoids."""
STATE = ("v_actual", "a_actual", "v_target")
FLAGS = ("use_astart_and_vstart", "direct_acc_val_en", "direct_bow_val_en")
CHOICES = {
    "ramp_mode": ("position", "velocity", "hold"),
    "shape": ("s", "trapezoid", "hold"),
    "rounding": ("none", "registers"),
}
_ALIASES = {"start_acceleration": "astart"}


@dataclass(frozen=True)
class RampRequest:
    """A request, understood.

    values : registers by parameter [pps, pps^2, pps^3], as the ramp is calculated with them
    asked : those that the request names, in its order
    """

    values: dict[str, float]
    asked: tuple[str, ...]
    units: Units
    mode: str
    shape: str
    use_astart_and_vstart: bool
    v_actual: float
    a_actual: float
    v_target: float
    positioning: bool


def s_ramp(body: Ramp) -> RampResult:
    """Answer model "s_ramp". Raises UsageError for names and kinds, ValueError for what cannot be planned."""
    wanted = _understood(body)
    motor = None if body.motor is None else StepperMotor(**body.motor.model_dump())
    plan = _plan(wanted, body.distance)
    curve = plan.curve(body.samples, None if wanted.positioning else _seen_s(plan, body.distance))
    findings = [_finding(warning) for warning in plan.warnings]
    findings += [
        RampFinding(code="limit", parameter=name, text=text)
        for name in wanted.asked
        for text in wanted.units.warnings(name.upper(), wanted.values[name], wanted.positioning)
    ]
    torque = None if motor is None else torque_of(motor, curve, wanted.values["vmax"])
    return RampResult(
        duration_s=curve.duration_s,
        phases=[Phase.model_validate(phase) for phase in curve.phases],
        time_s=curve.time_s.tolist(),
        position=curve.position.tolist(),
        velocity_pps=curve.velocity_pps.tolist(),
        acceleration_pps2=curve.acceleration_pps2.tolist(),
        jerk_pps3=curve.jerk_pps3.tolist(),
        overshoot_steps=curve.overshoot_steps,
        warnings=[finding.text for finding in findings],
        limits=[RampLimit.model_validate(limit) for limit in plan.limits],
        findings=findings,
        registers=[_register(name, wanted) for name in wanted.asked],
        rivals=_rivals(wanted, plan, body.distance, motor, torque),
        torque=torque,
    )


def planned(body: Ramp) -> tuple[SRampPlan, float]:
    """The motion of a request, and until when it is looked at [s]. Raises what `s_ramp` raises."""
    wanted = _understood(body)
    plan = _plan(wanted, body.distance)
    return plan, plan.duration_s if wanted.positioning else _seen_s(plan, body.distance)


def _understood(body: Ramp) -> RampRequest:
    given = dict(body.parameters)
    known = (*VALUES, "vbreak", *STATE, *FLAGS, *CHOICES, "clock_hz")
    unknown = [name for name in given if name not in known]
    if unknown:
        raise UsageError(f"there is no parameter {unknown[0]!r}; known: {', '.join(known)}")
    mode, shape, rounding = (_choice(name, given) for name in CHOICES)
    if mode == "hold":
        mode, shape = "velocity" if "v_target" in given else "position", "hold"
    flags = {name: _flag(name, given.get(name, 0)) for name in FLAGS}
    units = Units(
        number_of("clock_hz", given.get("clock_hz", CLOCK_HZ_DEFAULT)),
        flags["direct_acc_val_en"],
        flags["direct_bow_val_en"],
    )
    asked = tuple(name for name in (*VALUES, "vbreak") if name in given)
    values = {name: number_of(name, given[name]) for name in asked}
    for name in asked:
        raw = units.to_raw(name.upper(), values[name])  # also what is not rounded has to fit
        if rounding == "registers":
            values[name] = units.from_raw(name.upper(), raw)
    _complete(values, shape)
    v_target = number_of("v_target", given.get("v_target", math.copysign(values["vmax"], body.distance)))
    units.to_raw("VMAX", v_target)
    return RampRequest(
        values=values,
        asked=asked,
        units=units,
        mode=mode,
        shape=shape,
        use_astart_and_vstart=flags["use_astart_and_vstart"],
        v_actual=number_of("v_actual", given.get("v_actual", 0.0)),
        a_actual=number_of("a_actual", given.get("a_actual", 0.0)),
        v_target=v_target,
        positioning=mode == "position",
    )


def _complete(values: dict[str, float], shape: str) -> None:
    """Parameters that follow from others where they are left out. Raises UsageError for what does not."""
    needed = {"s": ("vmax", "amax", "bow1"), "trapezoid": ("vmax", "amax"), "hold": ("vmax",)}[shape]
    missing = [name for name in needed if name not in values]
    if missing:
        raise UsageError(f"missing parameters: {', '.join(missing)}")
    if "amax" in values:
        values.setdefault("dmax", values["amax"])
    if "bow1" in values:
        for name in ("bow2", "bow3", "bow4"):
            values.setdefault(name, values["bow1"])


def _plan(wanted: RampRequest, distance: float) -> SRampPlan:
    values, state = wanted.values, (wanted.v_actual, wanted.a_actual)
    if wanted.shape == "hold":
        return (
            hold_position_plan(values["vmax"], distance) if wanted.positioning else hold_velocity_plan(wanted.v_target)
        )
    if wanted.shape == "trapezoid":
        trapezoid = Trapezoid(**{field.name: values[field.name] for field in fields(Trapezoid) if field.name in values})
        if wanted.positioning:
            return trapezoid_position_plan(trapezoid, distance, *state)
        return trapezoid_velocity_plan(trapezoid, wanted.v_target, *state)
    ramp = SRamp(
        **{name: values[name] for name in VALUES if name in values},
        use_astart_and_vstart=wanted.use_astart_and_vstart,
    )
    if wanted.positioning:
        return position_plan(ramp, distance, *state)
    return velocity_plan(ramp, wanted.v_target, *state)


def _seen_s(plan: SRampPlan, distance: float) -> float:
    """Until the velocity is reached and the distance is behind, whichever is later."""
    speed = abs(plan.end_velocity_pps)
    left = abs(distance) - abs(plan.end_position)
    return plan.duration_s + (max(left, 0.0) / speed if speed else 0.0)


def _finding(warning: RampWarning) -> RampFinding:
    """The planner's codes begin with the parameter that they are about."""
    named = [name for name in (*VALUES, "vbreak") if warning.code.startswith(f"{name}_")]
    named += [alias for code, alias in _ALIASES.items() if warning.code.startswith(f"{code}_")]
    return RampFinding(code=warning.code, parameter=named[0] if named else None, text=warning.text)


def _register(name: str, wanted: RampRequest) -> RampRegister:
    register = name.upper()
    limits = wanted.units.limits(register)
    raw = wanted.units.to_raw(register, wanted.values[name])
    return RampRegister(
        parameter=name,
        name=register,
        raw=raw,
        value=wanted.units.from_raw(register, raw),
        least=limits.least,
        highest=limits.highest,
        why_highest=limits.why,
        unit=limits.quantity.unit,
    )


def _rivals(
    wanted: RampRequest, plan: SRampPlan, distance: float, motor: StepperMotor | None, torque: RampTorque | None
) -> list[RampRival]:
    """Only a move from rest has rivals: what comes before decides the others."""
    if not wanted.positioning or wanted.shape != "s" or wanted.v_actual or wanted.a_actual or not distance:
        return []
    vmax, amax, dmax = (wanted.values[name] for name in ("vmax", "amax", "dmax"))
    same = FastMove(trapezoid_ramp(vmax, amax, dmax, distance, 2).duration_s, vmax, amax, dmax)
    found = [("trapezoid", "the same VMAX, AMAX and DMAX, without bows: what the bows cost", same)]
    if motor is not None and torque is not None:
        # a ramp that asks too much has no margin that others could keep to: they then use all there is
        margin = max(torque.margin, 0.0)
        kept = f"leaving the motor {margin:.0%} of its torque" if margin else "with all the motor's torque"
        trapezoid = fastest_trapezoid(motor, distance, vmax, margin)
        limit = fastest_move(motor, distance, vmax, margin)
        if trapezoid is not None:
            found.append(("motor_trapezoid", f"the fastest trapezoid up to VMAX, {kept} as this ramp does", trapezoid))
        if limit is not None:
            found.append(("motor_limit", f"at every speed as fast as the motor can, {kept}: no ramp is faster", limit))
    return [
        RampRival(
            name=name,
            text=text,
            duration_s=move.duration_s,
            saved_s=move.duration_s - plan.duration_s,
            vmax_pps=move.vmax,
            amax_pps2=move.amax,
            dmax_pps2=move.dmax,
        )
        for name, text, move in found
    ]


def _choice(name: str, given: Mapping[str, float | str]) -> str:
    allowed = CHOICES[name]
    value = given.get(name, allowed[0])
    if value not in allowed:
        raise UsageError(f"{name} of an s_ramp is {', '.join(allowed)}, not {value!r}")
    return str(value)


def _flag(name: str, value: float | str) -> bool:
    if value not in (0, 1):
        raise UsageError(f"{name} is 0 or 1, not {value!r}")
    return bool(value)
