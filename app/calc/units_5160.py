"""Units of the TMC5160's ramp generator against pulse rates, for the PD42-1241 that has one inside.

A velocity unit is fCLK / 2^24, an acceleration unit fCLK^2 / 2^41. In these the module counts where its unit mode
(axis parameter 255) is 0; where it is 1, in pps and pps^2, of which the chip gets the nearest whole units. Everything
broadcasts: scalars in, a float or int out; arrays in, an array out.

Sources: TMC5160 data sheet, chapter 12.1; 004 (PD42-1241 TMCL manual), 7.4.
"""

from __future__ import annotations

from typing import overload

import numpy as np
from numpy.typing import NDArray

from app.calc.sixpoint import SixPoint
from app.calc.units import FloatArray, Numbers

IntArray = NDArray[np.int64]

CLOCK_HZ = 16e6
"""fCLK of the PD42-1241 [Hz]: no manual states it, every range of its parameters fits it."""
VELOCITY_MAX = (1 << 23) - 512
"""VMAX [velocity units]."""
START_STOP_MAX = (1 << 18) - 1
"""VSTART, VSTOP [velocity units]."""
KNEE_MAX = (1 << 20) - 1
"""V1 [velocity units]."""
ACCELERATION_MAX = (1 << 16) - 1
TSTEP_MAX = (1 << 20) - 1
"""What TSTEP reads at standstill [clocks]."""
TABLE_MICROSTEPS = 256
"""Microsteps that TSTEP counts, whatever the resolution is."""


def velocity_unit_pps(clock_hz: float = CLOCK_HZ) -> float:
    """One unit of velocity: fCLK / 2^24 [pps]. Raises ValueError unless `clock_hz` is finite and above 0."""
    return _clock(clock_hz) / (1 << 24)


def acceleration_unit_pps2(clock_hz: float = CLOCK_HZ) -> float:
    """One unit of acceleration: fCLK^2 / 2^41 [pps^2]. Raises ValueError unless `clock_hz` is finite and above 0."""
    return _clock(clock_hz) ** 2 / (1 << 41)


@overload
def velocity_pps(units: float, clock_hz: float = CLOCK_HZ) -> float: ...
@overload
def velocity_pps(units: Numbers, clock_hz: float = CLOCK_HZ) -> float | FloatArray: ...
def velocity_pps(units: Numbers, clock_hz: float = CLOCK_HZ) -> float | FloatArray:
    """Pulse rate of a velocity in chip units, -VELOCITY_MAX..VELOCITY_MAX [pps]. Raises ValueError outside."""
    return _plain(_inside("velocity", units, VELOCITY_MAX) * velocity_unit_pps(clock_hz))


@overload
def acceleration_pps2(units: float, clock_hz: float = CLOCK_HZ) -> float: ...
@overload
def acceleration_pps2(units: Numbers, clock_hz: float = CLOCK_HZ) -> float | FloatArray: ...
def acceleration_pps2(units: Numbers, clock_hz: float = CLOCK_HZ) -> float | FloatArray:
    """Acceleration of chip units up to 65535 either way [pps^2]. Raises ValueError outside."""
    return _plain(_inside("acceleration", units, ACCELERATION_MAX) * acceleration_unit_pps2(clock_hz))


@overload
def velocity_units(pps: float, clock_hz: float = CLOCK_HZ) -> int: ...
@overload
def velocity_units(pps: Numbers, clock_hz: float = CLOCK_HZ) -> int | IntArray: ...
def velocity_units(pps: Numbers, clock_hz: float = CLOCK_HZ) -> int | IntArray:
    """The nearest whole chip units of a pulse rate [pps], sign kept. Raises ValueError beyond VELOCITY_MAX."""
    return _rounded(_inside("velocity", np.asarray(pps) / velocity_unit_pps(clock_hz), VELOCITY_MAX, slack=0.49))


