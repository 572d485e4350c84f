"""Times that the registers of the TMC5xxx count in clocks: steps and the thresholds on them, pauses, delays.

TSTEP is the time between two microsteps of 256 a full step, whatever the resolution is, so a threshold on it is a
velocity; the faster the motor, the smaller the number. The chips with two axes have thresholds in units of velocity.

Sources: DS-TMC5160 6.2 and 12.1; DS-TMC5130 6.2 and 12, where TPOWERDOWN counts otherwise; DS-TMC5072 6.2, whose
thresholds do not look at the lowest eight bits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import overload

import numpy as np

from ...number_text import plain
from .tmc5xxx import CLOCK_HZ, VELOCITY_MAX, IntArray, clock_of, nearest, velocity_unit_pps
from .tmc428 import Numbers

TSTEP_MAX = (1 << 20) - 1
"""What TSTEP reads at standstill [clocks]."""
TABLE_MICROSTEPS = 256
"""Microsteps that TSTEP counts, whatever the resolution is."""
WAIT_CLOCKS = 512
"""Unit of TZEROWAIT [clocks]."""
WAIT_MAX = (1 << 16) - 1
DELAY_CLOCKS = 1 << 18
"""Unit of TPOWERDOWN and IHOLDDELAY [clocks]."""
POWER_DOWN_MAX = 255
HOLD_DELAY_MAX = 15
STANDSTILL_CLOCKS = 1 << 20
"""Without a step for so long the motor counts as standing, and TPOWERDOWN begins [clocks]."""
THRESHOLD_STEP = 256
"""VCOOLTHRS, VHIGH and VDCMIN: bits 7..0 are not looked at."""
RESOLUTIONS = tuple(1 << n for n in range(9))


@overload
def tstep(pps: float, microsteps: int = 256, clock_hz: float = CLOCK_HZ) -> int: ...
@overload
def tstep(pps: Numbers, microsteps: int = 256, clock_hz: float = CLOCK_HZ) -> int | IntArray: ...
def tstep(pps: Numbers, microsteps: int = 256, clock_hz: float = CLOCK_HZ) -> int | IntArray:
    """Clocks between two of 256 microsteps a full step, at `pps` of `microsteps` a full step: a velocity as the
    thresholds see it (TPWMTHRS, TCOOLTHRS, THIGH; a module's axis parameters 22, 181, 182, 186). TSTEP_MAX at
    standstill and below.

    Raises ValueError for a resolution that is none of 1, 2, 4 ... 256, and a velocity that is not finite.
    """
    scale = _table_steps(microsteps)
    speed = np.abs(np.asarray(pps, dtype=np.float64))
    if not np.all(np.isfinite(speed)):
        raise ValueError("the velocity is finite")
    with np.errstate(divide="ignore", over="ignore"):
        clocks = np.floor(clock_of(clock_hz) / (speed * scale))
    return nearest(np.minimum(clocks, TSTEP_MAX))


@dataclass(frozen=True)
class Threshold:
    """What a threshold on TSTEP is as a velocity [pps]; both infinite for 0, which no motor gets to.

    falling_pps : where it switches as the motor slows down: the number that was meant
    rising_pps : where it switches as the motor speeds up, a sixteenth (or half of that) faster
    """

    tstep: int
    falling_pps: float
    rising_pps: float


def threshold(
    clocks: int, microsteps: int = 256, clock_hz: float = CLOCK_HZ, small_hysteresis: bool = False
) -> Threshold:
    """The velocities of TPWMTHRS, TCOOLTHRS or THIGH, in `microsteps` a full step; `small_hysteresis` as in GCONF.

    The chip compares with the number, and with 15/16 (31/32) of it less 1 once it has switched (DS-TMC5160, TSTEP).

    Raises ValueError outside of 0..2^20 - 1, and for a resolution that cannot be.
    """
    if not 0 <= clocks <= TSTEP_MAX or clocks != int(clocks):
        raise ValueError(f"a threshold on TSTEP is 0 to {TSTEP_MAX} clocks, got {clocks}")
    rate = clock_of(clock_hz) / _table_steps(microsteps)
    part = 31 / 32 if small_hysteresis else 15 / 16
    second = clocks * part - 1
    return Threshold(
        tstep=int(clocks),
        falling_pps=rate / clocks if clocks else float("inf"),
        rising_pps=rate / second if second > 0 else float("inf"),
    )


def velocity_threshold(pps: float, clock_hz: float = CLOCK_HZ) -> int:
    """VCOOLTHRS or VHIGH of the chips with two axes for a velocity [pps]: the nearest that they can tell apart.

    Raises ValueError below 0 and beyond VMAX.
    """
    unit = velocity_unit_pps(clock_hz)
    if not 0 <= pps <= VELOCITY_MAX * unit:
        raise ValueError(f"a threshold is 0 to {plain(VELOCITY_MAX * unit)} pps, got {plain(pps)}")
    return min(int(pps / unit / THRESHOLD_STEP + 0.5), VELOCITY_MAX // THRESHOLD_STEP) * THRESHOLD_STEP


# --- delays -------------------------------------------------------------------------------------


def zero_wait_s(raw: int, clock_hz: float = CLOCK_HZ) -> float:
    """TZEROWAIT as a time [s]. Raises ValueError outside of 0..65535."""
    return _within("TZEROWAIT", raw, WAIT_MAX) * WAIT_CLOCKS / clock_of(clock_hz)


def power_down_s(raw: int, clock_hz: float = CLOCK_HZ, first_free: bool = False) -> float:
    """TPOWERDOWN as a time [s], from standstill seen to the first step down.

    first_free : as the TMC5130 counts, where 1 is a single clock and each more adds 2^18 of them
    Raises ValueError outside of 0..255.
    """
    steps = _within("TPOWERDOWN", raw, POWER_DOWN_MAX)
    if first_free and steps:
        return ((steps - 1) * DELAY_CLOCKS or 1) / clock_of(clock_hz)
    return steps * DELAY_CLOCKS / clock_of(clock_hz)


def power_down(seconds: float, clock_hz: float = CLOCK_HZ, first_free: bool = False) -> int:
    """The nearest TPOWERDOWN of a time [s]; first_free as in `power_down_s`. Raises ValueError beyond its range."""
    extra = 1 if first_free and seconds > 0 else 0
    return _units("TPOWERDOWN", seconds, DELAY_CLOCKS, POWER_DOWN_MAX - extra, clock_hz) + extra


def hold_delay_s(raw: int, steps: int, clock_hz: float = CLOCK_HZ) -> float:
    """How long the current takes from IRUN to IHOLD with IHOLDDELAY `raw`: `steps` apart [s].

    Raises ValueError outside of 0..15, and for more steps than there are.
    """
    if not 0 <= steps <= 31:
        raise ValueError(f"from one current scale to another are 0 to 31 steps, got {steps}")
    return _within("IHOLDDELAY", raw, HOLD_DELAY_MAX) * steps * DELAY_CLOCKS / clock_of(clock_hz)


def hold_delay(seconds: float, steps: int, clock_hz: float = CLOCK_HZ) -> int:
    """The nearest IHOLDDELAY for a way of `steps` that takes `seconds`; 0 where there are none.

    Raises ValueError for a time that 15 is too short for.
    """
    return _units("IHOLDDELAY", seconds, DELAY_CLOCKS * steps, HOLD_DELAY_MAX, clock_hz) if steps else 0


def _units(name: str, seconds: float, clocks: int, most: int, clock_hz: float) -> int:
    unit_s = clocks / clock_of(clock_hz)
    units = seconds / unit_s
    if not 0 <= units < most + 0.5:  # also false for NaN
        raise ValueError(f"{name} is 0 to {plain(most * unit_s, 4)} s at this clock, got {plain(seconds)}")
    return int(units + 0.5)


def _within(name: str, raw: int, most: int) -> int:
    if not 0 <= raw <= most or raw != int(raw):
        raise ValueError(f"{name} is 0 to {most}, got {raw}")
    return int(raw)


def _table_steps(microsteps: int) -> float:
    """Microsteps of the table in one of the axis."""
    if microsteps not in RESOLUTIONS:
        raise ValueError(f"microsteps is 1, 2, 4 ... 256, got {microsteps}")
    return TABLE_MICROSTEPS / microsteps
