"""Chips of every family set up to move: 20 kpps, 150 kpps^2, well within the limits that tests put on them."""

from __future__ import annotations

from app.devices.core.device import Device
from app.devices.tmc5xxx.start_up import Start as SixPointStart
from app.devices.tmc5xxx.start_up import start_up as start_sixpoint
from app.devices.tmc428.start_up import AxisStart
from app.devices.tmc428.start_up import start_up as start_ramp
from app.devices.tmc4361.start_up import Start as SRampStart
from app.devices.tmc4361.start_up import start_up as start_s_ramp

SPEED_PPS, RATE_PPS2 = 20_000.0, 150_000.0
MOVERS = ("tmc428", "tmc4210", "tmc4361", "tmc5072", "tmc5160", "pd42-1241")
"""One model of each kind of driver, and one of two axes."""


async def set_up(device: Device) -> None:
    """Ready to move and to turn, on every axis; switches stop nothing."""
    if device.model in ("tmc428", "tmc4210"):
        start = AxisStart(v_max=1310, a_max=320, pulse_div=4, ramp_div=6, stops=False)
        await start_ramp(device, [start] * len(device.axes))
        if device.model == "tmc4210":
            await device.write("IF_CONFIGURATION_4210", fields={"en_sd": 1})
    elif device.model == "tmc4361":
        await start_s_ramp(device, SRampStart(vmax=SPEED_PPS, amax=RATE_PPS2, bow=2_000_000, stops=False))
    elif device.model == "pd42-1241":
        for number, value in ((4, 20_000), (5, 150_000), (15, 150_000), (17, 150_000), (18, 150_000), (194, 5_000)):
            await device.write(f"ap{number}", 0, value)
        await device.write("ap12", 0, 1)
        await device.write("ap13", 0, 1)
    else:
        await start_sixpoint(device, [SixPointStart(vmax=SPEED_PPS, amax=RATE_PPS2, stops=False)] * len(device.axes))
