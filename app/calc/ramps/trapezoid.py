"""The ideal trapezoid: constant acceleration, constant speed, constant deceleration, in closed form."""

from __future__ import annotations

import math

import numpy as np

from .curve import Phase, RampCurve, check_samples


def trapezoid_ramp(
    v_max_pps: float, a_max_pps2: float, d_max_pps2: float, distance: float, samples: int = 1000
) -> RampCurve:
    """From rest to rest over `distance` [microsteps, any sign], accelerating and braking at rates of their own.

    v_max_pps : above 0 [pps]; a_max_pps2, d_max_pps2 : above 0 [pps^2], acceleration and deceleration
    samples : evenly spaced in time, the last one at the end

    Where `v_max_pps` is not reached, the curve is a triangle with its peak at
    sqrt(2 * |distance| * a * d / (a + d)). The acceleration of a sample is the one that follows it; 0 at the end.

    Raises ValueError outside these ranges.
    """
    for name, value in (("v_max_pps", v_max_pps), ("a_max_pps2", a_max_pps2), ("d_max_pps2", d_max_pps2)):
        if not (value > 0 and math.isfinite(value)):
            raise ValueError(f"{name} is above 0 and finite, got {value}")
    if not math.isfinite(distance):
        raise ValueError(f"distance is finite, got {distance}")
    check_samples(samples)
    way, length = math.copysign(1.0, distance), abs(distance)
    # product of roots, not root of a product: it neither overflows nor vanishes
    harmonic = 1 / (1 / a_max_pps2 + 1 / d_max_pps2)
    peak = math.sqrt(2 * length) * math.sqrt(harmonic)
    cruises = peak > v_max_pps
    peak = min(peak, v_max_pps)
    climb_s, fall_s = peak / a_max_pps2, peak / d_max_pps2
    climb, fall = peak * climb_s / 2, peak * fall_s / 2
    cruise_s = (length - climb - fall) / v_max_pps if cruises else 0.0
    brake_s = climb_s + cruise_s
    end_s = brake_s + fall_s
    if not math.isfinite(end_s * end_s * max(a_max_pps2, d_max_pps2)):
        raise ValueError("the move takes longer than a number can say: raise v_max_pps or the accelerations")

    time_s = np.linspace(0.0, end_s, samples)
    to_end_s = end_s - time_s
    climbing, falling = time_s < climb_s, time_s >= brake_s
    # measured from the end while braking, so that the move ends on the target and not beside it
    position = np.where(
        climbing,
        0.5 * a_max_pps2 * time_s**2,
        np.where(falling, length - 0.5 * d_max_pps2 * to_end_s**2, climb + peak * (time_s - climb_s)),
    )
    velocity = np.where(climbing, a_max_pps2 * time_s, np.where(falling, d_max_pps2 * to_end_s, peak))
    acceleration = np.where(climbing, a_max_pps2, np.where(falling, -d_max_pps2, 0.0))
    acceleration[-1] = 0.0
    named = (
        ("acceleration", 0.0, climb_s, 0.0, climb, 0.0, peak),
        ("constant velocity", climb_s, brake_s, climb, length - fall, peak, peak),
        ("deceleration", brake_s, end_s, length - fall, length, peak, 0.0),
    )
    return RampCurve(
        duration_s=end_s,
        shape=("trapezoid" if cruises else "triangle") if length else "rest",
        phases=tuple(
            Phase(name, start, end, way * x0, way * x1, way * v0, way * v1)
            for name, start, end, x0, x1, v0, v1 in named
            if end > start
        ),
        time_s=time_s,
        position=way * position,
        velocity_pps=way * velocity,
        acceleration_pps2=way * acceleration,
        overshoot_steps=0,
        settled=True,
    )
