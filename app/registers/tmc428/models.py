"""The chips of this family, as the catalog lists them."""

from __future__ import annotations

from functools import partial

from ..capabilities import Capability
from ..entry import Model
from ..wires import Wire
from . import tmc428, tmc429, tmc4210

FAMILY = "tmc428"
_DESCRIPTION = "a chip that ramps by pmul and pdiv"
_COMMON: frozenset[Capability] = frozenset(
    {"registers", "motion", "ramp.pmul", "home_switch", "position_latch", "events"}
)
_WIRES: frozenset[Wire] = frozenset({"emulator", "tcp", "spidev"})

_chip = partial(Model, family=FAMILY, description=_DESCRIPTION, wires=_WIRES, clock_hz_default=16e6)
_WITH_CHAIN: frozenset[Capability] = _COMMON | {"microsteps.ram", "driver_chain", "current"}

MODELS = (
    _chip(
        "tmc428",
        title="TMC428",
        summary="three axes, SPI driver chain",
        axes=tmc428.AXES,
        table=tmc428.TMC428,
        clock_hz_max=16e6,
        capabilities=_WITH_CHAIN,
        current_scale="full_scale",
    ),
    _chip(
        "tmc429",
        title="TMC429",
        summary="three axes, SPI driver chain or step/direction",
        axes=tmc429.AXES,
        table=tmc429.TMC429,
        clock_hz_max=32e6,
        capabilities=_WITH_CHAIN | {"position_compare"},
        current_scale="full_scale",
    ),
    _chip(
        "tmc4210",
        title="TMC4210",
        summary="one axis, step/direction",
        axes=tmc4210.AXES,
        table=tmc4210.TMC4210,
        clock_hz_max=32e6,
        capabilities=_COMMON | {"step_dir", "position_compare"},
    ),
)
