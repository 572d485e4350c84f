"""Registers of the TMC4361's ramp generator against pps, pps^2 and pps^3: fixed point, direct units, limits.

The chip knows its clock and so counts in real units, with a fixed point: velocities in 1/256 pps, accelerations
in 1/4 pps^2, bows in pps^3. For short and steep ramps accelerations and bows can be given per clock instead
(`direct_acc_val_en`, `direct_bow_val_en`): in fCLK^2 / 2^37 pps^2 and fCLK^3 / 2^53 pps^3.

Two readings that the sources leave open:

- How far direct values may go. DS-TMC4361 has 24 bits; later documents stop at 65535 (accelerations) and 4095 (bows) or
  at 2^20 for both. 24 bits are taken, and what is above the lowest cap is warned of.
- How fast positioning may go. DS-TMC4361 forbids more than fCLK/2 and advises fCLK/4 for positioning in hold mode;
  revision 3 advises fCLK/4 for all positioning. More than fCLK/2 is refused, more than fCLK/4 while positioning warned
  of.

DS-TMC4361 prints the bows' highest bit as 2^-29 where 24 bits down to 2^-53 begin with 2^-30, and "mpps" for millions.

Source: DS-TMC4361 1.4, 8, 8.1, 8.2, 8.2.3; `TMC4361A_Fields.h` of the vendor's TMC-API (2^20).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from types import MappingProxyType
from typing import Final

from ...number_text import plain

CLOCK_HZ_DEFAULT: Final = 16e6
CLOCK_HZ_MIN: Final = 4_194_304.0
CLOCK_HZ_MAX: Final = 32e6

DIRECT_ACCELERATION_BITS: Final = 37
"""A direct acceleration is in 2^-37 pulses per clock squared."""
DIRECT_BOW_BITS: Final = 53
"""A direct bow is in 2^-53 pulses per clock cubed."""
DIRECT_ACCELERATION_CAP: Final = 65_535
DIRECT_BOW_CAP: Final = 4_095
"""Lowest caps of direct values that a later document states (data sheet revision 3.10)."""
DIRECT_FIELD_CAP: Final = 1 << 20
"""Another cap, of both, by the vendor's list of fields."""


class Quantity(Enum):
    """What a register of the ramp generator holds."""

    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    BOW = "bow"

    @property
    def unit(self) -> str:
        return {"velocity": "pps", "acceleration": "pps^2", "bow": "pps^3"}[self.value]


@dataclass(frozen=True, slots=True)
class Format:
    """How a register holds a number: `whole` bits before the point and `decimals` after it, and a sign or none."""

    quantity: Quantity
    whole: int
    decimals: int
    signed: bool = False
    always_direct: bool = False
    """In direct units whatever GENERAL_CONF says."""

    @property
    def raw_max(self) -> int:
        """The greatest number in the register; the least is 0, or of a signed one the same below 0."""
        return (1 << (self.whole + self.decimals - self.signed)) - 1

    @property
    def text(self) -> str:
        """As the data sheet writes it, e.g. "24+8"."""
        return f"{self.whole}+{self.decimals}"


_SPEED = Format(Quantity.VELOCITY, 23, 8)
_RATE = Format(Quantity.ACCELERATION, 22, 2)
_BOW = Format(Quantity.BOW, 24, 0)

FORMATS: Final[Mapping[str, Format]] = MappingProxyType(
    {
        "VACTUAL": Format(Quantity.VELOCITY, 32, 0, signed=True),
        "AACTUAL": Format(Quantity.ACCELERATION, 32, 0, signed=True),
        "VMAX": Format(Quantity.VELOCITY, 24, 8, signed=True),
        "VSTART": _SPEED,
        "VSTOP": _SPEED,
        "VBREAK": _SPEED,
        "AMAX": _RATE,
        "DMAX": _RATE,
        "ASTART": _RATE,
        "DFINAL": _RATE,
        "DSTOP": _RATE,
        "DFREEZE": Format(Quantity.ACCELERATION, 22, 2, always_direct=True),
        "BOW1": _BOW,
        "BOW2": _BOW,
        "BOW3": _BOW,
        "BOW4": _BOW,
    }
)
"""By register name (of FREEZE the field). VACTUAL and AACTUAL are read only and never in direct units."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What a register can stand for. All in the quantity's unit (pps, pps^2 or pps^3); a register may also hold 0."""

    register: str
    quantity: Quantity
    least: float
    """The step from one value to the next, and the smallest above 0."""
    highest: float
    """The greatest magnitude."""
    why: str
    """What sets `highest`."""
    format: str


