"""What a TMC5160 and the motor behind it do: ramp generator, driver, two-phase stepper, load, stage, encoders.

The seam is the chip's: register names and units of the TMC5160, time in its clocks. The PD42-1241 module's firmware
sits on it, and so may emulated TMC5xxx chips. `Drive` is the front door; nothing below it knows a bus or a wall clock.
"""

from __future__ import annotations

from .drive import DRIVE_JOB, Drive, warm_up
from .encoder import EncoderChannel
from .events import Event, EventKind
from .kernel import TICK_CLOCKS
from .options import CouplingOptions, DriveOptions, EncoderOptions, LoadOptions, MotorOptions, StageSwitches
from .plant import Plant, PlantState, Switches

__all__ = [
    "DRIVE_JOB",
    "TICK_CLOCKS",
    "CouplingOptions",
    "Drive",
    "DriveOptions",
    "EncoderChannel",
    "EncoderOptions",
    "Event",
    "EventKind",
    "LoadOptions",
    "MotorOptions",
    "Plant",
    "PlantState",
    "StageSwitches",
    "Switches",
    "warm_up",
]
