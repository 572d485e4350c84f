"""Chip units of TMC428 and TMC4210 against pulse rates: both chips divide their clock the same way.

A velocity register value is a fraction of 2048 of the pulse clock, an acceleration register value a
256th of a velocity unit per ramp clock. Everything broadcasts: scalars in, a float out; arrays in,
an array out.

Source: DS-TMC428 8.14; the TMC4210 (DS-TMC4210 2.3) shares it.
"""

from __future__ import annotations

from typing import Any, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

from ...number_text import plain

FloatArray: TypeAlias = NDArray[np.float64]
Numbers: TypeAlias = float | list[float] | list[int] | NDArray[Any]

MAX_VELOCITY = 2047
MAX_ACCELERATION = 2047
MAX_DIVIDER = 13
MAX_USRS = 6

# Scaling by powers of two is exact, so a register value survives the way to hertz and back up to
# the rounding of one product and one quotient. This much above full scale is still full scale.
_FULL_SCALE_SLACK = 1e-9


def _finite(name: str, values: Numbers, low: float, high: float, unit: str = "") -> FloatArray:
    array = np.asarray(values, dtype=np.float64)
    if not np.all((array >= low) & (array <= high)):  # also false for NaN
        raise ValueError(
            f"{name} is {plain(low)} to {plain(high)}{unit}, got {plain(_first_outside(array, low, high))}"
        )
    return array


def _first_outside(array: FloatArray, low: float, high: float) -> float:
    return float(np.extract(~((array >= low) & (array <= high)), array)[0])


def _whole(name: str, values: Numbers, low: int, high: int) -> FloatArray:
    array = _finite(name, values, low, high)
    if np.any(array != np.floor(array)):
        raise ValueError(f"{name} is a whole number of {low} to {high}")
    return array


def _clock(clock_hz: Numbers) -> FloatArray:
    array = np.asarray(clock_hz, dtype=np.float64)
    if not np.all((array > 0) & np.isfinite(array)):
        raise ValueError("clock_hz is a finite frequency above 0 Hz")
    return array


def _plain(result: FloatArray | np.float64) -> float | FloatArray:
    return result if isinstance(result, np.ndarray) and result.ndim else float(result)


@overload
def pulse_rate_hz(velocity: float, pulse_div: int, clock_hz: float) -> float: ...
@overload
def pulse_rate_hz(velocity: Numbers, pulse_div: Numbers, clock_hz: Numbers) -> float | FloatArray: ...
def pulse_rate_hz(velocity: Numbers, pulse_div: Numbers, clock_hz: Numbers) -> float | FloatArray:
    """Pulse rate R [Hz] of a velocity register value: f_clk * velocity / (2^pulse_div * 2048 * 32).

    `velocity` is -2047..2047 (the sign is the direction; fractions are welcome: v_actual has 8 bits
    of them), `pulse_div` 0..13, `clock_hz` above 0. Shape: what the three broadcast to.

    Raises ValueError outside these ranges. Source: DS-TMC428 8.14.
    """
    v = _finite("velocity", velocity, -MAX_VELOCITY, MAX_VELOCITY)
    divider = _whole("pulse_div", pulse_div, 0, MAX_DIVIDER)
    return _plain(_clock(clock_hz) * v / (np.exp2(divider) * 65536.0))


@overload
def velocity_from_rate(rate_hz: float, pulse_div: int, clock_hz: float) -> float: ...
@overload
def velocity_from_rate(rate_hz: Numbers, pulse_div: Numbers, clock_hz: Numbers) -> float | FloatArray: ...
def velocity_from_rate(rate_hz: Numbers, pulse_div: Numbers, clock_hz: Numbers) -> float | FloatArray:
    """Velocity register value of a pulse rate [Hz], not rounded: the inverse of `pulse_rate_hz`.

    Raises ValueError where the rate is more than velocity 2047 gives with this `pulse_div`, naming
    the largest rate, and outside the ranges of `pulse_rate_hz`. Source: DS-TMC428 8.14.
    """
    rate = np.asarray(rate_hz, dtype=np.float64)
    divider = _whole("pulse_div", pulse_div, 0, MAX_DIVIDER)
    clock = _clock(clock_hz)
    v = rate * np.exp2(divider) * 65536.0 / clock
    _check_reach(v, "rate_hz", "Hz", clock / (np.exp2(divider) * 65536.0), MAX_VELOCITY)
    return _plain(np.clip(v, -MAX_VELOCITY, MAX_VELOCITY))


