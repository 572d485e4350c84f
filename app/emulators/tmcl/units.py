"""Units of the module's user and units of the driver chip, at its clock of 16 MHz (FM-PD42-1241 7.4).

Velocities: 1 ramp unit is fCLK / 2^24 = 0.95 pps. Accelerations: 1 unit is fCLK^2 / 2^41 = 116.4 pps^2. Thresholds of
speed are kept as TSTEP, the clocks from one 1/256 microstep to the next. How the firmware rounds is open; here it
rounds to the nearest unit.
"""

from __future__ import annotations

from ...registers.tmcl.pd42 import CLOCK_HZ

PPS = CLOCK_HZ / (1 << 24)
"""One unit of velocity [pps]."""
PPS2 = CLOCK_HZ * CLOCK_HZ / (1 << 41)
"""One unit of acceleration [pps^2]."""
DELAY_S = (1 << 18) / CLOCK_HZ
"""One unit of TPOWERDOWN [s]."""
VELOCITY_MAX = (1 << 23) - 512
TSTEP_MAX = 0xFFFFF
TABLE_MICROSTEPS = 256


def velocity_to_chip(pps: int) -> int:
    """Velocity [pps] in ramp units, sign kept, cut at what the ramp generator can do."""
    units = min(int(abs(pps) / PPS + 0.5), VELOCITY_MAX)
    return units if pps >= 0 else -units


def velocity_from_chip(units: int) -> int:
    """Ramp units to velocity [pps], sign kept."""
    pps = int(abs(units) * PPS + 0.5)
    return pps if units >= 0 else -pps


def acceleration_to_chip(pps2: int) -> int:
    """Acceleration [pps^2] in ramp units, 1..65535: with 0 no ramp would ever end."""
    return min(max(int(pps2 / PPS2 + 0.5), 1), 0xFFFF)


def acceleration_from_chip(units: int) -> int:
    """Ramp units to acceleration [pps^2]."""
    return int(units * PPS2 + 0.5)


def step_time(velocity: int, microsteps: int) -> int:
    """A velocity [ramp units, steps of 1/`microsteps`] as TSTEP threshold; 0 gives the longest there is."""
    if velocity <= 0:
        return TSTEP_MAX
    return min((1 << 24) * microsteps // (velocity * TABLE_MICROSTEPS), TSTEP_MAX)


def measured_velocity(step_time_clocks: int, microsteps: int) -> int:
    """TSTEP back to ramp units of 1/`microsteps` steps; standstill is 0."""
    if step_time_clocks >= TSTEP_MAX or step_time_clocks <= 0:
        return 0
    return (1 << 24) * microsteps // (step_time_clocks * TABLE_MICROSTEPS)
