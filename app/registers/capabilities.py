"""What a chip or module can do, as a closed vocabulary: the catalog lists it for each model, the page asks for it."""

from __future__ import annotations

from typing import Literal

Capability = Literal[
    "registers",
    "parameters",
    "motion",
    "ramp.pmul",
    "ramp.s",
    "ramp.sixpoint",
    "microsteps.ram",
    "microsteps.mslut",
    "driver_chain",
    "step_dir",
    "chopper",
    "current",
    "encoder",
    "closed_loop",
    "stallguard",
    "home_switch",
    "input_filters",
    "events",
    "flags",
    "position_compare",
    "position_latch",
    "store",
    "programs",
    "step_input",
    "own_velocity",
]

TITLES: dict[Capability, str] = {
    "registers": "chips with registers",
    "parameters": "modules with parameters",
    "motion": "devices that move a motor",
    "ramp.pmul": "chips that ramp by pmul and pdiv",
    "ramp.s": "chips with S-ramps",
    "ramp.sixpoint": "chips and modules with SixPoint ramps",
    "microsteps.ram": "chips with 64 microsteps in their RAM",
    "microsteps.mslut": "chips with a microstep table of 256 differences",
    "driver_chain": "chips with a chain of SPI drivers",
    "step_dir": "chips that step a driver whose microsteps they are told",
    "chopper": "chips and modules that set the driver's chopper",
    "current": "devices that set the motor's current",
    "encoder": "devices with an encoder",
    "closed_loop": "chips with a closed loop",
    "stallguard": "devices that measure the motor's load",
    "home_switch": "devices with a home or reference switch",
    "input_filters": "chips with input filters",
    "events": "chips with an event register",
    "flags": "chips that keep flags until they are cleared",
    "position_compare": "chips that compare the position with a register",
    "position_latch": "chips that latch the position at a switch",
    "store": "modules with an EEPROM",
    "programs": "modules that execute programs",
    "step_input": "drivers that are stepped from outside",
    "own_velocity": "drivers that turn at a velocity of their own",
}
"""Whom a page that needs it is for: "This page is for chips with S-ramps"."""