@dataclass(frozen=True, slots=True)
class Units:
    """The units of one chip: its clock [Hz] and GENERAL_CONF's two switches for direct units.

    Raises ValueError for a clock outside of 4.194304 to 32 MHz (DS-TMC4361 8.2.3).
    """

    clock_hz: float = CLOCK_HZ_DEFAULT
    direct_acceleration: bool = False
    direct_bow: bool = False

    def __post_init__(self) -> None:
        if not CLOCK_HZ_MIN <= self.clock_hz <= CLOCK_HZ_MAX:
            raise ValueError(f"CLK_FREQ is {CLOCK_HZ_MIN:.0f} to {CLOCK_HZ_MAX:.0f} Hz, not {plain(self.clock_hz)}")

    def is_direct(self, register: str) -> bool:
        """Whether a register counts per clock now. Raises KeyError for a name that is not in FORMATS."""
        form = FORMATS[register]
        if form.signed or form.quantity is Quantity.VELOCITY:
            return False
        return (
            form.always_direct
            or {Quantity.ACCELERATION: self.direct_acceleration, Quantity.BOW: self.direct_bow}[form.quantity]
        )

    def least(self, register: str) -> float:
        """What 1 in the register stands for [pps, pps^2 or pps^3]; exact but for the rounding of one float."""
        return float(self._least(register))

    def _least(self, register: str) -> Fraction:
        form = FORMATS[register]
        if not self.is_direct(register):
            return Fraction(1, 1 << form.decimals)
        clock = Fraction(self.clock_hz)
        if form.quantity is Quantity.ACCELERATION:
            return clock**2 / (1 << DIRECT_ACCELERATION_BITS)
        return clock**3 / (1 << DIRECT_BOW_BITS)

    def limits(self, register: str) -> Limits:
        """What the register can stand for, and which limit ends it. Raises KeyError for an unknown name."""
        form = FORMATS[register]
        highest, why = float(form.raw_max * self._least(register)), f"its {form.text} bits"
        if self.is_direct(register):
            why = "its 24 bits in direct units"
        if form.quantity is Quantity.VELOCITY and self.clock_hz / 2 < highest:
            highest, why = self.clock_hz / 2, "half a pulse per clock, fCLK/2"
        return Limits(register, form.quantity, self.least(register), highest, why, form.text)

    def to_raw(self, register: str, value: float) -> int:
        """The register for `value` [pps, pps^2 or pps^3], to the nearest, halves away from 0.

        A negative value gives a negative number; the register row makes bits of it. Raises ValueError, naming the
        limit, for what the register cannot hold, and for less than half its least step. KeyError for an unknown name.
        """
        limits = self.limits(register)
        unit = limits.quantity.unit
        lowest = -limits.highest if FORMATS[register].signed else 0.0
        if not lowest <= value <= limits.highest:  # also false for NaN
            allowed = f"{_number(lowest)} to {_number(limits.highest)} {unit} ({limits.why})"
            raise ValueError(f"{register} is {allowed}, not {_number(value)}")
        steps = abs(Fraction(value)) / self._least(register)
        raw = math.floor(steps + Fraction(1, 2))
        if raw == 0 and value:
            raise ValueError(
                f"{register} is 0 or at least {_number(limits.least)} {unit}, its least step; not {plain(value)}"
            )
        return raw if value >= 0 else -raw

    def from_raw(self, register: str, raw: int) -> float:
        """What the register stands for [pps, pps^2 or pps^3], `raw` with its sign.

        Raises ValueError for a number that the register cannot hold (its format, not the clock: a chip may have been
        told another clock). KeyError for an unknown name.
        """
        form = FORMATS[register]
        lowest = -form.raw_max - 1 if form.signed else 0
        if not lowest <= raw <= form.raw_max:
            raise ValueError(f"{register} is {lowest} to {form.raw_max}, not {raw}")
        return float(raw * self._least(register))

    def held(self, register: str, value: float) -> float:
        """What the chip makes of `value`: the nearest that its register holds. Raises as `to_raw`."""
        return self.from_raw(register, self.to_raw(register, value))

    def warnings(
        self, register: str, value: float, positioning: bool = False, step_length_add: int = 0
    ) -> tuple[str, ...]:
        """What speaks against a value [pps, pps^2 or pps^3] that the register holds; empty where nothing does.

        `positioning` tells the mode (RAMPMODE bit 2), `step_length_add` is STP_LENGTH_ADD, 0..65535 [clocks].
        Raises ValueError outside of that. KeyError for an unknown name.
        """
        if not 0 <= step_length_add <= 0xFFFF:
            raise ValueError(f"STP_LENGTH_ADD is 0 to 65535 clocks, not {step_length_add}")
        if FORMATS[register].quantity is Quantity.VELOCITY:
            return self._speed_warnings(register, abs(value), positioning, step_length_add)
        return self._direct_warnings(register, abs(value))

    def _speed_warnings(self, register: str, speed: float, positioning: bool, step_length_add: int) -> tuple[str, ...]:
        found = []
        advised = self.clock_hz / 4
        if positioning and speed > advised:
            found.append(
                f"{register} is above fCLK/4, {_number(advised)} pps: positioning may not end exactly (DS-TMC4361 8.2)"
            )
        longest = self.step_rate_max(step_length_add)
        if step_length_add and speed > longest:
            found.append(
                f"{register} is above {_number(longest)} pps: pulses of {step_length_add + 1} clocks leave no more "
                "(STP_LENGTH_ADD)"
            )
        return tuple(found)

    def _direct_warnings(self, register: str, value: float) -> tuple[str, ...]:
        if not self.is_direct(register):
            return ()
        quantity = FORMATS[register].quantity
        cap = DIRECT_ACCELERATION_CAP if quantity is Quantity.ACCELERATION else DIRECT_BOW_CAP
        raw = value / self.least(register)
        found = [
            f"{register} is above {number}, {_number(number * self.least(register))} {quantity.unit}: {who}"
            for number, who in (
                (cap, "data sheets from revision 3.10 on allow no more in direct units, DS-TMC4361 has 24 bits"),
                (DIRECT_FIELD_CAP, "the vendor's list of fields allows no more than 2^20 in direct units"),
            )
            if raw > number + 0.5
        ]
        return tuple(found)

    def step_rate_max(self, step_length_add: int = 0) -> float:
        """The highest step rate with pulses of `step_length_add` + 1 clocks and as long a rest [pps].

        DS-TMC4361 1.4 says fCLK/2 for pulses of one clock; the rest of longer ones is an inference from 8.1.
        """
        return self.clock_hz / (2 * (step_length_add + 1))

    def table(self) -> tuple[Limits, ...]:
        """Every register that can be written, in the order of the data sheet's list of value classes (DS-TMC4361
        8.2.3)."""
        return tuple(self.limits(name) for name in FORMATS if name not in ("VACTUAL", "AACTUAL"))


def _number(value: float) -> str:
    """Short, but exact to a thousandth: limits are compared with what a user typed."""
    if not math.isfinite(value):
        return f"{value}"
    if abs(value) >= 1e12:
        return f"{plain(value)}"
    return f"{value:.3f}".rstrip("0").rstrip(".") if abs(value) >= 0.001 or value == 0 else f"{plain(value, 8)}"
