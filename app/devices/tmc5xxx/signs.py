"""What a TMC5xxx tells of an axis beside its state: faults of its driver, zeros that keep it from moving, switches."""

from __future__ import annotations

from ...calc.units.tmc5xxx import acceleration_units, velocity_units
from ..core.results import AxisState
from ..core.signs import Evidence, Sign, Signs, clear_flags, start_up, write, zero
from . import rows as r
from .events import Events
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


def signs(chip: Events, axis: int, state: AxisState, encoder_apart_s: float) -> Signs:
    """Of `state`, as it was read just now."""
    return Signs(
        faults=tuple(_faults(chip, axis, state)),
        blocks=tuple(_blocks(chip, axis, state)),
        stall=_stall(chip, axis, state),
        holds=tuple(_holds(chip, axis, state)),
        takes_encoder=True,
        resets=chip.resets,
        encoder_apart_s=encoder_apart_s,
    )


def _faults(chip: Events, axis: int, state: AxisState) -> list[Sign]:
    rows = chip.rows(axis)
    errors = dict.fromkeys((f"drv_err{axis + 1}", "drv_err"), "the driver has shut down")
    found = []
    # The cause first: GSTAT says only that there is one.
    for register, told in ((rows.drv_status, DRIVER_FAULTS), (chip.chip.gstat, {**GSTAT_FAULTS, **errors})):
        for name, cause in told.items():
            if state.flags.get(name):
                # A short is kept until the driver is switched off; then what is beside it says how to switch it on.
                off = (write(rows.chopconf.name, axis, 0, "toff"),) if name in SHORTS else ()
                evidence = (Evidence(f"{register.name}.{name}", "1", state.time_s),)
                found.append(Sign(cause, evidence, (*off, clear_flags(axis))))
    return found


def _blocks(chip: Events, axis: int, state: AxisState) -> list[Sign]:
    rows, found = chip.rows(axis), []
    chopper = chip.known(rows.chopconf)
    if chopper is not None and r.part(rows.chopconf, "toff").unpack(chopper) == 0:
        name = f"{rows.chopconf.name}.toff"
        found.append(
            Sign(
                f"the driver is off ({name} is 0)",
                (Evidence(name, "0", state.time_s),),
                (start_up(axis), write(rows.chopconf.name, axis, OFF_TIME, "toff")),
            )
        )
    pin = chip.chip.disable_pin
    if state.flags.get(pin):
        evidence = (Evidence(f"{chip.chip.inputs.name}.{pin}", "1", state.time_s),)
        found.append(
            Sign("the pin DRV_ENN is high and switches the driver off (only its wire can change that)", evidence)
        )
    if state.moving:
        return found
    for row, value in (
        (rows.vmax, velocity_units(VELOCITY_PPS, chip.clock_hz)),
        (rows.amax, acceleration_units(ACCELERATION_PPS2, chip.clock_hz)),
    ):
        if chip.wanted(row) == 0:
            positioning = state.target_position is not None
            found.append(zero(row.name, axis, round(value) if positioning or row is rows.amax else None, state.time_s))
    return found


def _stall(chip: Events, axis: int, state: AxisState) -> Sign | None:
    rows = chip.rows(axis)
    stops = r.part(rows.sw_mode, "sg_stop").unpack(chip.known(rows.sw_mode) or 0)
    if not stops or not state.flags.get("event_stop_sg"):
        return None
    evidence = (Evidence(f"{rows.ramp_stat.name}.event_stop_sg", "1", state.time_s),)
    return Sign("StallGuard stopped the motor", evidence, (clear_flags(axis),))


def _holds(chip: Events, axis: int, state: AxisState) -> list[Sign]:
    rows, found = chip.rows(axis), []
    switches = rows.sw_mode.unpack(chip.known(rows.sw_mode) or 0)
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
