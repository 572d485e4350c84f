"""What the chips differ in, beyond what their register tables say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..drive.kernel import AMPLITUDE, FIXED, TUNED
from ..drive.plant import UNDERVOLTAGE_V
from .options import Tmc5xxxModel


@dataclass(frozen=True, slots=True)
class Kind:
    """One chip as the emulator sees it."""

    axes: Literal[1, 2]
    """Motors. Chips with one have thresholds in TSTEP, and status byte and pins of their own kind."""
    version: int
    """IOIN's or INPUT's VERSION."""
    uart: Literal["", "plain", "node"]
    """Its UART: none, without or with a node address."""
    full_scale_a: float
    """Peak coil current at current scale 31 [A], vsense 0 or GLOBALSCALER 0: 5160 as the PD42-1241 has it, 5130 with
    110 mOhm (0.325 V over them and 20 mOhm of the chip), the dual ones the 1.5 A that their data sheets allow."""
    vsense: float = 1.0
    """Share of that with CHOPCONF.vsense set; 1: the chip has none."""
    delay_bit: int = 8
    """Lowest bit of SENDDELAY in register 0x03."""
    power_down_less: int = 0
    """Delays of 2^18 clocks that TPOWERDOWN counts too many: a TMC5130 waits one less."""
    interpolates: tuple[int, ...] = tuple(range(9))
    """MRES settings that intpol acts on."""
    clock_hz: float = 16e6
    """fCLK, unless the bench says another [Hz]."""
    ranges: tuple[float, ...] = (1.0,)
    """Share of full scale that the coils get, by DRV_CONF.CURRENT_RANGE."""
    stall_guard_4: bool = False
    """Load is measured with StealthChop too."""
    least_supply_v: float = UNDERVOLTAGE_V
    """The supply below which the bridges do not work [V]."""
    dc_step: bool = True
    """VDCMIN switches DcStep on."""
    stealth_chop: int = TUNED
    """Its kind, as the kernel names them."""
    scale_shift: int = 0
    """Bits that PWM_SCALE_SUM has more than eight."""

    @property
    def single(self) -> bool:
        """One motor."""
        return self.axes == 1


CHIPS: dict[Tmc5xxxModel, Kind] = {
    "tmc5031": Kind(2, 0x01, "", full_scale_a=1.5, vsense=0.5625, interpolates=()),
    "tmc5062": Kind(2, 0x01, "plain", full_scale_a=1.5, vsense=0.5625, delay_bit=4, interpolates=(4,)),
    "tmc5072": Kind(2, 0x10, "node", full_scale_a=1.5, vsense=0.5625, interpolates=(4,), stealth_chop=FIXED),
    "tmc5130": Kind(1, 0x11, "node", full_scale_a=2.5, vsense=0.18 / 0.325, power_down_less=1, stealth_chop=AMPLITUDE),
    "tmc5160": Kind(1, 0x30, "node", full_scale_a=4.2),
    # 12 kOhm at IREF: 36 kOhm A over them (KLIPPER, TMC2240). Least supply: the headline of the data sheet (PY)
    "tmc5240": Kind(
        1,
        0x40,
        "node",
        full_scale_a=3.0,
        clock_hz=12.5e6,
        ranges=(11.75 / 36, 24 / 36, 1.0, 1.0),
        stall_guard_4=True,
        dc_step=False,
        least_supply_v=4.5,
        scale_shift=2,
    ),
}
