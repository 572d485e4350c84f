"""The demo bench: what is there before anybody has connected anything, ready for the first click.

Both devices are set up over their wire, through the same drivers as hardware. Every axis is a
200-step motor on a stage of 300 mm with 8 mm a turn, standing in its middle, where position 0 is.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass

from .calc.units.tmc428 import acceleration_from_hz_s, velocity_from_rate
from .devices.core.config import AxisSettings, DeviceConfig
from .devices.core.device import Device
from .devices.manager import DeviceManager
from .devices.tmc428.start_up import AxisStart, start_up
from .errors import BenchError
from .links.registry import Link

log = logging.getLogger("stepscope.demo")

TRAVEL_MM_PER_REV = 8.0
FULL_STEPS_PER_REV = 200
CLOCK_HZ = 16e6
MODEL = "tmc428"
LINK: Link = {"kind": "emulator"}


@dataclass(frozen=True, slots=True)
class Tuning:
    """How an axis of the demo moves: microsteps a full step as 2^usrs, speed and acceleration of the carriage."""

    usrs: int
    speed_mm_s: float
    acceleration_mm_s2: float
    pulse_div: int
    ramp_div: int

    def start(self) -> AxisStart:
        """The registers for it."""
        microsteps_per_mm = FULL_STEPS_PER_REV * (1 << self.usrs) / TRAVEL_MM_PER_REV
        rate_pps = self.speed_mm_s * microsteps_per_mm
        change_pps2 = self.acceleration_mm_s2 * microsteps_per_mm
        return AxisStart(
            v_max=round(velocity_from_rate(rate_pps, self.pulse_div, CLOCK_HZ)),
            a_max=round(acceleration_from_hz_s(change_pps2, self.pulse_div, self.ramp_div, CLOCK_HZ)),
            pulse_div=self.pulse_div,
            ramp_div=self.ramp_div,
            usrs=self.usrs,
        )


# The whole stage takes 2 to 3 s; the three axes differ, so that their ramps do on one plot.
BENCH = {
    "X": Tuning(usrs=4, speed_mm_s=200.0, acceleration_mm_s2=400.0, pulse_div=2, ramp_div=7),
    "Y": Tuning(usrs=5, speed_mm_s=160.0, acceleration_mm_s2=250.0, pulse_div=1, ramp_div=7),
    "Z": Tuning(usrs=6, speed_mm_s=120.0, acceleration_mm_s2=800.0, pulse_div=0, ramp_div=7),
}
SLIDER = Tuning(usrs=4, speed_mm_s=150.0, acceleration_mm_s2=300.0, pulse_div=2, ramp_div=7)


async def add(manager: DeviceManager) -> None:
    """Add both devices and set them up. What fails is logged: a demo must not keep the server from starting."""
    bench = await manager.add(DeviceConfig("bench", MODEL, LINK, axes=_axes(*BENCH), demo=True))
    slider = await manager.add(DeviceConfig("slider", "tmc4210", LINK, axes=_axes("slider"), demo=True))
    try:
        await set_up_bench(bench)
        await set_up_slider(slider)
    except BenchError:
        log.exception("the demo bench could not be set up")


def _axes(*names: str) -> tuple[AxisSettings, ...]:
    return tuple(
        AxisSettings(
            name=name,
            full_steps_per_rev=FULL_STEPS_PER_REV,
            driver_microsteps=1 << SLIDER.usrs,
            travel_mm_per_rev=TRAVEL_MM_PER_REV,
        )
        for name in names
    )


async def set_up_bench(device: Device) -> None:
    """The TMC428, then what makes it pleasant: less current at rest, and switches that stop by the ramp."""
    await start_up(device, [tuning.start() for tuning in BENCH.values()])
    for axis in range(len(BENCH)):
        # Full current while accelerating, less at rest: what is_v0 is for (DS-TMC428 8.9).
        await device.registers.write(
            "is_agtat_is_aleat_is_v0_a_threshold",
            axis,
            fields={"is_agtat": 0, "is_aleat": 6, "is_v0": 3, "a_threshold": 1},
        )
        await device.registers.write("lp_ref_conf_rm", axis, fields={"SOFT_STOP": 1})


async def set_up_slider(device: Device) -> None:
    """The TMC4210, with step pulses short enough for its speed."""
    await start_up(device, [SLIDER.start()])
    await device.registers.write("STEPPER_MOTOR_GLOBAL_PARAMETER_REGISTER", fields={"STPDIV_4210": 2})
    await device.registers.write("lp_REF_CONF_RAMP_MODE", 0, fields={"soft_stop": 1})
