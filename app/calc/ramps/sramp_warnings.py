"""What the data sheet warns of, and which limits a ramp cannot use (DS-TMC4361 8.2.2)."""

from __future__ import annotations

import math
from collections.abc import Sequence

from .sramp_parameters import SRamp
from .sramp_plan import JerkPiece, RampWarning, overshoot_of

# Relative: what differs by less is the same.
_SAME = 1e-9

_TEXTS = {
    "amax_out_of_reach": "AMAX {} pps^2 is out of reach: BOW1 and BOW2 get to {} before {} pps",
    "dmax_out_of_reach": "DMAX {} pps^2 is out of reach: BOW3 and BOW4 get to {} from {} pps",
    "vmax_not_reached": "VMAX {} pps is not reached: the way is enough for {} pps",
    "vmax_exceeded": "the velocity goes up to {} pps, above {}: a begun bow is ended first (DS-TMC4361 8.2.2)",
    "target_overshoot": "too fast to stop before the target: the motor runs {} microsteps beyond and comes back",
    "vstart_overshoot": "VSTART {} pps is too fast for so short a move: the motor runs {} microsteps beyond "
    "its target and comes back",
    "vstart_above_vstop": "VSTART {} is above VSTOP {} pps: a short move may pass its target",
    "vstart_above_vmax": "VSTART {} is above VMAX {} pps: the motor starts with VMAX",
    "astart_above_amax": "ASTART {} is above AMAX {} pps^2: AMAX holds",
    "dfinal_above_dmax": "DFINAL {} is above DMAX {} pps^2: DMAX holds",
    "start_acceleration_altered": "a start with {} pps^2 does not fit VMAX, BOW2 and the way: it is altered to "
    "{} (DS-TMC4361 8.2.2)",
    "dmax_too_slow": "DMAX {} pps^2 is not above VMAX {} pps / 20 s: the target may be overrun; set VSTOP "
    "(DS-TMC4361 8.2.2)",
    "stops_first": "the motor is braking, and a trapezoid brakes down to 0 before it accelerates again in the same "
    "direction; to avoid it set VMAX below |VACTUAL| first, and raise it when that is reached (DS-TMC4361 8.2.2)",
    "vbreak_not_above_vstop": "VBREAK {} is not above VSTOP {} pps: DFINAL has no part in it",
}


def warning(code: str, *values: float) -> RampWarning:
    """One of those above."""
    return RampWarning(code, _TEXTS[code], values)


def position_warnings(
    p: SRamp, pieces: Sequence[JerkPiece], peak: float, target: float, v_actual: float, a_actual: float
) -> tuple[RampWarning, ...]:
    """For a move by `target` [microsteps] of these pieces, from the given state [pps, pps^2]; `peak` [pps]."""
    from_rest = v_actual == a_actual == 0
    found = _of_parameters(p, p.vmax)
    if from_rest:
        found += _of_start(p, pieces, p.vmax)
        if p.vstart > p.vstop:
            found.append(warning("vstart_above_vstop", p.vstart, p.vstop))
    overshoot = overshoot_of(pieces, target) if p.vstart or not from_rest else 0.0
    if overshoot and from_rest:
        found.append(warning("vstart_overshoot", p.vstart, overshoot))
    elif overshoot:
        found.append(warning("target_overshoot", overshoot))
    if pieces and peak < p.vmax * (1 - _SAME):
        found.append(warning("vmax_not_reached", p.vmax, peak))
    return tuple(found + _of_excess(peak, p.vmax, v_actual))


def velocity_warnings(
    p: SRamp, pieces: Sequence[JerkPiece], peak: float, v_target: float, v_actual: float, a_actual: float
) -> tuple[RampWarning, ...]:
    """For a change to `v_target` [pps] of these pieces, from the given state [pps, pps^2]; `peak` [pps]."""
    target = abs(v_target)
    found = _of_parameters(p, max(target, abs(v_actual)))
    if v_actual == a_actual == 0 and target:
        found += _of_start(p, pieces, target)
    if not target and not p.vstop and p.dfinal > p.dmax:
        found.append(warning("dfinal_above_dmax", p.dfinal, p.dmax))
    return tuple(found + _of_excess(peak, max(target, abs(v_actual)), v_actual))


def _of_parameters(p: SRamp, vmax: float) -> list[RampWarning]:
    """Bows so small that a whole slope between rest and `vmax` does not get to the limit of its acceleration."""
    found = []
    begin = p.start_acceleration
    squared = (2 * max(vmax - p.vstart, 0.0) + begin**2 / p.bow1) / (1 / p.bow1 + 1 / p.bow2)
    if 0 < squared < (p.amax * (1 - _SAME)) ** 2:
        found.append(warning("amax_out_of_reach", p.amax, math.sqrt(squared), vmax))
    squared = 2 * max(vmax - p.vstop, 0.0) / (1 / p.bow3 + (0.0 if p.vstop else 1 / p.bow4))
    if 0 < squared < (p.dmax * (1 - _SAME)) ** 2:
        found.append(warning("dmax_out_of_reach", p.dmax, math.sqrt(squared), vmax))
    return found


def _of_start(p: SRamp, pieces: Sequence[JerkPiece], target: float) -> list[RampWarning]:
    found = []
    if p.vstart > target:
        found.append(warning("vstart_above_vmax", p.vstart, target))
    if p.astart > p.amax and (not p.vstart or p.use_astart_and_vstart):
        found.append(warning("astart_above_amax", p.astart, p.amax))
    wanted = p.start_acceleration
    if pieces and wanted:
        used = abs(pieces[0].acceleration_at(0.0))
        if used < wanted * (1 - _SAME):
            found.append(warning("start_acceleration_altered", wanted, used))
    return found


def _of_excess(peak: float, allowed: float, v_actual: float) -> list[RampWarning]:
    if peak > max(allowed, abs(v_actual)) * (1 + _SAME):
        return [warning("vmax_exceeded", peak, allowed)]
    return []
