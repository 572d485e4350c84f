"""Getting a TMCL module to run: its own currents stay where nobody says any, for they were set for its motor."""

from __future__ import annotations

from collections.abc import Sequence

from ...calc.ramps.pmul_pdiv import inverse
from ...calc.units.mechanics import Mechanics
from ...errors import UsageError
from ...registers.model import Register
from ..core.device import Device
from ..core.results import WriteItem
from ..core.start_up import AxisStartUp, StartPlan
from .roles import RegisterRoles
from .state import ModuleState

MICROSTEPS = (256, 128, 64, 32, 16, 8, 4, 2, 1)
MOST = 255
"""The greatest current: full scale."""
RUN, HOLD = 128, 32
"""Where the module itself has none."""
OFF_TIME = 5
VSTOP_PPS = 10
LIKE = "tmc4210"
"""The chip whose dividers a TMC429 has, with a driver of its own behind it."""
PRESCALER, COUNTS_PER_REV = 512, 1024
"""Of an encoder whose counts a prescaler makes microsteps of (FM-TMCM-1161 6.2)."""


async def plan(device: Device, wanted: Sequence[AxisStartUp]) -> StartPlan:
    """What the module needs to move, counted as it counts."""
    state = device.part(ModuleState)
    assert state is not None  # no other device is planned by this
    (one,) = wanted
    if one.figures.counts_per_rev:
        raise UsageError(f"a {device.family.title} knows its own encoder: set one that is outside by its parameters")
    if state.roles.vstart in state.roles.absent:
        return StartPlan(await _trapezoid(device, state.roles, one))
    return StartPlan(await _sixpoint(device, state, one))


async def _sixpoint(device: Device, state: ModuleState, one: AxisStartUp) -> list[WriteItem]:
    rows, figures = state.roles, one.figures
    mode = (await device.registers.read(rows.unit_mode.name, rows.unit_mode.axis)).value
    microsteps = one.microsteps(MICROSTEPS[0], MICROSTEPS)
    velocity, slope = one.velocity_pps(microsteps), one.acceleration_pps2(microsteps)
    braking = one.deceleration_pps2(slope)
    speed_unit = state.scaling.speed_unit_pps(device.clock_hz, [mode])
    slope_unit = state.scaling.acceleration_unit_pps2(device.clock_hz, [mode])
    return [
        _write(rows.microsteps, MICROSTEPS[::-1].index(microsteps)),
        _write(rows.full_steps, one.settings.full_steps_per_rev),
        *await _currents(device, rows, one),
        _write(rows.max_acceleration, slope / slope_unit),
        _write(rows.a1, slope / slope_unit),
        _write(rows.v1, 0),
        _write(rows.max_deceleration, braking / slope_unit),
        _write(rows.d1, braking / slope_unit),
        _write(rows.vstart, 0),
        _write(rows.vstop, max(VSTOP_PPS / speed_unit, VSTOP_PPS)),
        _write(rows.right_disabled, not figures.stops),
        _write(rows.left_disabled, not figures.stops),
        _write(rows.right_inverted, figures.stop_low_active),
        _write(rows.left_inverted, figures.stop_low_active),
        _write(rows.max_speed, velocity / speed_unit),
    ]


async def _trapezoid(device: Device, rows: RegisterRoles, one: AxisStartUp) -> list[WriteItem]:
    """By the dividers that come nearest to the figures. Raises UsageError where none are near."""
    figures = one.figures
    microsteps = one.microsteps(MICROSTEPS[0], MICROSTEPS)
    velocity, slope = one.velocity_pps(microsteps), one.acceleration_pps2(microsteps)
    if figures.deceleration_pps2 not in (None, slope):
        raise UsageError(f"a {device.family.title} brakes as it accelerates: leave deceleration_pps2 out")
    full_steps = one.settings.full_steps_per_rev
    try:
        near = inverse(LIKE, velocity, slope, Mechanics(full_steps, microsteps), device.clock_hz)
    except ValueError as error:
        raise UsageError(str(error)) from error
    one.warnings += [f"axis {one.axis}: {said}" for said in near.warnings]
    pulse_div, ramp_div = rows.counting
    return [
        _write(rows.microsteps, MICROSTEPS[::-1].index(microsteps)),
        _write(rows.encoder_prescaler, PRESCALER * full_steps * microsteps / COUNTS_PER_REV),
        *await _currents(device, rows, one),
        _write(pulse_div, near.pulse_div),
        _write(ramp_div, near.ramp_div),
        _write(rows.max_acceleration, near.a_max),
        _write(rows.min_speed, 1),
        _write(rows.right_disabled, not figures.stops),
        _write(rows.left_disabled, not figures.stops),
        _write(rows.switches_inverted, figures.stop_low_active),
        _write(rows.max_speed, near.v_max),
    ]


def _write(row: Register, value: float) -> WriteItem:
    return WriteItem(row.name, row.axis, round(value))


async def _currents(device: Device, rows: RegisterRoles, one: AxisStartUp) -> Sequence[WriteItem]:
    """Run and standby current and the chopper's off time, which is 0 where the driver was switched off."""
    shares = one.share_of_full_scale()
    if shares is None:
        run, hold, off = [
            (await device.registers.read(row.name, row.axis)).value
            for row in (rows.max_current, rows.standby_current, rows.off_time)
        ]
        run, hold = one.scales(MOST, run or RUN, hold if run else HOLD)
    else:
        off = (await device.registers.read(rows.off_time.name, rows.off_time.axis)).value
        run, hold = (min(MOST, int(share * MOST * (1 + 1e-9))) for share in shares)
    return [
        _write(rows.max_current, run),
        _write(rows.standby_current, hold),
        _write(rows.off_time, off or OFF_TIME),
    ]
