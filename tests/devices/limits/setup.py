"""Chips of every family set up to move: 20 kpps, 150 kpps^2, well within the limits that tests put on them."""

from __future__ import annotations

from app.devices.core.device import Device
from app.devices.tmc5xxx.start_up import Start as SixPointStart
from app.devices.tmc5xxx.start_up import start_up as start_sixpoint
from app.devices.tmc428.start_up import AxisStart
from app.devices.tmc428.start_up import start_up as start_ramp
from app.devices.tmc4361.start_up import Start as SRampStart
from app.devices.tmc4361.start_up import start_up as start_s_ramp
from app.registers.catalog import CHIPS_32
from app.registers.tmcl.modules import MODULES

SPEED_PPS, RATE_PPS2 = 20_000.0, 150_000.0
MOVERS = ("tmc428", "tmc4210", "tmc4361", "tmc5072", "tmc5160", "pd42-1241", "tmcm-1161")
"""One model of each kind of driver, and one of two axes."""


async def set_up(device: Device) -> None:
    """Ready to move and to turn, on every axis; switches stop nothing."""
    if device.model in CHIPS_32:
        start = AxisStart(v_max=1310, a_max=320, pulse_div=4, ramp_div=6, stops=False)
        await start_ramp(device, [start] * len(device.axes))
        if device.model == "tmc4210":
            await device.registers.write("IF_CONFIGURATION_4210", fields={"en_sd": 1})
    elif device.model == "tmc4361":
        await start_s_ramp(device, SRampStart(vmax=SPEED_PPS, amax=RATE_PPS2, bow=2_000_000, stops=False))
    elif device.model in MODULES:
        for name, value in module_ramp(device.model, SPEED_PPS, RATE_PPS2, 5_000.0).items():
            await device.registers.write(name, 0, value)
        await device.registers.write("ap12", 0, 1)
        await device.registers.write("ap13", 0, 1)
    else:
        await start_sixpoint(device, [SixPointStart(vmax=SPEED_PPS, amax=RATE_PPS2, stops=False)] * len(device.axes))


def module_ramp(model: str, speed_pps: float, rate_pps2: float, search_pps: float) -> dict[str, int]:
    """Parameters that make a ramp of about these, by name, and the search speeds."""
    if MODULES[model].counting == "unit mode":
        rates = dict.fromkeys(("ap5", "ap15", "ap17", "ap18"), round(rate_pps2))
        return {"ap4": round(speed_pps), **rates, "ap194": round(search_pps), "ap195": round(search_pps)}
    one_pps, one_pps2 = 16e6 / 2**20, 16e6**2 / 2**39  # dividers 4 and 6
    speeds = {"ap4": speed_pps, "ap194": search_pps, "ap195": search_pps}
    counted = {name: round(pps / one_pps) for name, pps in speeds.items()}
    return {"ap153": 6, "ap154": 4, **counted, "ap5": round(rate_pps2 / one_pps2)}
