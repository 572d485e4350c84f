"""What the number in a register means in the world, next to the number itself: V_MAX 1500 is 22.9 kpps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..calc.units.mechanics import Mechanics
from ..calc.units.tmc5xxx import acceleration_unit_pps2, velocity_unit_pps
from ..calc.units.tmc428 import MAX_DIVIDER, acceleration_hz_s, pulse_rate_hz
from ..calc.units.tmc4361 import FORMATS, Units
from ..number_text import plain
from ..registers.catalog import MODELS
from ..registers.model import Register, Space
from .document import AxisPart

Key = tuple[Space, int]

MICROSTEPS = "microsteps"
CLOCKS = {"tCLK": 1, "512 tCLK": 512, "2^18 tCLK": 1 << 18}
"""Units of time, in clocks."""
PLAIN = {
    "1/256 pps": (1 / 256, "pps"),
    "1/4 pps^2": (1 / 4, "pps^2"),
    "pps^3": (1.0, "pps^3"),
    "1/2^24": (2.0**-24, "steps per input step"),
    "1/65536": (1 / 65536, ""),
    "1/256": (1 / 256, "of full scale"),
    "1/255": (1 / 255, "of full scale"),
    "16.384 ms": (16.384e-3, "s"),
    "10 ms": (10e-3, "s"),
    "32 us": (32e-6, "s"),
    "ms": (1e-3, "s"),
    "Hz": (1.0, "Hz"),
}
"""Units that are always the same: how much one is, and of what."""


@dataclass(frozen=True, slots=True)
class Physical:
    """A number in people's units."""

    value: float
    unit: str

    def __str__(self) -> str:
        return f"{plain(self.value, 6)} {self.unit}".rstrip()


@dataclass(frozen=True, slots=True)
class World:
    """What one side of a comparison counts in: its clock [Hz], its mechanics, and the registers that set units."""

    model: str
    clock_hz: float
    axes: tuple[AxisPart, ...]
    words: Mapping[Key, int | None]

    def physical(self, row: Register, value: int) -> Physical | None:
        """`value` of a register or parameter; None where it means nothing but itself."""
        try:
            return self._physical(row, value)
        except (ValueError, KeyError, ZeroDivisionError):
            return None  # a chip may hold what no formula allows

    def _physical(self, row: Register, value: int) -> Physical | None:
        if row.internal_range is not None:
            return self._of_module(row, value)
        if row.unit == MICROSTEPS:
            return self._length(row, value)
        if row.unit in CLOCKS:
            return Physical(value * CLOCKS[row.unit] / self.clock_hz, "s")
        if self.model == "tmc4361" and row.name in FORMATS:
            return self._of_tmc4361(row, value)
        if row.unit in PLAIN:
            factor, unit = PLAIN[row.unit]
            return Physical(value * factor, unit)
        if row.unit.startswith("fCLK/(65536"):
            return Physical(pulse_rate_hz(value, self._divider(row, "pulse_div"), self.clock_hz), "pps")
        if row.unit.startswith("fCLK^2/2^(pulse_div"):
            dividers = self._divider(row, "pulse_div"), self._divider(row, "ramp_div")
            return Physical(acceleration_hz_s(value, *dividers, self.clock_hz), "pps^2")
        if row.unit == "fCLK/2^24 pps":
            return Physical(value * velocity_unit_pps(self.clock_hz), "pps")
        if row.unit == "fCLK^2/2^41 pps^2":
            return Physical(value * acceleration_unit_pps2(self.clock_hz), "pps^2")
        return None

    def _of_module(self, row: Register, value: int) -> Physical:
        one = 1.0
        if self._field("unit_mode", 0) == 0:
            one = velocity_unit_pps(self.clock_hz) if row.unit == "pps" else acceleration_unit_pps2(self.clock_hz)
        return Physical(value * one, row.unit)

    def _of_tmc4361(self, row: Register, value: int) -> Physical:
        direct = bool(self._field("direct_acc_val_en", 0)), bool(self._field("direct_bow_val_en", 0))
        return Physical(Units(self.clock_hz, *direct).from_raw(row.name, value), FORMATS[row.name].quantity.unit)

    def _length(self, row: Register, value: int) -> Physical | None:
        axis = row.axis or 0
        microsteps = self._microsteps(axis)
        if microsteps is None or axis >= len(self.axes):
            return None
        part = self.axes[axis]
        mechanics = Mechanics(part.full_steps_per_rev, microsteps, part.gear_ratio, part.travel_mm_per_rev)
        unit = "deg" if part.travel_mm_per_rev is None else "mm"
        return Physical(mechanics.from_microsteps(value, unit), unit)

    def _microsteps(self, axis: int) -> int | None:
        """Microsteps of a full step, as this side is set; None where that is not known."""
        if self.model == "tmc4210":
            return self.axes[axis].driver_microsteps if axis < len(self.axes) else None
        if self.model == "tmc5031":
            return 256
        name = {"tmc428": "usrs", "tmc4361": "mstep_per_fs", "pd42-1241": "microstep_resolution"}.get(
            self.model, "mres"
        )
        code = self._field(name, axis)
        if code is None:
            return None
        return 1 << min(code, 8) if name in ("usrs", "microstep_resolution") else 256 >> min(code, 8)

    def _divider(self, row: Register, name: str) -> int:
        code = self._field(name, row.axis or 0)
        if code is None:
            raise KeyError(name)
        return min(code, MAX_DIVIDER)  # above it a divider has no meaning in the sheets

    def _field(self, name: str, axis: int) -> int | None:
        """A field or parameter as this side holds it."""
        found = MODELS[self.model].table.find(name, axis)
        if found is None:
            return None
        row, part = found
        word = self.words.get((row.space, row.address))
        if word is None:
            return None
        return row.decode(word) if part is None else part.unpack(word)