@overload
def acceleration_units(pps2: float, clock_hz: float = CLOCK_HZ) -> int: ...
@overload
def acceleration_units(pps2: Numbers, clock_hz: float = CLOCK_HZ) -> int | IntArray: ...
def acceleration_units(pps2: Numbers, clock_hz: float = CLOCK_HZ) -> int | IntArray:
    """The nearest whole chip units of an acceleration [pps^2], sign kept. Raises ValueError beyond 65535."""
    units = np.asarray(pps2) / acceleration_unit_pps2(clock_hz)
    return _rounded(_inside("acceleration", units, ACCELERATION_MAX, slack=0.49))


@overload
def tstep(pps: float, microsteps: int = 256, clock_hz: float = CLOCK_HZ) -> int: ...
@overload
def tstep(pps: Numbers, microsteps: int = 256, clock_hz: float = CLOCK_HZ) -> int | IntArray: ...
def tstep(pps: Numbers, microsteps: int = 256, clock_hz: float = CLOCK_HZ) -> int | IntArray:
    """Clocks between two of 256 microsteps a full step, at `pps` of `microsteps` a full step: a velocity as the
    thresholds see it (axis parameters 22, 181, 182, 186). TSTEP_MAX at standstill and below.

    Raises ValueError for a resolution that is none of 1, 2, 4 ... 256, and a velocity that is not finite.
    """
    if microsteps not in (1, 2, 4, 8, 16, 32, 64, 128, 256):
        raise ValueError(f"microsteps is 1, 2, 4 ... 256, got {microsteps}")
    speed = np.abs(np.asarray(pps, dtype=np.float64))
    if not np.all(np.isfinite(speed)):
        raise ValueError("the velocity is finite")
    with np.errstate(divide="ignore", over="ignore"):
        clocks = np.floor(_clock(clock_hz) / (speed * (TABLE_MICROSTEPS / microsteps)))
    return _rounded(np.minimum(clocks, TSTEP_MAX))


def quantised(ramp: SixPoint, clock_hz: float = CLOCK_HZ) -> SixPoint:
    """The ramp that the chip makes of wanted parameters: each at its nearest whole unit.

    What is above 0 and decides whether the motor moves at all (v_max, accelerations) stays above 0; v_max ends at what
    the ramp generator can do. Raises ValueError for another number that its register cannot hold.
    """
    one = velocity_unit_pps(clock_hz)

    def speed(name: str, pps: float, limit: int) -> float:
        units = velocity_units(pps, clock_hz)
        if units > limit:
            raise ValueError(f"{name} is up to {limit * velocity_unit_pps(clock_hz):g} pps, got {pps:g}")
        return units * velocity_unit_pps(clock_hz)

    def rate(pps2: float) -> float:
        units = acceleration_units(pps2, clock_hz)
        return max(units, 1 if pps2 > 0 else 0) * acceleration_unit_pps2(clock_hz)

    return SixPoint(
        v_max=max(speed("v_max", min(ramp.v_max, velocity_pps(VELOCITY_MAX, clock_hz)), VELOCITY_MAX), one),
        a_max=rate(ramp.a_max),
        d_max=rate(ramp.d_max),
        v_start=speed("v_start", ramp.v_start, START_STOP_MAX),
        a1=rate(ramp.a1),
        v1=speed("v1", ramp.v1, KNEE_MAX),
        d1=rate(ramp.d1),
        v_stop=speed("v_stop", ramp.v_stop, START_STOP_MAX),
        t_zero_wait_s=ramp.t_zero_wait_s,
    )


def _clock(clock_hz: float) -> float:
    if not (0 < clock_hz < float("inf")):
        raise ValueError("clock_hz is a finite frequency above 0 Hz")
    return clock_hz


def _inside(name: str, units: Numbers, limit: int, slack: float = 0.0) -> FloatArray:
    array = np.asarray(units, dtype=np.float64)
    if not np.all(np.abs(array) <= limit + slack):  # also false for NaN
        raise ValueError(f"{name} is {-limit} to {limit} units of the TMC5160")
    return array


def _rounded(array: FloatArray) -> int | IntArray:
    """To the nearest, halves away from zero."""
    whole = (np.sign(array) * np.floor(np.abs(array) + 0.5)).astype(np.int64)
    return whole if whole.ndim else int(whole)


def _plain(result: FloatArray | np.float64) -> float | FloatArray:
    return result if isinstance(result, np.ndarray) and result.ndim else float(result)
