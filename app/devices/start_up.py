"""Getting a motor to run (001, chapter 13): everything that has to be set before the first target, in its order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from app.calc.driver_chain import build_chain
from app.calc.microstep_table import design_table
from app.calc.pmul_pdiv import design
from app.devices.device import Device
from app.links.errors import UsageError


@dataclass(frozen=True, slots=True)
class AxisStart:
    """What one axis is set to, in register values. `usrs` is the TMC428's alone.

    pmul and pdiv are designed from these, reduced as the data sheets advise. The stop switches are
    in force where `stops` is.
    """

    v_max: int
    a_max: int
    pulse_div: int
    ramp_div: int
    usrs: int = 6
    v_min: int = 1
    stops: bool = True


DRIVERS = ("tmc236", "tmc236", "tmc236")
CLK2_DIV = 7
"""The fastest clock of the driver chain, good for TMC236 and its family (001, 9.7)."""


async def start_up(device: Device, axes: Sequence[AxisStart], drivers: Sequence[str] = DRIVERS) -> None:
    """Set a chip up after power-on, ready for `move` and `rotate`.

    A TMC428 gets driver chain, microstep table, LSMD and global parameters with multiplexed
    switches sampled at rest; a TMC4210 its step/direction output and right switch. Then each axis.

    Raises BenchError: at the first write that the chip did not take, with the rest not tried.
    """
    if device.model == "tmc428":
        await _driver_chain(device, drivers)
    else:
        await device.write("IF_CONFIGURATION_4210", fields={"en_sd": 1})
        await device.write("STEPPER_MOTOR_GLOBAL_PARAMETER_REGISTER", fields={"mot1r": 1})
    for axis, start in enumerate(axes):
        await _axis(device, axis, start)


async def _driver_chain(device: Device, drivers: Sequence[str]) -> None:
    # RAM first: as long as it is noise, a datagram to the chain may never end (001, chapter 11).
    chain = build_chain(drivers)
    await device.write_driver_chain(chain.ram_words, chain.lsmd)
    await device.write_microstep_table(design_table().values)
    await device.write(
        "stepper_motor_global_parameter_register",
        fields={"clk2_div": CLK2_DIV, "continuous_update": 1, "refmux": 1},
    )


async def _axis(device: Device, axis: int, start: AxisStart) -> None:
    pair = design(device.model, start.a_max, start.ramp_div, start.pulse_div, evaluate=False)
    if pair.pmul is None or pair.p_mul is None or pair.pdiv is None:
        raise UsageError(f"no pmul and pdiv fit a_max {start.a_max} with these dividers: {'; '.join(pair.warnings)}")
    dividers: dict[str, int | str] = {"pulse_div": start.pulse_div, "ramp_div": start.ramp_div}
    if device.model == "tmc428":
        dividers["usrs"] = start.usrs
    await device.write("v_min", axis, value=start.v_min)
    await device.write("v_max", axis, value=start.v_max)
    await device.write(
        "pulse_div_ramp_div_usrs" if device.model == "tmc428" else "PULSE_DIV_RAMP_DIV", axis, fields=dividers
    )
    await device.write("a_max", axis, value=start.a_max)
    await device.write(
        "pmul_pdiv", axis, fields={"pmul": pair.pmul if device.model == "tmc428" else pair.p_mul, "pdiv": pair.pdiv}
    )
    reference, mode = ("lp_ref_conf_rm", "rm") if device.model == "tmc428" else ("lp_REF_CONF_RAMP_MODE", "RAMP_MODE")
    ignored = int(not start.stops)
    await device.write(
        reference, axis, fields={mode: "RAMP_MODE", "disable_stop_l": ignored, "disable_stop_r": ignored}
    )
