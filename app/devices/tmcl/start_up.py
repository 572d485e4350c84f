"""Getting a PD42-1241 to run: its own currents stay where nobody says any, for its motor is mounted on it."""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import UsageError
from ...registers.model import Register
from ..core.device import Device
from ..core.results import WriteItem
from ..core.start_up import StartPlan, Wanted
from . import rows, units

MICROSTEPS = (256, 128, 64, 32, 16, 8, 4, 2, 1)
MOST = 255
"""The greatest current: full scale."""
RUN, HOLD = 128, 32
"""Where the module itself has none."""
OFF_TIME = 5
VSTOP_PPS = 10
MAX_CURRENT, STANDBY_CURRENT = rows.axis_parameter(6), rows.axis_parameter(7)


async def plan(device: Device, wanted: Sequence[Wanted]) -> StartPlan:
    """What the module needs to move, counted as its unit mode (AP 255) has it."""
    (one,) = wanted
    figures = one.figures
    if figures.counts_per_rev:
        raise UsageError("the module knows its own encoder; set an external one by its parameters (AP 217)")
    mode = (await device.read(rows.UNIT_MODE.name, rows.UNIT_MODE.axis)).value
    microsteps = one.microsteps(MICROSTEPS[0], MICROSTEPS)
    velocity, slope = one.velocity_pps(microsteps), one.acceleration_pps2(microsteps)
    braking = one.deceleration_pps2(slope)
    speed_unit = units.speed_unit_pps(device.clock_hz, mode)
    slope_unit = units.acceleration_unit_pps2(device.clock_hz, mode)

    def write(row: Register, value: float) -> WriteItem:
        return WriteItem(row.name, row.axis, round(value))

    items = [
        write(rows.MICROSTEPS, MICROSTEPS[::-1].index(microsteps)),
        write(rows.FULL_STEPS, one.settings.full_steps_per_rev),
        *await _currents(device, one),
        write(rows.MAX_ACCELERATION, slope / slope_unit),
        write(rows.A1, slope / slope_unit),
        write(rows.V1, 0),
        write(rows.MAX_DECELERATION, braking / slope_unit),
        write(rows.D1, braking / slope_unit),
        write(rows.VSTART, 0),
        write(rows.VSTOP, max(VSTOP_PPS / speed_unit, VSTOP_PPS)),
        write(rows.RIGHT_DISABLED, not figures.stops),
        write(rows.LEFT_DISABLED, not figures.stops),
        write(rows.RIGHT_INVERTED, figures.stop_low_active),
        write(rows.LEFT_INVERTED, figures.stop_low_active),
        write(rows.MAX_SPEED, velocity / speed_unit),
    ]
    return StartPlan(items)


async def _currents(device: Device, one: Wanted) -> Sequence[WriteItem]:
    """Run and standby current and the chopper's off time, which is 0 where somebody has switched the driver off."""
    shares = one.share_of_full_scale()
    if shares is None:
        run, hold, off = [
            (await device.read(row.name, row.axis)).value for row in (MAX_CURRENT, STANDBY_CURRENT, rows.OFF_TIME)
        ]
        run, hold = one.scales(MOST, run or RUN, hold if run else HOLD)
    else:
        off = (await device.read(rows.OFF_TIME.name, rows.OFF_TIME.axis)).value
        run, hold = (min(MOST, int(share * MOST * (1 + 1e-9))) for share in shares)
    return [
        WriteItem(MAX_CURRENT.name, MAX_CURRENT.axis, run),
        WriteItem(STANDBY_CURRENT.name, STANDBY_CURRENT.axis, hold),
        WriteItem(rows.OFF_TIME.name, rows.OFF_TIME.axis, off or OFF_TIME),
    ]
