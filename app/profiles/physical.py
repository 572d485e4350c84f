"""What the number in a register means in physical units, next to the number itself: V_MAX 1500 is 22.9 kpps."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ..calc.units.mechanics import Mechanics
from ..number_text import plain
from ..registers.catalog import MODELS
from ..registers.model import Register
from .document import AxisPart
from .families import rules_of
from .items import Key, key_of

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
TABLE_MICROSTEPS = 256
"""Of a full step, where nothing divides them."""
RESOLUTIONS: tuple[tuple[str, Callable[[int], int]], ...] = (
    ("usrs", lambda code: 1 << code),
    ("microstep_resolution", lambda code: 1 << code),
    ("mstep_per_fs", lambda code: TABLE_MICROSTEPS >> code),
    ("mres", lambda code: TABLE_MICROSTEPS >> code),
)
"""Fields and parameters that say how many microsteps a full step has, and how."""


@dataclass(frozen=True, slots=True)
class Physical:
    """A number in physical units."""

    value: float
    unit: str

    def __str__(self) -> str:
        return f"{plain(self.value, 6)} {self.unit}".rstrip()


@dataclass(frozen=True, slots=True)
class UnitContext:
    """Unit conversion of one side of a comparison: its clock [Hz], its mechanics, and the registers that set units."""

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
        if row.unit == MICROSTEPS:
            return self._length(row, value)
        if row.unit in CLOCKS:
            return Physical(value * CLOCKS[row.unit] / self.clock_hz, "s")
        physical = rules_of(self.model).physical
        if physical is not None and (found := physical(self, row, value)) is not None:
            return Physical(*found)
        if row.unit in PLAIN:
            factor, unit = PLAIN[row.unit]
            return Physical(value * factor, unit)
        return None

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
        if MODELS[self.model].can("step_dir"):
            return self.axes[axis].driver_microsteps if axis < len(self.axes) else None
        for name, coded in RESOLUTIONS:
            if MODELS[self.model].table.find(name, axis) is not None:
                code = self.field(name, axis)
                return None if code is None else coded(min(code, 8))
        return TABLE_MICROSTEPS

    def field(self, name: str, axis: int) -> int | None:
        """A field or parameter as this side holds it."""
        found = MODELS[self.model].table.find(name, axis)
        if found is None:
            return None
        row, part = found
        word = self.words.get(key_of(row))
        if word is None:
            return None
        return row.decode(word) if part is None else part.unpack(word)
