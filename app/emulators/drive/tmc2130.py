"""The TMC2130 among the drivers of registers with a motor."""

from __future__ import annotations

from ...registers.tmcdrivers import tmc2130
from .kernel import AMPLITUDE
from .tmc22xx import Kind

# 110 mOhm and 20 mOhm of the chip: 0.32 V over them, 0.18 V with vsense (KLIPPER-TMC2130). Supply from 4.75 V on (PY)
TMC2130 = Kind(
    tmc2130.VERSION,
    uart=False,
    spi=True,
    clock_hz=13.2e6,  # KLIPPER-TMC2130
    full_scale_a=0.32 / 0.13,
    vsense=0.18 / 0.32,
    least_supply_v=4.75,
    stealth_chop=AMPLITUDE,
    power_down_less=1,
)
