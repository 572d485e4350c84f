"""The chips of this family, as the catalog lists them."""

from __future__ import annotations

from ..capabilities import Capability
from ..entry import Model, Slot
from ..wires import Wire
from . import tmc2130, tmc2209, tmc2240, tmc2660

FAMILY = "tmcdrivers"
DESCRIPTION = "a driver that follows step and direction"

_COMMON: frozenset[Capability] = frozenset(
    {"registers", "motion", "step_input", "chopper", "flags", "current", "stallguard"}
)
_SPI: frozenset[Wire] = frozenset({"emulator", "tcp", "spidev", "landungsbruecke", "cover"})

MODELS = (
    Model(
        "tmc2130",
        FAMILY,
        "TMC2130",
        "driver to 1.4 A for step and direction, with StealthChop, StallGuard2 and CoolStep; SPI",
        DESCRIPTION,
        1,
        tmc2130.TABLE,
        clock_hz_default=13.2e6,
        clock_hz_min=4e6,
        clock_hz_max=18e6,
        capabilities=_COMMON | {"microsteps.mslut"},
        wires=_SPI,
        current_scale="sense_resistor",
        datagram_bits=40,
        board="TMC2130",
        slot=Slot("driver"),
        version=tmc2130.VERSION,
        version_address=tmc2130.VERSION_ADDRESS,
    ),
    Model(
        "tmc2209",
        FAMILY,
        "TMC2209",
        "driver to 2 A for step and direction, or at a velocity of its own; StealthChop, StallGuard4; UART",
        DESCRIPTION,
        1,
        tmc2209.TABLE,
        clock_hz_default=12e6,
        clock_hz_min=4e6,
        clock_hz_max=16e6,
        capabilities=_COMMON | {"own_velocity"},
        wires=frozenset({"emulator", "uart"}),
        current_scale="sense_resistor",
        datagram_bits=0,
        uart="node",
        nodes=4,
        version=tmc2209.VERSION,
        version_address=tmc2209.VERSION_ADDRESS,
    ),
    Model(
        "tmc2240",
        FAMILY,
        "TMC2240",
        "driver to 2.1 A for step and direction, with StealthChop, StallGuard2 and 4, CoolStep, ADC; SPI, UART",
        DESCRIPTION,
        1,
        tmc2240.TABLE,
        clock_hz_default=12.5e6,
        clock_hz_min=4e6,
        clock_hz_max=18e6,
        capabilities=_COMMON | {"microsteps.mslut"},
        wires=_SPI | {"uart"},
        current_scale="full_scale",
        datagram_bits=40,
        uart="node",
        board="TMC2240",
        slot=Slot("driver"),
        version=tmc2240.VERSION,
        version_address=tmc2240.VERSION_ADDRESS,
    ),
    Model(
        "tmc2660",
        FAMILY,
        "TMC2660",
        "driver to 2.8 A for step and direction or told coil currents, with StallGuard2, CoolStep; SPI of 20 bits",
        DESCRIPTION,
        1,
        tmc2660.TABLE,
        clock_hz_default=15e6,
        clock_hz_min=4e6,
        clock_hz_max=20e6,
        capabilities=_COMMON - {"chopper", "flags"} | {"current.scale"},
        wires=_SPI,
        current_scale="sense_resistor",
        datagram_bits=20,
        spi=tmc2660.FORMAT,
        board="TMC2660",
        slot=Slot("driver"),
    ),
)
