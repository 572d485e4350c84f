"""The chips of this family, as the catalog lists them."""

from __future__ import annotations

from ..capabilities import Capability
from ..entry import Model
from ..wires import Wire
from . import tmc428, tmc429, tmc4210

FAMILY = "tmc428"
_DESCRIPTION = "a chip that ramps by pmul and pdiv"
_COMMON: frozenset[Capability] = frozenset({"registers", "motion", "ramp.pmul", "home_switch", "position_latch"})
_WIRES: frozenset[Wire] = frozenset({"emulator", "tcp", "spidev"})

MODELS = (
    Model(
        "tmc428",
        FAMILY,
        "TMC428",
        "three axes, SPI driver chain",
        _DESCRIPTION,
        tmc428.AXES,
        tmc428.TMC428,
        clock_hz_default=16e6,
        clock_hz_max=16e6,
        capabilities=_COMMON | {"microsteps.ram", "driver_chain", "current"},
        wires=_WIRES,
        current_scale="full_scale",
    ),
    Model(
        "tmc429",
        FAMILY,
        "TMC429",
        "three axes, SPI driver chain or step/direction",
        _DESCRIPTION,
        tmc429.AXES,
        tmc429.TMC429,
        clock_hz_default=16e6,
        clock_hz_max=32e6,
        capabilities=_COMMON | {"microsteps.ram", "driver_chain", "current", "position_compare"},
        wires=_WIRES,
        current_scale="full_scale",
    ),
    Model(
        "tmc4210",
        FAMILY,
        "TMC4210",
        "one axis, step/direction",
        _DESCRIPTION,
        tmc4210.AXES,
        tmc4210.TMC4210,
        clock_hz_default=16e6,
        clock_hz_max=32e6,
        capabilities=_COMMON | {"step_dir", "position_compare"},
        wires=_WIRES,
    ),
)