@overload
def acceleration_hz_s(a: float, pulse_div: int, ramp_div: int, clock_hz: float) -> float: ...
@overload
def acceleration_hz_s(a: Numbers, pulse_div: Numbers, ramp_div: Numbers, clock_hz: Numbers) -> float | FloatArray: ...
def acceleration_hz_s(a: Numbers, pulse_div: Numbers, ramp_div: Numbers, clock_hz: Numbers) -> float | FloatArray:
    """Acceleration delta R [Hz/s] of an acceleration register value: f_clk^2 * a / 2^(pulse_div+ramp_div+29).

    `a` is -2047..2047 (a_actual is signed), both dividers 0..13, `clock_hz` above 0.

    Raises ValueError outside these ranges. Source: DS-TMC428 8.14.
    """
    register = _finite("a", a, -MAX_ACCELERATION, MAX_ACCELERATION)
    return _plain(register * _acceleration_unit_hz_s(pulse_div, ramp_div, clock_hz))


@overload
def acceleration_from_hz_s(acceleration: float, pulse_div: int, ramp_div: int, clock_hz: float) -> float: ...
@overload
def acceleration_from_hz_s(
    acceleration: Numbers, pulse_div: Numbers, ramp_div: Numbers, clock_hz: Numbers
) -> float | FloatArray: ...
def acceleration_from_hz_s(
    acceleration: Numbers, pulse_div: Numbers, ramp_div: Numbers, clock_hz: Numbers
) -> float | FloatArray:
    """Acceleration register value of a change of pulse rate [Hz/s], not rounded.

    Raises ValueError where it is more than the value 2047 gives with these dividers, naming the
    largest acceleration. Source: DS-TMC428 8.14.
    """
    unit = _acceleration_unit_hz_s(pulse_div, ramp_div, clock_hz)
    register = np.asarray(acceleration, dtype=np.float64) / unit
    _check_reach(register, "acceleration", "Hz/s", unit, MAX_ACCELERATION)
    return _plain(np.clip(register, -MAX_ACCELERATION, MAX_ACCELERATION))


@overload
def steps_during_acceleration(velocity: float, a_max: float, ramp_div: int, pulse_div: int) -> float: ...
@overload
def steps_during_acceleration(
    velocity: Numbers, a_max: Numbers, ramp_div: Numbers, pulse_div: Numbers
) -> float | FloatArray: ...
def steps_during_acceleration(
    velocity: Numbers, a_max: Numbers, ramp_div: Numbers, pulse_div: Numbers
) -> float | FloatArray:
    """Microsteps S from rest to `velocity` (or back): velocity^2 / (2 * a_max) * 2^(ramp_div - pulse_div) / 8.

    `velocity` is -2047..2047, `a_max` above 0 to 2047 (with 0 the velocity is never reached).

    Raises ValueError outside these ranges. Source: DS-TMC428 8.14.
    """
    v = _finite("velocity", velocity, -MAX_VELOCITY, MAX_VELOCITY)
    a = _finite("a_max", a_max, 0, MAX_ACCELERATION)
    if np.any(a == 0):
        raise ValueError("a_max is above 0 to 2047, got 0: without acceleration no velocity is reached")
    ratio = _whole("ramp_div", ramp_div, 0, MAX_DIVIDER) - _whole("pulse_div", pulse_div, 0, MAX_DIVIDER)
    return _plain(0.5 * v * v / a * np.exp2(ratio - 3))


def _acceleration_unit_hz_s(pulse_div: Numbers, ramp_div: Numbers, clock_hz: Numbers) -> FloatArray:
    """Delta R [Hz/s] of one unit of a_max."""
    pulse = _whole("pulse_div", pulse_div, 0, MAX_DIVIDER)
    ramp = _whole("ramp_div", ramp_div, 0, MAX_DIVIDER)
    clock = _clock(clock_hz)
    # 2^29 = 32 * 32 * 256 * 2048: two fixed pre-dividers, the fraction of v, the pulse accumulator
    return np.asarray(clock * clock / np.exp2(pulse + ramp + 29))


def _check_reach(register: FloatArray, name: str, unit_name: str, unit: FloatArray, limit: int) -> None:
    inside = np.abs(register) <= limit * (1 + _FULL_SCALE_SLACK)
    if not np.all(inside):  # also false for NaN
        reach = np.extract(~inside, np.broadcast_to(unit * limit, inside.shape))[0]
        raise ValueError(f"{name} is {plain(-reach)} to {plain(reach)} {unit_name} with these dividers and this clock")
