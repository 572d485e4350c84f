"""What a connection is, before anything is connected: what the store keeps and the manager opens."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from ...calc.units.mechanics import Mechanics
from ...errors import OutOfRange, UsageError
from ...links.registry import Link
from ...registers.catalog import find_model
from .axis_limits import AxisLimits

AXIS_NAME_MAX = 60


@dataclass(frozen=True, slots=True)
class AxisSettings:
    """The motor on an axis and what it moves; names, ranges and units as in the API's AxisConfig."""

    name: str = "axis"
    full_steps_per_rev: int = 200
    driver_microsteps: int = 16
    """Microsteps per full step of a step/direction driver (TMC4210); the TMC428 has usrs, the PD42-1241 AP 140."""
    gear_ratio: float = 1.0
    travel_mm_per_rev: float | None = None
    limits: AxisLimits = field(default_factory=AxisLimits)
    """Soft limits: what the axis may be asked for at most."""
    lost_steps_microsteps: int | None = None
    """From which deviation of the encoder on steps count as lost at rest; None: two full steps."""
    following_error_microsteps: int | None = None
    """From which deviation on a motion counts as not followed; None: four full steps."""

    @classmethod
    def of(cls, entry: Mapping[str, Any]) -> AxisSettings:
        """From plain keys and values, limits among them. Raises TypeError for an unknown key, OutOfRange."""
        limits = entry.get("limits") or {}
        return cls(**{**entry, "limits": limits if isinstance(limits, AxisLimits) else AxisLimits(**limits)})

    def __post_init__(self) -> None:
        if not 1 <= len(self.name.strip()) <= AXIS_NAME_MAX:
            raise UsageError(f"the name of an axis has 1 to {AXIS_NAME_MAX} characters")
        for name, number, lowest, highest in (
            ("full_steps_per_rev", self.full_steps_per_rev, 1, 100_000),
            ("driver_microsteps", self.driver_microsteps, 1, 256),
            ("lost_steps_microsteps", self.lost_steps_microsteps, 1, 1 << 31),
            ("following_error_microsteps", self.following_error_microsteps, 1, 1 << 31),
        ):
            if number is not None and not lowest <= number <= highest:
                raise OutOfRange(name, number, lowest, highest)
        for name, ratio in (("gear_ratio", self.gear_ratio), ("travel_mm_per_rev", self.travel_mm_per_rev)):
            if ratio is not None and not (math.isfinite(ratio) and 0 < ratio <= 1e6):
                raise OutOfRange(name, ratio, 0, 1e6, "above 0")

    def mechanics(self, microsteps_per_full_step: int) -> Mechanics:
        """Conversions of this axis at that microstep resolution."""
        return Mechanics(
            self.full_steps_per_rev, microsteps_per_full_step, self.gear_ratio, travel_mm_per_rev=self.travel_mm_per_rev
        )


@dataclass(frozen=True, slots=True)
class DeviceConfig:
    """One connection. Missing axes are filled up with defaults; `demo` ones are never stored."""

    name: str
    model: str
    link: Link
    clock_hz: float = 0.0
    """Chip clock [Hz]; 0 stands for the model's default."""
    axes: tuple[AxisSettings, ...] = field(default=())
    demo: bool = False
    start_up: bool = False
    """Of an emulator: it is set up whenever it is powered, so that it can move at once."""

    def __post_init__(self) -> None:
        model = find_model(self.model)
        if not self.name.strip():
            raise UsageError("a device needs a name")
        if not self.clock_hz:
            object.__setattr__(self, "clock_hz", model.clock_hz_default)
        lowest_hz, highest_hz = model.clock_hz_min, model.clock_hz_max
        if not (math.isfinite(self.clock_hz) and self.clock_hz > 0 and lowest_hz <= self.clock_hz <= highest_hz):
            raise OutOfRange("clock_hz", self.clock_hz, lowest_hz, highest_hz, "" if lowest_hz else "above 0")
        if len(self.axes) > model.axes:
            raise OutOfRange("number of axes", len(self.axes), 0, model.axes)
        missing = tuple(AxisSettings(name=f"axis {index}") for index in range(len(self.axes), model.axes))
        object.__setattr__(self, "axes", tuple(self.axes) + missing)
        object.__setattr__(self, "link", dict(self.link))
        for axis in self.axes:
            axis.limits.require_model(self.model)


def slug(name: str) -> str:
    """What stands for a name in an address: ASCII letters, digits and single dashes; never empty."""
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    return re.sub(r"[^a-z0-9]+", "-", plain.lower()).strip("-") or "device"


def unique_slug(name: str, taken: Collection[str]) -> str:
    """The slug of `name`, numbered where it is in `taken`."""
    wanted = candidate = slug(name)
    number = 2
    while candidate in taken:
        candidate = f"{wanted}-{number}"
        number += 1
    return candidate
