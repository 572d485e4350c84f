"""The S-ramp of the TMC4361 in continuous time, exact: seven phases with four bows, from rest or from any state.

    phase         B1          B12   B2       B23  B3        B34    B4
    acceleration  ASTART..AMAX AMAX  AMAX..0  0   0..-DMAX  -DMAX  -DMAX..-DFINAL     (v > 0, signs flip for v < 0)
    jerk          BOW1        0     -BOW2    0    -BOW3     0      BOW4

Slopes are as fast as the limits allow, VMAX is kept as long as possible, positioning ends exactly on the target
(DS-TMC4361 8.2). The chip works this out every 64 clocks; this is what its units and rules mean, without its rounding.

What the data sheet leaves open, and the reading here:
- ASTART and VSTART belong to a start from rest, VSTOP and DFINAL to a stop at rest (DS-TMC4361 8.2.1 says so of
  VSTART and VSTOP). A slope from one velocity to another begins and ends with acceleration 0.
- A reversal runs through velocity 0 on one slope: until there it brakes (DMAX, BOW3, BOW4), from there it
  accelerates (AMAX, BOW1, BOW2).
- "The starting acceleration becomes altered" where the slope does not fit VMAX (8.2.2): it is lowered until BOW2 ends
  on VMAX; in a short move until the move ends on the target.
- VSTOP while positioning: the velocity at the target is at most VSTOP, the acceleration whatever it is there.

Source: DS-TMC4361 8.2, 8.2.1, 8.2.2.
"""

from __future__ import annotations

import math

import numpy as np

from . import sramp_kernel as kernel
from .curve import FloatArray
from .sramp_parameters import SRamp, default_bow
from .sramp_plan import JerkPiece, LimitUse, RampWarning, SRampCurve, SRampMotion, SRampPlan
from .sramp_warnings import position_warnings, velocity_warnings

__all__ = [
    "JerkPiece",
    "LimitUse",
    "RampWarning",
    "SRamp",
    "SRampCurve",
    "SRampMotion",
    "SRampPlan",
    "default_bow",
    "position_plan",
    "velocity_plan",
    "warm_up",
]

POSITION_LIMIT = 1 << 32
"""Microsteps between the ends of the chip's 32-bit positions."""


def position_plan(p: SRamp, distance: float, v_actual: float = 0.0, a_actual: float = 0.0) -> SRampPlan:
    """A move by `distance` [microsteps, signed] from velocity `v_actual` [pps] and acceleration `a_actual` [pps^2].

    It ends at `distance` with acceleration 0, whatever DFINAL is (DS-TMC4361 8.2); with VSTOP the velocity there is
    at most that. A motor that runs the wrong way, or too fast to stop within `distance`, comes back to the target.

    Raises ValueError: |distance| of 2^32 or more, anything not finite.
    """
    check_distance(distance)
    check_state(v_actual, a_actual)
    distance, v_actual, a_actual = float(distance), float(v_actual), float(a_actual)
    table = np.empty((kernel.MOST_ROWS, kernel.COLUMNS))
    n, first_anchored = kernel.position(p.array, table, distance, v_actual, a_actual)
    rows = table[:n].tolist()
    pieces = _pieces(p, rows, first_anchored)
    limits = _limits(p, table, p.vmax)
    return SRampPlan(
        pieces=pieces,
        duration_s=pieces[-1].end_s if pieces else 0.0,
        end_position=distance,
        end_velocity_pps=0.0,
        target=distance,
        warnings=position_warnings(p, pieces, limits[0].peak, distance, v_actual, a_actual),
        limits=limits,
    )


def velocity_plan(p: SRamp, v_target: float, v_actual: float = 0.0, a_actual: float = 0.0) -> SRampPlan:
    """From velocity `v_actual` [pps] and acceleration `a_actual` [pps^2] to `v_target` [pps, signed], and on at that.

    `v_target` stands for VMAX, which has no other part here. With VSTOP a stop ends as soon as |v| is down to it;
    without, with acceleration DFINAL.

    Raises ValueError for anything not finite.
    """
    if not math.isfinite(v_target):
        raise ValueError(f"v_target is finite, got {v_target}")
    check_state(v_actual, a_actual)
    v_target, v_actual, a_actual = float(v_target), float(v_actual), float(a_actual)
    table = np.empty((kernel.MOST_ROWS, kernel.COLUMNS))
    n = kernel.velocity(p.array, table, v_target, v_actual, a_actual)
    rows = table[:n].tolist()
    pieces = _pieces(p, rows, n)
    limits = _limits(p, table, abs(v_target))
    return SRampPlan(
        pieces=pieces,
        duration_s=pieces[-1].end_s if pieces else 0.0,
        end_position=pieces[-1].position_at(pieces[-1].end_s) if pieces else 0.0,
        end_velocity_pps=v_target,
        warnings=velocity_warnings(p, pieces, limits[0].peak, v_target, v_actual, a_actual),
        limits=limits,
    )


def warm_up() -> None:
    """Compile the kernel, or load it from numba's cache on disk: seconds once, milliseconds after that.

    For a thread at start-up, so that the first request does not wait for it.
    """
    p = SRamp(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    position_plan(p, 1.0)
    velocity_plan(p, 1.0)


def check_distance(distance: float) -> None:
    """Raise ValueError unless it is finite and within the chip's positions."""
    if not (math.isfinite(distance) and abs(distance) < POSITION_LIMIT):
        raise ValueError(f"distance is below 2^32 microsteps, got {distance}")


def check_state(v_actual: float, a_actual: float) -> None:
    """Raise ValueError unless both are finite."""
    for name, number in (("v_actual", v_actual), ("a_actual", a_actual)):
        if not math.isfinite(number):
            raise ValueError(f"{name} is finite, got {number}")


def _pieces(p: SRamp, rows: list[list[float]], first_anchored: int) -> tuple[JerkPiece, ...]:
    """The kernel's rows in time; those from `first_anchored` on are counted back from the target."""
    least_s = 2 * math.ulp(sum(row[kernel.TIME] for row in rows))  # shorter ones come of rounding
    jerks = (p.bow1, 0.0, p.bow2, 0.0, p.bow3, 0.0, p.bow4)  # as in the registers, not as time and acceleration give it
    pieces = []
    start_s = 0.0
    for i, (phase, time_s, v0, a0, jerk, v1, a1, _, place) in enumerate(rows):
        if time_s > least_s:
            code = int(phase)
            end_s = start_s + time_s
            bow = math.copysign(jerks[code], jerk)
            if i < first_anchored:
                pieces.append(JerkPiece(kernel.PHASES[code], start_s, end_s, start_s, place, v0, a0, bow))
            else:
                pieces.append(JerkPiece(kernel.PHASES[code], start_s, end_s, end_s, place, v1, a1, bow))
            start_s = end_s
    return tuple(pieces)


def _limits(p: SRamp, rows: FloatArray, vmax: float) -> tuple[LimitUse, ...]:
    fastest, accelerating, braking = rows[kernel.PEAKS, :3].tolist()
    return (
        LimitUse("VMAX", vmax, fastest, "pps"),
        LimitUse("AMAX", p.amax, accelerating, "pps^2"),
        LimitUse("DMAX", p.dmax, braking, "pps^2"),
    )
