"""Units of the SixPoint ramp generator against pulse rates: of the TMC5xxx, and of the PD42-1241 with one inside.

A velocity unit is fCLK / 2^24, an acceleration unit fCLK^2 / 2^41. In these the module counts where its unit mode
(axis parameter 255) is 0; where it is 1, in pps and pps^2, of which the chip gets the nearest whole units. Everything
broadcasts: scalars in, a float or int out; arrays in, an array out.

Sources: TMC5160 data sheet (DS-TMC5160) 12.1, with the same formulas in those of the others; FM-PD42-1241
7.4. What registers can hold: DS-TMC5160 6.3.1.
"""

from __future__ import annotations

from typing import overload

import numpy as np
from numpy.typing import NDArray

from .tmc428 import FloatArray, Numbers

IntArray = NDArray[np.int64]

CLOCK_HZ = 16e6
"""fCLK that the chips' sheets advise [Hz]; of the PD42-1241 no manual states it, every range of its parameters fits."""
VELOCITY_MAX = (1 << 23) - 512
"""VMAX [velocity units]."""
START_STOP_MAX = (1 << 18) - 1
"""VSTART, VSTOP [velocity units]."""
KNEE_MAX = (1 << 20) - 1
"""V1 [velocity units]."""
ACCELERATION_MAX = (1 << 16) - 1
"""A1, AMAX, DMAX, D1 [acceleration units]."""


def velocity_unit_pps(clock_hz: float = CLOCK_HZ) -> float:
    """One unit of velocity: fCLK / 2^24 [pps]. Raises ValueError unless `clock_hz` is finite and above 0."""
    return clock_of(clock_hz) / (1 << 24)


def acceleration_unit_pps2(clock_hz: float = CLOCK_HZ) -> float:
    """One unit of acceleration: fCLK^2 / 2^41 [pps^2]. Raises ValueError unless `clock_hz` is finite and above 0."""
    return clock_of(clock_hz) ** 2 / (1 << 41)


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
    return nearest(_inside("velocity", np.asarray(pps) / velocity_unit_pps(clock_hz), VELOCITY_MAX, slack=0.49))


@overload
def acceleration_units(pps2: float, clock_hz: float = CLOCK_HZ) -> int: ...
@overload
def acceleration_units(pps2: Numbers, clock_hz: float = CLOCK_HZ) -> int | IntArray: ...
def acceleration_units(pps2: Numbers, clock_hz: float = CLOCK_HZ) -> int | IntArray:
    """The nearest whole chip units of an acceleration [pps^2], sign kept. Raises ValueError beyond 65535."""
    units = np.asarray(pps2) / acceleration_unit_pps2(clock_hz)
    return nearest(_inside("acceleration", units, ACCELERATION_MAX, slack=0.49))


def clock_of(clock_hz: float) -> float:
    """`clock_hz` itself. Raises ValueError unless it is finite and above 0."""
    if not (0 < clock_hz < float("inf")):
        raise ValueError("clock_hz is a finite frequency above 0 Hz")
    return clock_hz


def _inside(name: str, units: Numbers, limit: int, slack: float = 0.0) -> FloatArray:
    array = np.asarray(units, dtype=np.float64)
    if not np.all(np.abs(array) <= limit + slack):  # also false for NaN
        raise ValueError(f"{name} is {-limit} to {limit} units of the chip")
    return array


def nearest(array: FloatArray) -> int | IntArray:
    """Whole numbers, halves away from zero."""
    whole = (np.sign(array) * np.floor(np.abs(array) + 0.5)).astype(np.int64)
    return whole if whole.ndim else int(whole)


def _plain(result: FloatArray | np.float64) -> float | FloatArray:
    return result if isinstance(result, np.ndarray) and result.ndim else float(result)
