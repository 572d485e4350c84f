"""What the five chips differ in, beyond what their register tables say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from app.emulators.tmc5xxx.options import Tmc5xxxModel


@dataclass(frozen=True, slots=True)
class Kind:
    """One chip as the emulator sees it."""

    version: int
    """IOIN's or INPUT's VERSION."""
    uart: Literal["", "plain", "node"]
    """Its UART: none, without or with a node address."""
    full_scale_a: float
    """Peak coil current at current scale 31 [A], vsense 0 or GLOBALSCALER 0, with the sense resistors that the maker's
    board has (5160: 75 mOhm) or the data sheet recommends for the largest current."""
    vsense: float = 1.0
    """Share of that with CHOPCONF.vsense set; 1: the chip has none."""
    node_bits: int = 8
    """Width of NODEADDR; SENDDELAY follows."""
    stealth_bit: bool = False
    """Whether GCONF.en_pwm_mode lets StealthChop in."""
    interpolates: tuple[int, ...] = tuple(range(9))
    """MRES settings that intpol acts on."""

    @property
    def axes(self) -> int:
        """Motors."""
        return 1 if self.single else 2

    @property
    def single(self) -> bool:
        """One motor: thresholds in TSTEP, status byte and pins of the younger chips."""
        return self.stealth_bit


CHIPS: dict[Tmc5xxxModel, Kind] = {
    "tmc5031": Kind(version=0x01, uart="", full_scale_a=1.5, vsense=0.55, interpolates=()),
    "tmc5062": Kind(version=0x01, uart="plain", full_scale_a=1.5, vsense=0.55, node_bits=4, interpolates=(4,)),
    "tmc5072": Kind(version=0x10, uart="node", full_scale_a=1.5, vsense=0.5625, interpolates=(4,)),
    "tmc5130": Kind(version=0x11, uart="node", full_scale_a=2.46, vsense=0.5625, stealth_bit=True),
    "tmc5160": Kind(version=0x30, uart="node", full_scale_a=4.2, stealth_bit=True),
}
