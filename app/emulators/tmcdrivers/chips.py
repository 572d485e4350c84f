"""What the drivers differ in, beyond what their register tables say."""

from __future__ import annotations

from dataclasses import dataclass

from ...registers.tmcdrivers import tmc2130, tmc2209, tmc2240
from ..drive.kernel import AMPLITUDE, TUNED
from .options import DriverModel


@dataclass(frozen=True, slots=True)
class Kind:
    """One driver as the emulator sees it."""

    version: int
    uart: bool
    spi: bool
    clock_hz: float
    """fCLK, unless the bench says another [Hz]."""
    full_scale_a: float
    """Peak coil current at current scale 31 and vsense 0 [A]: as the chip's evaluation board has it."""
    vsense: float
    """Share of that with CHOPCONF.vsense set."""
    least_supply_v: float
    """The supply below which the bridges do not work [V]."""
    stealth_chop: int = TUNED
    """Its kind, as the kernel names them."""
    stall_guard_4: bool = False
    """Load is measured with StealthChop too."""
    ranges: tuple[float, ...] = (1.0,)
    """Share of full scale that the coils get, by DRV_CONF.CURRENT_RANGE."""
    scale_shift: int = 0
    """Bits that PWM_SCALE_SUM has more than eight."""
    power_down_less: int = 0
    """Delays of 2^18 clocks that TPOWERDOWN counts too many."""


# 110 mOhm: 0.325 V over them and 20 mOhm of the chip, 0.18 V with vsense (DS-TMC2209 8); of a TMC2130 0.32 V
# (KLIPPER-TMC2130). Supply from 4.75 V on (PY)
CHIPS: dict[DriverModel, Kind] = {
    "tmc2130": Kind(
        tmc2130.VERSION,
        uart=False,
        spi=True,
        clock_hz=13.2e6,  # KLIPPER-TMC2130
        full_scale_a=0.32 / 0.13,
        vsense=0.18 / 0.32,
        least_supply_v=4.75,
        stealth_chop=AMPLITUDE,
        power_down_less=1,
    ),
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
