"""What a TMC5xxx tells of an axis beside its state: faults of its driver, zeros that keep it from moving, switches."""

from __future__ import annotations

from ...calc.units.tmc5xxx import (
    ACCELERATION_MAX,
    VELOCITY_MAX,
    acceleration_pps2,
    acceleration_units,
    velocity_pps,
    velocity_units,
)
from ..core.results import AxisState
from ..core.signs import Evidence, Sign, Signs, clear_flags, hot, start_up, write, zero
from . import roles as r
from .memory import ChipMemory
from .start_up import CHOPCONF

VELOCITY_PPS, ACCELERATION_PPS2 = 51_200.0, 204_800.0
"""What a remedy writes where the ramp is not set: a turn a second, in 0.25 s, at 256 microsteps."""
GSTAT_FAULTS = {"uv_cp": "the charge pump has too little voltage, and the driver is off"}
DRIVER_FAULTS = {
    "ot": "the driver is too hot and has switched off",
    "s2ga": "phase A is shorted to ground, and the driver is off",
    "s2gb": "phase B is shorted to ground, and the driver is off",
    "s2vsa": "phase A is shorted to the supply, and the driver is off",
    "s2vsb": "phase B is shorted to the supply, and the driver is off",
}
SHORTS = frozenset({"s2ga", "s2gb", "s2vsa", "s2vsb"})
OFF_TIME = int(CHOPCONF["toff"])


def signs(
    memory: ChipMemory, clock_hz: float, resets: int, axis: int, state: AxisState, encoder_apart_s: float
) -> Signs:
    """Of `state`, as it was read just now."""
    return Signs(
        faults=tuple(_faults(memory, axis, state)),
        warnings=hot(
            state.flags, "otpw", "ot", Evidence(f"{memory.rows(axis).drv_status.name}.otpw", "1", state.time_s)
        ),
        blocks=tuple(_blocks(memory, clock_hz, axis, state)),
        stall=_stall(memory, axis, state),
        holds=tuple(_holds(memory, axis, state)),
        takes_encoder=True,
        resets=resets,
        encoder_apart_s=encoder_apart_s,
    )


def _faults(memory: ChipMemory, axis: int, state: AxisState) -> list[Sign]:
    rows = memory.rows(axis)
    errors = dict.fromkeys((f"drv_err{axis + 1}", "drv_err"), "the driver has shut down")
    found = []
    # The cause first: GSTAT says only that there is one.
    for register, told in ((rows.drv_status, DRIVER_FAULTS), (memory.chip.gstat, {**GSTAT_FAULTS, **errors})):
        for name, cause in told.items():
            if state.flags.get(name):
                # A short is kept until the driver is switched off; then what is beside it says how to switch it on.
                off = (write(rows.chopconf.name, axis, 0, "toff"),) if name in SHORTS else ()
                evidence = (Evidence(f"{register.name}.{name}", "1", state.time_s),)
                found.append(Sign(cause, evidence, (*off, clear_flags(axis))))
    return found


def _blocks(memory: ChipMemory, clock_hz: float, axis: int, state: AxisState) -> list[Sign]:
    rows, found = memory.rows(axis), []
    chopper = memory.known(rows.chopconf)
    if chopper is not None and r.part(rows.chopconf, "toff").unpack(chopper) == 0:
        name = f"{rows.chopconf.name}.toff"
        found.append(
            Sign(
                f"the driver is off ({name} is 0)",
                (Evidence(name, "0", state.time_s),),
                (start_up(axis), write(rows.chopconf.name, axis, OFF_TIME, "toff")),
            )
        )
    pin = memory.chip.disable_pin
    if state.flags.get(pin):
        evidence = (Evidence(f"{memory.chip.inputs.name}.{pin}", "1", state.time_s),)
        found.append(
            Sign("the pin DRV_ENN is high and switches the driver off (only its wire can change that)", evidence)
        )
    if state.moving:
        return found
    # With a slow clock no register holds them: then as fast as it goes.
    speed_pps = min(VELOCITY_PPS, velocity_pps(VELOCITY_MAX, clock_hz))
    rate_pps2 = min(ACCELERATION_PPS2, acceleration_pps2(ACCELERATION_MAX, clock_hz))
    for row, value in (
        (rows.vmax, velocity_units(speed_pps, clock_hz)),
        (rows.amax, acceleration_units(rate_pps2, clock_hz)),
    ):
        if memory.wanted(row) == 0:
            positioning = state.target_position is not None
            found.append(zero(row.name, axis, round(value) if positioning or row is rows.amax else None, state.time_s))
    return found


def _stall(memory: ChipMemory, axis: int, state: AxisState) -> Sign | None:
    rows = memory.rows(axis)
    stops = r.part(rows.sw_mode, "sg_stop").unpack(memory.known(rows.sw_mode) or 0)
    if not stops or not state.flags.get("event_stop_sg"):
        return None
    evidence = (Evidence(f"{rows.ramp_stat.name}.event_stop_sg", "1", state.time_s),)
    return Sign("StallGuard stopped the motor", evidence, (clear_flags(axis),))


def _holds(memory: ChipMemory, axis: int, state: AxisState) -> list[Sign]:
    rows, found = memory.rows(axis), []
    switches = rows.sw_mode.unpack(memory.known(rows.sw_mode) or 0)
    for side, letter, active, free in (
        ("left", "l", state.switches.left, "right (to greater positions)"),
        ("right", "r", state.switches.right, "left (to smaller positions)"),
    ):
        if active and switches[f"stop_{letter}_enable"]:
            found.append(
                Sign(
                    f"the {side} switch is active: only the way {free} is free",
                    (Evidence(f"{rows.ramp_stat.name}.status_stop_{letter}", "1", state.time_s),),
                )
            )
    return found
