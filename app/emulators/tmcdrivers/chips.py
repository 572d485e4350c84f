"""What the drivers differ in, beyond what their register tables say."""

from __future__ import annotations

from dataclasses import dataclass

from ...registers.tmcdrivers import tmc2209
from .options import DriverModel


@dataclass(frozen=True, slots=True)
class Kind:
    """One driver as the emulator sees it."""

    version: int
    uart: bool
    spi: bool
    full_scale_a: float
    """Peak coil current at current scale 31 and vsense 0 [A]: as the chip's evaluation board has it."""
    vsense: float
    """Share of that with CHOPCONF.vsense set."""
    least_supply_v: float
    """The supply below which the bridges do not work [V]."""


# 110 mOhm: 0.325 V over them and 20 mOhm of the chip, 0.18 V with vsense (DS-TMC2209 8). Supply from 4.75 V on (PY)
CHIPS: dict[DriverModel, Kind] = {
    "tmc2209": Kind(tmc2209.VERSION, uart=True, spi=False, full_scale_a=2.5, vsense=0.18 / 0.325, least_supply_v=4.75),
}
