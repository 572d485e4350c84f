"""What the drivers differ in, beyond what their register tables say."""

from __future__ import annotations

from ...registers.tmcdrivers import tmc2209, tmc2240
from ..drive.tmc22xx import Kind
from ..drive.tmc2130 import TMC2130
from .options import DriverModel

# 110 mOhm: 0.325 V over them and 20 mOhm of the chip, 0.18 V with vsense (DS-TMC2209 8). Supply from 4.75 V on (PY)
CHIPS: dict[DriverModel, Kind] = {
    "tmc2130": TMC2130,
    "tmc2209": Kind(
        tmc2209.VERSION,
        uart=True,
        spi=False,
        clock_hz=12e6,
        full_scale_a=2.5,
        vsense=0.18 / 0.325,
        least_supply_v=4.75,
        stall_guard_4=True,
    ),
    # 12 kOhm at IREF: 36 kOhm A over them (KLIPPER). Least supply: the headline of the data sheet (PY)
    "tmc2240": Kind(
        tmc2240.VERSION,
        uart=True,
        spi=True,
        clock_hz=12.5e6,
        full_scale_a=3.0,
        vsense=1.0,
        least_supply_v=4.5,
        stall_guard_4=True,
        ranges=(11.75 / 36, 24 / 36, 1.0, 1.0),
        scale_shift=2,
    ),
}
