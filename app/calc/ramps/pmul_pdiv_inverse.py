"""From wanted speed and acceleration to the registers that come nearest: dividers, v_max, a_max, usrs and the pair.

Source: DS-TMC428 8.14 for the rates and 8.7.1 for the limits.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...number_text import plain
from ..tmc428.chips import CHIPS
from ..units.mechanics import ACCELERATION_UNITS, RATE_UNITS, Mechanics
from ..units.tmc428 import MAX_ACCELERATION, MAX_DIVIDER, MAX_USRS, MAX_VELOCITY
from .pmul_pdiv_table import default_reduction, design_many

FloatArray = NDArray[np.float64]

# Rounding errors of this much of speed and acceleration are not worth dividers further apart, which brake less exactly.
_GOOD_ERRORS = 0.005, 0.03
# More than this is said as a warning.
_LARGE_ERROR = 0.02


@dataclass(frozen=True)
class RegisterSuggestion:
    """Register values for a wanted motion, and what they achieve.

    usrs : 0..6 for a TMC428, None for a TMC4210, whose driver decides about microsteps
    pmul (0..127), p_mul (128..255), pdiv : the pair for this acceleration
    achieved_velocity_pps, achieved_acceleration_pps2 : in microsteps of `mechanics`
    velocity_error, acceleration_error : achieved / wanted - 1 [-]
    mechanics : as given, with the microsteps of `usrs`
    """

    pulse_div: int
    ramp_div: int
    v_max: int
    a_max: int
    usrs: int | None
    pmul: int
    p_mul: int
    pdiv: int
    achieved_velocity_pps: float
    achieved_acceleration_pps2: float
    velocity_error: float
    acceleration_error: float
    mechanics: Mechanics
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class _Search:
    """All 14 x 14 dividers for one microstep resolution, as arrays [pulse_div, ramp_div]."""

    v_max: FloatArray
    a_max: FloatArray
    velocity_error: FloatArray
    acceleration_error: FloatArray
    fits_registers: NDArray[np.bool_]
    fits_limits: NDArray[np.bool_]


def inverse(
    model: str,
    velocity: float,
    acceleration: float,
    mechanics: Mechanics | None = None,
    clock_hz: float = 16e6,
    *,
    velocity_unit: str = "pps",
    acceleration_unit: str = "pps^2",
    reduction: float | None = None,
    good_errors: tuple[float, float] = _GOOD_ERRORS,
) -> RegisterSuggestion:
    """Registers for a wanted highest speed and acceleration.

    Parameters
    ----------
    model : one of `tmc428.chips`
    velocity, acceleration : above 0, in `velocity_unit` (a rate of `mechanics`) and `acceleration_unit`
    mechanics : the axis. Where neither unit counts microsteps, a TMC428 gets the finest `usrs` that reaches the
        speed; else, and for a TMC4210, the microsteps are those of `mechanics`.
    clock_hz : above 0 [Hz]
    reduction : as in `design`
    good_errors : of speed and acceleration, which are small [-]

    All results lie within the limits of a_max (DS-TMC428 8.7.1). Among those with small rounding errors (by default
    0.5 % of the speed, 3 % of the acceleration) the dividers that differ by one at most, where any a_max is safe, come
    first, then those that differ least; among these the largest v_max and a_max, which is the finest resolution. Where
    no error is small, the smallest.

    Raises ValueError for values or units out of range, and, naming the limit, where the registers cannot do it.
    """
    part = default_reduction(model) if reduction is None else reduction
    axis = mechanics if mechanics is not None else Mechanics()
    for name, value in (("velocity", velocity), ("acceleration", acceleration)):
        if not (value > 0 and np.isfinite(value)):
            raise ValueError(f"{name} is above 0 and finite, got {value}")
    if velocity_unit not in RATE_UNITS:
        raise ValueError(f"velocity unit is one of {', '.join(RATE_UNITS)}, got {velocity_unit!r}")
    if acceleration_unit not in ACCELERATION_UNITS:
        raise ValueError(f"acceleration unit is one of {', '.join(ACCELERATION_UNITS)}, got {acceleration_unit!r}")
    if not (clock_hz > 0 and np.isfinite(clock_hz)):
        raise ValueError(f"clock_hz is above 0 and finite, got {clock_hz}")
    counts_microsteps = velocity_unit == "pps" or acceleration_unit == "pps^2"
    fallback: tuple[float, RegisterSuggestion] | None = None
    refusals = []
    for usrs in _resolutions(model, axis, counts_microsteps):
        moved = axis if usrs is None else replace(axis, microsteps_per_full_step=1 << usrs)
        rate = moved.to_microsteps(velocity, velocity_unit)
        slope = moved.to_microsteps(acceleration, acceleration_unit)
        search = _search(rate, slope, clock_hz, part)
        if not search.fits_limits.any():
            refusals.append(_refusal(rate, slope, clock_hz, search, usrs))
            continue
        error, found = _best(search, moved, usrs, rate, slope, part, good_errors)
        if error <= 1:
            return found
        if fallback is None or error < fallback[0]:
            fallback = (error, found)
    if fallback is None:
        raise ValueError(refusals[-1])  # the coarsest resolution got farthest
    return fallback[1]


def _resolutions(model: str, mechanics: Mechanics, counts_microsteps: bool) -> list[int | None]:
    """Values of usrs to try, the finest first."""
    if not CHIPS[model].usrs:
        return [None]
    if not counts_microsteps:
        return list(range(MAX_USRS, -1, -1))
    microsteps = mechanics.microsteps_per_full_step
    usrs = microsteps.bit_length() - 1
    if microsteps != 1 << usrs or usrs > MAX_USRS:
        raise ValueError(f"microsteps_per_full_step of a {model.upper()} is 1, 2, 4, 8, 16, 32 or 64, got {microsteps}")
    return [usrs]


def _search(rate: float, slope: float, clock_hz: float, reduction: float) -> _Search:
    pulse_div, ramp_div = np.mgrid[0 : MAX_DIVIDER + 1, 0 : MAX_DIVIDER + 1].astype(np.int64)
    velocity = np.ldexp(rate / clock_hz, pulse_div + 16)
    acceleration = np.ldexp(slope / clock_hz / clock_hz, pulse_div + ramp_div + 29)
    # half a unit beyond full scale still rounds to it
    v_max = np.where(velocity <= MAX_VELOCITY + 0.5, np.minimum(np.rint(velocity), MAX_VELOCITY), MAX_VELOCITY + 1)
    a_max = np.minimum(np.rint(acceleration), MAX_ACCELERATION + 1)
    a_max = np.where(acceleration <= MAX_ACCELERATION + 0.5, np.minimum(a_max, MAX_ACCELERATION), a_max)
    registers = (v_max >= 1) & (v_max <= MAX_VELOCITY) & (a_max >= 1) & (a_max <= MAX_ACCELERATION)
    difference = ramp_div - pulse_div
    lower = np.maximum(np.exp2(difference - 1 - (v_max <= 1448)), 1)
    upper = np.exp2(difference + 12) - 1
    pair = design_many(np.where(registers, a_max, 0), ramp_div, pulse_div, reduction).pdiv >= 0
    with np.errstate(divide="ignore", invalid="ignore"):  # of a rate too small for a float; no register fits it
        velocity_error, acceleration_error = v_max / velocity - 1, a_max / acceleration - 1
    return _Search(
        v_max=v_max,
        a_max=a_max,
        velocity_error=velocity_error,
        acceleration_error=acceleration_error,
        fits_registers=registers,
        fits_limits=registers & pair & (a_max >= lower) & (a_max <= upper),
    )


def _best(
    search: _Search,
    mechanics: Mechanics,
    usrs: int | None,
    rate: float,
    slope: float,
    reduction: float,
    good_errors: tuple[float, float],
) -> tuple[float, RegisterSuggestion]:
    """The best dividers of `search`, which has some, and the larger of their two errors; 1 is just small enough."""
    pulse_div, ramp_div = np.nonzero(search.fits_limits)
    errors = np.maximum(
        np.abs(search.velocity_error) / good_errors[0], np.abs(search.acceleration_error) / good_errors[1]
    )
    error = errors[pulse_div, ramp_div]
    apart = np.maximum(np.abs(ramp_div - pulse_div), 1)
    # lexsort: the last key counts first
    choice = int(np.lexsort((-ramp_div, -pulse_div, np.where(error <= 1, apart, 0), np.maximum(error, 1)))[0])
    at = int(pulse_div[choice]), int(ramp_div[choice])
    v_max, a_max = int(search.v_max[at]), int(search.a_max[at])
    pair = design_many(a_max, at[1], at[0], reduction)
    velocity_error, acceleration_error = float(search.velocity_error[at]), float(search.acceleration_error[at])
    said = []
    if abs(velocity_error) > _LARGE_ERROR:
        said.append(f"the nearest speed is {velocity_error:+.1%} off: v_max is only {v_max}")
    if abs(acceleration_error) > _LARGE_ERROR:
        said.append(f"the nearest acceleration is {acceleration_error:+.1%} off: a_max is only {a_max}")
    if at[1] - at[0] > 1:
        said.append(f"ramp_div - pulse_div is {at[1] - at[0]}: see the candidates for how far such a pair overshoots")
    return float(error[choice]), RegisterSuggestion(
        pulse_div=at[0],
        ramp_div=at[1],
        v_max=v_max,
        a_max=a_max,
        usrs=usrs,
        pmul=int(pair.pmul),
        p_mul=int(pair.p_mul),
        pdiv=int(pair.pdiv),
        achieved_velocity_pps=rate * (1 + velocity_error),
        achieved_acceleration_pps2=slope * (1 + acceleration_error),
        velocity_error=velocity_error,
        acceleration_error=acceleration_error,
        mechanics=mechanics,
        warnings=tuple(said),
    )


def _refusal(rate: float, slope: float, clock_hz: float, search: _Search, usrs: int | None) -> str:
    """Which limit stands against this motion."""
    resolution = "" if usrs is None else f" with {1 << usrs} microsteps"
    fastest = clock_hz * MAX_VELOCITY / 2**16
    slowest = clock_hz / 2 ** (16 + MAX_DIVIDER)
    if rate > fastest * (1 + 0.5 / MAX_VELOCITY):
        return f"unreachable: {plain(rate)} pps{resolution} is above {plain(fastest)} pps, v_max 2047 with pulse_div 0"
    if rate < slowest / 2:
        return f"unreachable: {plain(rate)} pps{resolution} is below {plain(slowest)} pps, v_max 1 with pulse_div 13"
    usable = (search.v_max >= 1) & (search.v_max <= MAX_VELOCITY)
    pulse_divs = np.nonzero(usable.any(axis=1))[0]
    unit = clock_hz * clock_hz / 2**29
    steepest = MAX_ACCELERATION * unit / 2.0 ** int(pulse_divs[0])
    gentlest = unit / 2.0 ** int(pulse_divs[-1] + MAX_DIVIDER)
    if slope > steepest * (1 + 0.5 / MAX_ACCELERATION):
        most = f"{plain(steepest)} pps^2, a_max 2047 with ramp_div 0"
        return f"unreachable: {plain(slope)} pps^2{resolution} is above {most}"
    if slope < gentlest / 2:
        return (
            f"unreachable: {plain(slope)} pps^2{resolution} is below {plain(gentlest)} pps^2, a_max 1 with ramp_div 13"
        )
    return (
        f"unreachable: {plain(rate)} pps with {plain(slope)} pps^2{resolution} lies outside a_max_lower_limit and"
        " a_max_upper_limit (DS-TMC428 8.7.1) for every pair of dividers"
    )
