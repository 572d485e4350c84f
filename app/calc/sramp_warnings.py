"""What the data sheet warns of, and which limits a ramp cannot use (002, 8.2.2)."""

from __future__ import annotations

import math

from app.calc.sramp_parameters import SRamp
from app.calc.sramp_plan import RampWarning, SRampPlan

# Relative: what differs by less is the same.
_SAME = 1e-9


def position_warnings(p: SRamp, plan: SRampPlan, v_actual: float, a_actual: float) -> tuple[RampWarning, ...]:
    """For a move planned with `p` from the given state [pps, pps^2]."""
    from_rest = v_actual == a_actual == 0
    found = _of_parameters(p, p.vmax)
    if from_rest:
        found += _of_start(p, plan, p.vmax)
        if p.vstart > p.vstop:
            text = f"VSTART {p.vstart:g} is above VSTOP {p.vstop:g} pps: a short move may pass its target"
            found.append(RampWarning("vstart_above_vstop", text))
    if plan.overshoot:
        cause = (
            f"VSTART {p.vstart:g} pps is too fast to stop within so short a move"
            if from_rest
            else "the motor is too fast to stop before the target"
        )
        text = f"{cause}: it runs {plan.overshoot:.6g} microsteps beyond and comes back"
        found.append(RampWarning("vstart_overshoot" if from_rest else "target_overshoot", text))
    peak = plan.limits[0].peak
    if plan.pieces and peak < p.vmax * (1 - _SAME):
        text = f"VMAX {p.vmax:g} pps is not reached: the way is enough for {peak:.6g} pps"
        found.append(RampWarning("vmax_not_reached", text))
    return tuple(found + _of_excess(plan, p.vmax, v_actual))


def velocity_warnings(p: SRamp, plan: SRampPlan, v_actual: float, a_actual: float) -> tuple[RampWarning, ...]:
    """For a change of velocity planned with `p` from the given state [pps, pps^2]."""
    target = abs(plan.end_velocity_pps)
    found = _of_parameters(p, max(target, abs(v_actual)))
    if v_actual == a_actual == 0 and target:
        found += _of_start(p, plan, target)
    if not target and not p.vstop and p.dfinal > p.dmax:
        found.append(
            RampWarning("dfinal_above_dmax", f"DFINAL {p.dfinal:g} is above DMAX {p.dmax:g} pps^2: DMAX holds")
        )
    return tuple(found + _of_excess(plan, max(target, abs(v_actual)), v_actual))


def _of_parameters(p: SRamp, vmax: float) -> list[RampWarning]:
    """Bows so small that a whole slope between 0 and `vmax` does not get to the limit of its acceleration."""
    found = []
    slopes = (
        ("amax", p.amax, max(vmax - p.vstart, 0.0), "BOW1 and BOW2", p.bow1, p.bow2, p.start_acceleration),
        ("dmax", p.dmax, max(vmax - p.vstop, 0.0), "BOW3 and BOW4", p.bow3, math.inf if p.vstop else p.bow4, 0.0),
    )
    for name, limit, height, bows, rising, falling, begin in slopes:
        peak = math.sqrt((2 * height + begin**2 / rising) / (1 / rising + 1 / falling))
        if 0 < peak < limit * (1 - _SAME):
            text = f"{name.upper()} {limit:g} pps^2 is out of reach: {bows} get to {peak:.6g} before {vmax:g} pps"
            found.append(RampWarning(f"{name}_out_of_reach", text))
    return found


def _of_start(p: SRamp, plan: SRampPlan, target: float) -> list[RampWarning]:
    found = []
    if p.vstart > target:
        text = f"VSTART {p.vstart:g} is above VMAX {target:g} pps: the motor starts with VMAX"
        found.append(RampWarning("vstart_above_vmax", text))
    if p.astart > p.amax and (not p.vstart or p.use_astart_and_vstart):
        found.append(
            RampWarning("astart_above_amax", f"ASTART {p.astart:g} is above AMAX {p.amax:g} pps^2: AMAX holds")
        )
    wanted = p.start_acceleration
    if plan.pieces:
        used = abs(plan.pieces[0].acceleration_at(0.0))
        if used < wanted * (1 - _SAME):
            text = (
                f"a start with {wanted:g} pps^2 does not fit VMAX, BOW2 and the way: it is altered to {used:.6g} "
                "(002, 8.2.2)"
            )
            found.append(RampWarning("start_acceleration_altered", text))
    return found


def _of_excess(plan: SRampPlan, allowed: float, v_actual: float) -> list[RampWarning]:
    peak = plan.limits[0].peak
    if peak > max(allowed, abs(v_actual)) * (1 + _SAME):
        text = (
            f"the velocity goes up to {peak:.6g} pps, above the wanted {allowed:g}: "
            "a begun bow is ended first (002, 8.2.2)"
        )
        return [RampWarning("vmax_exceeded", text)]
    return []
