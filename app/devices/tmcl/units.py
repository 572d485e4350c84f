"""Speeds and accelerations of a module in pps, whatever it counts in.

A module with a SixPoint ramp generator counts in pps and pps^2 in unit mode 1 (AP 255), and in those of its driver
chip, a TMC5160, in unit mode 0 (FM-PD42-1241 7.4; formulas of DS-TMC5160 12.1). One with a TMC429 counts as that chip
does, by its two dividers (AP 154 and AP 153; DS-TMC428 8.14).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from types import MappingProxyType

from ...calc.units import tmc5xxx, tmc428
from ...registers.tmcl.description import Counting

INTERNAL, PPS = 0, 1
"""Values of unit mode."""

Unit = Callable[[float, Sequence[int]], float]
"""(clock [Hz], what the deciding parameters hold) to what 1 is."""


@dataclass(frozen=True, slots=True)
class Scaling:
    """How a module counts. `values` of its methods are those of `names`, None where nobody knows."""

    names: tuple[str, ...]
    """Parameters that decide it."""
    usual: int
    """What each of them is taken for while it is not known."""
    possible: tuple[int, ...]
    """Of what each of them may be then, those that make the greatest units."""
    speed_unit: Unit
    acceleration_unit: Unit
    most: float
    """The greatest speed or acceleration that can be written, whatever it counts by."""
    speed_limit_pps: Callable[[float], float]
    """From the clock [Hz] to the fastest that the ramp generator can count [pps]."""

    def speed_unit_pps(self, clock_hz: float, values: Sequence[int | None]) -> float:
        """What a speed of 1 is [pps]."""
        return self.speed_unit(clock_hz, self._usual(values))

    def acceleration_unit_pps2(self, clock_hz: float, values: Sequence[int | None]) -> float:
        """What an acceleration of 1 is [pps^2]."""
        return self.acceleration_unit(clock_hz, self._usual(values))

    def greatest(self, unit: Unit, clock_hz: float, values: Sequence[int | None]) -> float:
        """The greatest that `unit` may be, as far as `values` are known."""
        choices = ((value,) if value is not None else self.possible for value in values)
        return max(unit(clock_hz, each) for each in product(*choices))

    def _usual(self, values: Sequence[int | None]) -> list[int]:
        return [self.usual if value is None else value for value in values]


def _divider(value: int) -> int:
    return min(max(value, 0), tmc428.MAX_DIVIDER)


SCALINGS: Mapping[Counting, Scaling] = MappingProxyType(
    {
        "unit mode": Scaling(
            ("unit_mode",),
            PPS,
            (INTERNAL, PPS),
            lambda clock_hz, mode: tmc5xxx.velocity_unit_pps(clock_hz) if mode[0] == INTERNAL else 1.0,
            lambda clock_hz, mode: tmc5xxx.acceleration_unit_pps2(clock_hz) if mode[0] == INTERNAL else 1.0,
            8e6,
            lambda clock_hz: clock_hz / 2,
        ),
        "dividers": Scaling(
            ("pulse_div", "ramp_div"),
            0,
            (0,),
            lambda clock_hz, dividers: tmc428.pulse_rate_hz(1, _divider(dividers[0]), clock_hz),
            lambda clock_hz, dividers: tmc428.acceleration_hz_s(
                1, _divider(dividers[0]), _divider(dividers[1]), clock_hz
            ),
            tmc428.MAX_VELOCITY,
            lambda clock_hz: tmc428.pulse_rate_hz(tmc428.MAX_VELOCITY, 0, clock_hz),
        ),
    }
)


def read_back_tolerance(unit: str, value: int, clock_hz: float, microsteps: int) -> float:
    """How far a read-back may be from what was written by rounding alone, in unit mode 1.

    The driver chip keeps whole units of its own, and thresholds of speed as a time between steps.
    """
    if unit == "pps":
        step_time = 1.5 * value * value * (256 / microsteps) / clock_hz
        return 2 + step_time
    if unit == "pps^2":
        return 1.01 * tmc5xxx.acceleration_unit_pps2(clock_hz) + 1
    return 8.0 if unit == "1/255" else 0.0
