"""The other two ramp types of the TMC4361, as the same kind of plan: the trapezoid with VBREAK, and hold mode.

    phase         A1L     A1     A2  A3     A3L       (v > 0, signs flip for v < 0)
    acceleration  ASTART  AMAX   0   -DMAX  -DFINAL
    where |v|     < VBREAK       VMAX       < VBREAK

VBREAK = 0 leaves A1L and A3L out. The ramp keeps VMAX as long as possible, and positioning ends exactly on the target
(DS-TMC4361 8.2). A motor under way that gets another target or velocity goes on from its velocity; a reversal runs
through velocity 0 without VSTART and VSTOP (DS-TMC4361 8.2.1). A motor that brakes and would have to accelerate again
in the same direction first brakes down to 0, and then starts regularly (DS-TMC4361 8.2.2): `a_actual` against
`v_actual` says that it brakes.

Source: DS-TMC4361 8.2, 8.2.1, 8.2.2; NOTES-TMC4361-RAMPS 2 and 3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from itertools import accumulate, pairwise
from typing import NamedTuple

from .sramp import check_distance, check_state
from .sramp_plan import JerkPiece, LimitUse, RampWarning, SRampPlan, overshoot_of
from .sramp_warnings import warning

# Relative: a way that is shorter than the braking distance by less than this was meant to be just as long.
_ALMOST = 1e-12
_SAME = 1e-9


@dataclass(frozen=True)
class Trapezoid:
    """Velocities [pps] and accelerations [pps^2] of a trapezoid; none negative, vmax, amax and dmax above 0.

    vbreak : below it ASTART and DFINAL hold, which then are above 0 where the ramp gets to them

    Raises ValueError for a number below 0 or not finite, and for a 0 with which the motor never gets anywhere.
    """

    vmax: float
    amax: float
    dmax: float
    vstart: float = 0.0
    vstop: float = 0.0
    vbreak: float = 0.0
    astart: float = 0.0
    dfinal: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            number = getattr(self, field.name)
            if not (math.isfinite(number) and number >= 0):
                raise ValueError(f"{field.name} is finite and not below 0, got {number}")
        for name in ("vmax", "amax", "dmax"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} is above 0: with 0 the motor never gets anywhere")
        if self.vbreak > self.vstart and not self.astart:
            raise ValueError("astart is above 0 where VBREAK is above VSTART: with 0 the motor never starts")
        if self.vbreak > self.vstop and not self.dfinal:
            raise ValueError("dfinal is above 0 where VBREAK is above VSTOP: with 0 the motor never stops")


def trapezoid_position_plan(p: Trapezoid, distance: float, v_actual: float = 0.0, a_actual: float = 0.0) -> SRampPlan:
    """A move by `distance` [microsteps, signed] from velocity `v_actual` [pps].

    a_actual : only its sign counts: a motor that brakes does not accelerate again before it stands [pps^2]

    Raises ValueError: |distance| of 2^32 or more, anything not finite, an ASTART or DFINAL of 0 that is needed.
    """
    check_distance(distance)
    check_state(v_actual, a_actual)
    distance, v_actual = float(distance), float(v_actual)
    warnings = _of_parameters(p)
    legs, first_anchored, stops_first = _onto(p, distance, v_actual, a_actual * v_actual < 0)
    if stops_first:
        warnings.append(warning("stops_first"))
    pieces = _pieces(legs, min(first_anchored, max(len(legs) - 1, 0)), distance)
    overshoot = overshoot_of(pieces, distance)
    if overshoot and v_actual:
        warnings.append(warning("target_overshoot", overshoot))
    elif overshoot:
        warnings.append(warning("vstart_overshoot", p.vstart, overshoot))
    limits = _limits(p, legs, p.vmax)
    if pieces and limits[0].peak < p.vmax * (1 - _SAME):
        warnings.append(warning("vmax_not_reached", p.vmax, limits[0].peak))
    return SRampPlan(
        pieces=pieces,
        duration_s=pieces[-1].end_s if pieces else 0.0,
        end_position=distance,
        end_velocity_pps=0.0,
        target=distance,
        warnings=tuple(warnings),
        limits=limits,
    )


def trapezoid_velocity_plan(p: Trapezoid, v_target: float, v_actual: float = 0.0, a_actual: float = 0.0) -> SRampPlan:
    """From velocity `v_actual` to `v_target` [pps, signed], and on at that; `v_target` stands for VMAX.

    a_actual : only its sign counts, as in positioning [pps^2]

    Raises ValueError for anything not finite, and for an ASTART or DFINAL of 0 that is needed.
    """
    check_state(v_actual, a_actual)
    if not math.isfinite(v_target):
        raise ValueError(f"v_target is finite, got {v_target}")
    warnings = _of_parameters(p)
    way = math.copysign(1.0, v_actual or v_target)
    speed, wanted = abs(v_actual), way * v_target
    legs: list[_Leg] = []
    if wanted < 0:  # through velocity 0 without VSTOP and VSTART
        legs += _mirrored(_slope(p, speed, 0.0), way)
        way, speed, wanted = -way, 0.0, -wanted
    elif speed and a_actual * v_actual < 0 and wanted > speed:
        warnings.append(warning("stops_first"))
        legs += _mirrored(_slope(p, speed, 0.0), way)
        speed = min(p.vstart, wanted)
    elif not speed:
        speed = min(p.vstart, wanted)
    legs += _mirrored(_slope(p, speed, wanted) if wanted else _braking(p, speed), way)
    pieces = _pieces(legs, len(legs), 0.0)
    return SRampPlan(
        pieces=pieces,
        duration_s=pieces[-1].end_s if pieces else 0.0,
        end_position=pieces[-1].position_at(pieces[-1].end_s) if pieces else 0.0,
        end_velocity_pps=float(v_target),
        warnings=tuple(warnings),
        limits=_limits(p, legs, abs(v_target)),
    )


def hold_position_plan(vmax: float, distance: float) -> SRampPlan:
    """A rectangle: VMAX at once, and 0 at once at the target (DS-TMC4361 8.2; keep VMAX within fCLK / 4 there).

    vmax : above 0 [pps]. distance : signed [microsteps]

    Raises ValueError for a vmax that is not above 0 and finite, and |distance| of 2^32 or more.
    """
    check_distance(distance)
    if not (vmax > 0 and math.isfinite(vmax)):
        raise ValueError(f"vmax is above 0 and finite, got {vmax}")
    velocity, duration_s = math.copysign(vmax, distance), abs(distance) / vmax
    piece = JerkPiece("HOLD", 0.0, duration_s, duration_s, float(distance), velocity, 0.0, 0.0)
    return SRampPlan(
        pieces=(piece,) if duration_s else (),
        duration_s=duration_s,
        end_position=float(distance),
        end_velocity_pps=0.0,
        target=float(distance),
        limits=(LimitUse("VMAX", vmax, vmax if duration_s else 0.0, "pps"),),
    )


def hold_velocity_plan(v_target: float) -> SRampPlan:
    """Velocity `v_target` [pps, signed] at once, whatever it was before. Raises ValueError where it is not finite."""
    if not math.isfinite(v_target):
        raise ValueError(f"v_target is finite, got {v_target}")
    limits = (LimitUse("VMAX", abs(v_target), abs(v_target), "pps"),)
    return SRampPlan((), 0.0, 0.0, float(v_target), limits=limits)


# --- how it is worked out -------------------------------------------------------------------------


class _Leg(NamedTuple):
    """A stretch from velocity `start` to `end` [pps] with constant acceleration [pps^2], `time_s` long."""

    name: str
    start: float
    end: float
    acceleration: float
    time_s: float

    @property
    def length(self) -> float:
        return (self.start + self.end) / 2 * self.time_s


def _onto(p: Trapezoid, distance: float, v: float, brakes: bool, passing: bool = False) -> tuple[list[_Leg], int, bool]:
    """Legs onto a target, from which of them on they are counted back from it, and whether the motor stops first.

    brakes : it is braking now. passing : velocity 0 is no standstill, so VSTART has no part in it
    """
    way = math.copysign(1.0, v or distance)
    left, speed = way * distance, abs(v)
    if left == 0 and speed <= p.vstop:
        return [], 0, False
    if not speed and not passing:
        speed = min(p.vstart, p.vmax)
    stopping = _length(_braking(p, speed))
    if stopping > left * (1 + _ALMOST):  # away from the target, or too fast for it
        to_rest = _slope(p, speed, 0.0)
        legs, first_anchored, _ = _onto(p, distance - way * _length(to_rest), 0.0, brakes=False, passing=True)
        return _mirrored(to_rest, way) + legs, len(to_rest) + first_anchored, False
    if brakes and speed < p.vmax and stopping < left * (1 - _ALMOST):
        to_rest = _slope(p, speed, 0.0)
        if _length(to_rest) >= left:  # at the target with VSTOP or less
            to_rest = _first(to_rest, left)
            return _mirrored(to_rest, way), len(to_rest), False
        legs, first_anchored, _ = _onto(p, distance - way * _length(to_rest), 0.0, brakes=False)
        return _mirrored(to_rest, way) + legs, len(to_rest) + first_anchored, True
    before, braking = _arrival(p, left, speed)
    return _mirrored(before + braking, way), len(before), False


def _arrival(p: Trapezoid, left: float, speed: float) -> tuple[list[_Leg], list[_Leg]]:
    """From a speed that is not too high onto a target `left` ahead: what comes before the last braking, and that."""
    fastest = _slope(p, speed, p.vmax)
    braking = _braking(p, p.vmax)
    cruise = left - _length(fastest) - _length(braking)
    if cruise >= 0 or speed >= p.vmax:
        return [*fastest, _Leg("A2", p.vmax, p.vmax, 0.0, max(cruise, 0.0) / p.vmax)], braking
    lowest = max(speed, min(p.vstop, p.vmax))
    rise = _slope(p, speed, lowest)
    if _length(rise) >= left:  # at the target with VSTOP or less
        return _first(rise, left), []
    # between two marks the way up and down is a line over the square of the highest velocity
    marks = [lowest, *([p.vbreak] if lowest < p.vbreak < p.vmax else []), p.vmax]
    for below, above in pairwise(marks):
        if above < p.vmax and _length(_slope(p, speed, above)) + _length(_braking(p, above)) < left:
            continue
        done = _length(_slope(p, speed, below)) + _length(_braking(p, below))
        per_square = (1 / _rate(p, True, below)[1] + 1 / _rate(p, False, below)[1]) / 2
        lowest = math.sqrt(below * below + max(left - done, 0.0) / per_square)
        break
    return _slope(p, speed, lowest), _braking(p, lowest)


def _rate(p: Trapezoid, rising: bool, speed: float) -> tuple[str, float]:
    """Phase and acceleration just above a speed. Raises ValueError where it is 0."""
    if speed >= p.vbreak:
        return ("A1", p.amax) if rising else ("A3", p.dmax)
    name, rate = ("A1L", p.astart) if rising else ("A3L", p.dfinal)
    if not rate:
        register = "astart" if rising else "dfinal"
        raise ValueError(f"{register} is above 0 where the ramp gets below VBREAK: with 0 the velocity never changes")
    return name, rate


def _slope(p: Trapezoid, start: float, end: float) -> list[_Leg]:
    """From one speed to another, up or down."""
    rising = end > start
    low, high = min(start, end), max(start, end)
    legs = []
    for below, above in pairwise([low, *([p.vbreak] if low < p.vbreak < high else []), high]):
        if above > below:
            name, rate = _rate(p, rising, below)
            time_s = (above - below) / rate
            legs.append(_Leg(name, below, above, rate, time_s) if rising else _Leg(name, above, below, -rate, time_s))
    return legs if rising else legs[::-1]


def _braking(p: Trapezoid, speed: float) -> list[_Leg]:
    """Down to where VSTOP ends the ramp."""
    return _slope(p, speed, p.vstop) if speed > p.vstop else []


def _length(legs: list[_Leg]) -> float:
    return math.fsum(leg.length for leg in legs)


def _first(legs: list[_Leg], way: float) -> list[_Leg]:
    """The first `way` of these legs, all forward."""
    kept = []
    for leg in legs:
        if leg.length >= way:
            end = math.sqrt(max(leg.start**2 + 2 * leg.acceleration * way, 0.0))
            kept.append(leg._replace(end=end, time_s=2 * way / (leg.start + end)))
            break
        kept.append(leg)
        way -= leg.length
    return kept


def _mirrored(legs: list[_Leg], way: float) -> list[_Leg]:
    return [_Leg(name, way * start, way * end, way * a, time_s) for name, start, end, a, time_s in legs]


def _pieces(legs: list[_Leg], first_anchored: int, target: float) -> tuple[JerkPiece, ...]:
    """In time and place; from `first_anchored` on counted back from the target."""
    ends = list(accumulate((leg.length for leg in legs), initial=0.0))[1:]
    end = target
    for i in range(len(legs) - 1, first_anchored - 1, -1):
        ends[i] = end
        end -= legs[i].length
    pieces = []
    start_s = place = 0.0
    for i, leg in enumerate(legs):
        end_s = start_s + leg.time_s
        if end_s > start_s and i < first_anchored:
            pieces.append(JerkPiece(leg.name, start_s, end_s, start_s, place, leg.start, leg.acceleration, 0.0))
        elif end_s > start_s:
            pieces.append(JerkPiece(leg.name, start_s, end_s, end_s, ends[i], leg.end, leg.acceleration, 0.0))
        start_s, place = end_s, ends[i]
    return tuple(pieces)


def _limits(p: Trapezoid, legs: list[_Leg], vmax: float) -> tuple[LimitUse, ...]:
    fastest = max((max(abs(leg.start), abs(leg.end)) for leg in legs), default=0.0)
    peak = {
        name: max((abs(leg.acceleration) for leg in legs if leg.name == name), default=0.0) for name in ("A1", "A3")
    }
    return (
        LimitUse("VMAX", vmax, fastest, "pps"),
        LimitUse("AMAX", p.amax, peak["A1"], "pps^2"),
        LimitUse("DMAX", p.dmax, peak["A3"], "pps^2"),
    )


def _of_parameters(p: Trapezoid) -> list[RampWarning]:
    found = []
    if p.dmax <= p.vmax / 20:
        found.append(warning("dmax_too_slow", p.dmax, p.vmax))
    if p.vbreak and p.vbreak <= p.vstop:
        found.append(warning("vbreak_not_above_vstop", p.vbreak, p.vstop))
    return found
