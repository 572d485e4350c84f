"""One axis of a chip: a TMC5160's drive, and how the registers of the other chips reach it."""

from __future__ import annotations

from collections.abc import Callable

from ...registers.model import Register
from ..drive import Drive, adc
from ..drive.registers import ALIASES, READ_ONLY, WRITABLE
from ..drive.units import bits
from .chips import Kind
from .options import Tmc5xxxOptions

ADC_NAMES = {"ADC_VSUPPLY_AIN", "ADC_TEMP"}
LIVE = READ_ONLY | ADC_NAMES | {"XACTUAL", "XTARGET", "X_ENC", "RAMP_STAT", "ENC_STATUS", "PWM_STATUS"}
"""What the drive answers; everything else that can be read is as it was written."""
_NAMES = ALIASES | {"PWM_STATUS": "PWM_SCALE"}
_MRES, _INTPOL, _VSENSE, _LATCH_NOW = 24, 28, 17, 11
_OTPW, _WARN_AT = 1 << 26, 16


class Axis:
    """Registers by the names of their rows."""

    def __init__(self, kind: Kind, options: Tmc5xxxOptions, has_encoder: bool) -> None:
        self._kind = kind
        self._cool = self._high = 0
        self._warn_at: int | None = None
        """ADC_TEMP from which on otpw is told, where a register says it."""
        self.has_stealth_chop = kind.single
        """Dual chips: PWM_AMPL is not 0."""
        self.drive = Drive(options.drive(kind.full_scale_a, has_encoder))
        self.drive.stall_guard_4 = kind.stall_guard_4
        self.drive.stealth_chop = kind.stealth_chop
        self.drive.least_supply_v = kind.least_supply_v

    def reset(self) -> None:
        """As after power-on, but for the registers, which the chip writes."""
        self._cool = self._high = 0
        self.drive.power_cycle()
        if not self._kind.single:  # the dual chips have no delay between standstill and the way to the hold current
            self.drive.write("TPOWERDOWN", 0)

    def reader(self, row: Register) -> Callable[[], int]:
        """What reads a live register, as an unsigned word."""
        read, name, mask = self.drive.read, _NAMES.get(row.name, row.name), row.mask
        match row.name:
            case "ADC_VSUPPLY_AIN":  # nothing is connected to AIN
                return lambda: adc.supply(self.drive.plant.driver_supply_v)
            case "ADC_TEMP":
                return self._temperature
            case "DRV_STATUS":
                return lambda: self._warned(read(name)) & mask
            case "PWM_SCALE":
                return lambda: _with_finer_sum(read(name), self._kind.scale_shift) & mask
        return lambda: read(name) & mask

    def _temperature(self) -> int:
        return adc.temperature(self.drive.plant.temperature_c)

    def _warned(self, status: int) -> int:
        """DRV_STATUS, whose warning of temperature a register may say."""
        if self._warn_at is None:
            return status
        return status & ~_OTPW | (_OTPW if self._temperature() >= self._warn_at else 0)

    def clear(self, row: Register, ones: int) -> None:
        """Let flags go."""
        self.drive.write(row.name, ones)

    def write(self, row: Register, word: int) -> None:
        """Take over what was written to a register of this axis."""
        drive = self.drive
        match row.name:
            case "X_COMPARE":
                drive.x_compare = word
            case "VCOOLTHRS":
                self._cool = word
                drive.set_velocity_window(self._cool, self._high)
            case "VHIGH":
                self._high = word
                drive.set_velocity_window(self._cool, self._high)
            case "CHOPCONF":
                self._write_chopper(word)
            case "DRV_CONF":
                if len(self._kind.ranges) > 1:
                    drive.sense_share = self._kind.ranges[bits(word, 0, 2)]
            case "OTW_OV_VTH":
                self._warn_at = bits(word, _WARN_AT, 13)
            case "DCCTRL":
                parts = row.unpack(word)
                drive.write("DCCTRL", parts["DC_TIME"] | parts["DC_SG"] << 16)
            case "VDCMIN":
                if self._kind.dc_step:
                    drive.write("VDCMIN", word)
            case "PWMCONF":
                self.has_stealth_chop = self._kind.single or bits(word, 0, 8) > 0
                drive.write("PWMCONF", word)
            case "TPOWERDOWN":
                self.drive.write("TPOWERDOWN", max(word - self._kind.power_down_less, 0))
            case "ENCMODE":
                drive.write("ENCMODE", word)
                if bits(word, _LATCH_NOW, 1):
                    drive.latch_now()
            case name:
                name = _NAMES.get(name, name)
                if name in WRITABLE:
                    drive.write(name, word)

    def configure(self, *, shaft: int, stealth_chop: int, fast_standstill: int) -> None:
        """GCONF's part in this axis."""
        stealth_chop = stealth_chop and self.has_stealth_chop
        self.drive.write("GCONF", fast_standstill << 1 | stealth_chop << 2 | shaft << 4)

    def _write_chopper(self, word: int) -> None:
        kind = self._kind
        if kind.vsense != 1.0:
            self.drive.sense_share = kind.vsense if bits(word, _VSENSE, 1) else 1.0
        if bits(word, _MRES, 4) not in kind.interpolates:
            word &= ~(1 << _INTPOL)
        self.drive.write("CHOPCONF", word)


def _with_finer_sum(word: int, more_bits: int) -> int:
    """PWM_SCALE whose sum, alone of its parts, has more bits."""
    return word & ~0xFF | (word & 0xFF) << more_bits
