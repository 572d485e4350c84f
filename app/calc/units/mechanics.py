"""Between microsteps and the mechanics behind the motor shaft: turns, angles, millimetres, and their rates.

Positions of revolution and angle are those of the output shaft, after the gear; a full step is the
motor's own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]

POSITION_UNITS = ("microsteps", "fullsteps", "rev", "deg", "rad", "mm")
RATE_UNITS = ("pps", "fullsteps/s", "rps", "rpm", "deg/s", "rad/s", "mm/s")
ACCELERATION_UNITS = ("pps^2", "fullsteps/s^2", "rps^2", "rpm/s", "deg/s^2", "rad/s^2", "mm/s^2")

# unit -> (the position unit that it counts, how many of those one of it is)
_PARTS: dict[str, tuple[str, float]] = {
    **{unit: (unit, 1.0) for unit in POSITION_UNITS},
    "pps": ("microsteps", 1.0),
    "fullsteps/s": ("fullsteps", 1.0),
    "rps": ("rev", 1.0),
    "rpm": ("rev", 1 / 60),
    "deg/s": ("deg", 1.0),
    "rad/s": ("rad", 1.0),
    "mm/s": ("mm", 1.0),
    "pps^2": ("microsteps", 1.0),
    "fullsteps/s^2": ("fullsteps", 1.0),
    "rps^2": ("rev", 1.0),
    "rpm/s": ("rev", 1 / 60),
    "deg/s^2": ("deg", 1.0),
    "rad/s^2": ("rad", 1.0),
    "mm/s^2": ("mm", 1.0),
}


@dataclass(frozen=True)
class Mechanics:
    """One axis from the motor to the load.

    full_steps_per_rev : full steps of one motor revolution, 1..100000 [-]
    microsteps_per_full_step : 1..1024 [-]; 2^usrs for a TMC428, the driver's own for a TMC4210
    gear_ratio : motor revolutions per output revolution, above 0 [-]
    travel_mm_per_rev : travel per output revolution, above 0 [mm], None where nothing moves linearly

    Raises ValueError outside these ranges.
    """

    full_steps_per_rev: int = 200
    microsteps_per_full_step: int = 64
    gear_ratio: float = 1.0
    travel_mm_per_rev: float | None = None

    def __post_init__(self) -> None:
        for name, value, high in (
            ("full_steps_per_rev", self.full_steps_per_rev, 100_000),
            ("microsteps_per_full_step", self.microsteps_per_full_step, 1024),
        ):
            if value != int(value) or not 1 <= value <= high:
                raise ValueError(f"{name} is a whole number of 1 to {high}, got {value}")
        if not (self.gear_ratio > 0 and math.isfinite(self.gear_ratio)):
            raise ValueError(f"gear_ratio is above 0 and finite, got {self.gear_ratio}")
        travel = self.travel_mm_per_rev
        if travel is not None and not (travel > 0 and math.isfinite(travel)):
            raise ValueError(f"travel_mm_per_rev is above 0 mm and finite, or null, got {travel}")

    @property
    def microsteps_per_rev(self) -> float:
        """Microsteps of one revolution of the output shaft."""
        return self.full_steps_per_rev * self.microsteps_per_full_step * self.gear_ratio

    def microsteps_per(self, unit: str) -> float:
        """How many microsteps (pps, pps^2) one `unit` is.

        Raises ValueError for an unknown unit, and for millimetres where `travel_mm_per_rev` is None.
        """
        if unit not in _PARTS:
            known = ", ".join((*POSITION_UNITS, *RATE_UNITS, *ACCELERATION_UNITS))
            raise ValueError(f"unit {unit!r} is not one of {known}")
        length, count = _PARTS[unit]
        if length == "microsteps":
            return count
        if length == "fullsteps":
            return count * self.microsteps_per_full_step
        per_turn = {"rev": 1.0, "deg": 360.0, "rad": 2 * math.pi, "mm": self.travel_mm_per_rev}[length]
        if per_turn is None:
            raise ValueError(f"unit {unit!r} needs travel_mm_per_rev, which this axis does not have")
        return count * self.microsteps_per_rev / per_turn

    @overload
    def to_microsteps(self, value: float, unit: str) -> float: ...
    @overload
    def to_microsteps(self, value: NDArray[Any], unit: str) -> FloatArray: ...
    def to_microsteps(self, value: float | NDArray[Any], unit: str) -> float | FloatArray:
        """`value` in `unit` as microsteps, or a rate as pps, or an acceleration as pps^2; not rounded.

        Raises ValueError for an unknown unit or a value that is not finite.
        """
        return _scaled(value, self.microsteps_per(unit))

    @overload
    def from_microsteps(self, value: float, unit: str) -> float: ...
    @overload
    def from_microsteps(self, value: NDArray[Any], unit: str) -> FloatArray: ...
    def from_microsteps(self, value: float | NDArray[Any], unit: str) -> float | FloatArray:
        """Microsteps, or pps, or pps^2, in `unit`: the inverse of `to_microsteps`.

        Raises ValueError for an unknown unit or a value that is not finite.
        """
        return _scaled(value, 1 / self.microsteps_per(unit))


def _scaled(value: float | NDArray[Any], factor: float) -> float | FloatArray:
    scaled = np.asarray(value, dtype=np.float64) * factor
    if not np.all(np.isfinite(scaled)):
        raise ValueError("a value to convert is finite")
    return scaled if isinstance(scaled, np.ndarray) and scaled.ndim else float(scaled)
