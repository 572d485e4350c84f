"""Setting a device up after power-on so that its axes can move: what is wanted in physical figures, as writes.

Each family plans it in a start-up module of its own (`DeviceFamily.start_plan`); nothing is written here.
"""

from __future__ import annotations

import math
from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass, field

from ...errors import OutOfRange, UsageError
from .config import AxisSettings
from .device import Device
from .results import WriteItem

TURNS_PER_S, TURNS_PER_S2 = 1.0, 4.0
"""Speed and acceleration where nobody says any: any stepper motor does that."""
HOLD_SHARE = 0.5
"""Of the run current at standstill, where only the run current is known."""


@dataclass(frozen=True, slots=True)
class Figures:
    """How an axis shall move; None for what follows from the motor or is the family's.

    velocity_pps, acceleration_pps2, deceleration_pps2 : in microsteps
    run_current_a, hold_current_a : of a coil, RMS [A]
    run_scale, hold_scale : the same in steps of the chip's own scale
    counts_per_rev : of the encoder, four a line; 0 for none
    stops : the stop switches are in force, active at high level unless `stop_low_active`
    """

    velocity_pps: float | None = None
    acceleration_pps2: float | None = None
    deceleration_pps2: float | None = None
    microsteps: int | None = None
    run_current_a: float | None = None
    hold_current_a: float | None = None
    run_scale: int | None = None
    hold_scale: int | None = None
    counts_per_rev: int = 0
    invert_encoder: bool = False
    stops: bool = True
    stop_low_active: bool = False


@dataclass(frozen=True, slots=True)
class Chosen:
    """A figure that nobody asked for, and why it is that."""

    name: str
    axis: int
    value: float
    unit: str
    why: str


@dataclass(slots=True)
class AxisStartUp:
    """One axis to be set up: its settings as they will be, the figures, and what was chosen beside them."""

    axis: int
    settings: AxisSettings
    figures: Figures
    rated_current_a: float | None = None
    """RMS of a coil, of the motor [A]."""
    chosen: list[Chosen] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def choose(self, name: str, value: float, unit: str, why: str) -> float:
        """Tell of a figure that nobody asked for."""
        self.chosen.append(Chosen(name, self.axis, value, unit, why))
        return value

    def microsteps(self, default: int, allowed: Sequence[int]) -> int:
        """Microsteps per full step. Raises UsageError for a resolution that the chip does not have."""
        asked = self.figures.microsteps
        if asked is None:
            return int(self.choose("microsteps", default, "per full step", "the finest of this chip"))
        if asked not in allowed:
            raise UsageError(f"microsteps is {asked}, this chip has {', '.join(str(each) for each in allowed)}")
        return asked

    def velocity_pps(self, microsteps: int) -> float:
        """Speed of moves: as asked, else a turn a second within the soft limit."""
        if self.figures.velocity_pps is not None:
            return self.figures.velocity_pps
        turn = TURNS_PER_S * self.settings.full_steps_per_rev * microsteps
        return self._within("velocity_pps", turn, "pps", "a turn a second", self.settings.limits.velocity_max_pps)

    def acceleration_pps2(self, microsteps: int) -> float:
        """Acceleration: as asked, else the speed of a turn a second within a quarter of it, within the soft limit."""
        if self.figures.acceleration_pps2 is not None:
            return self.figures.acceleration_pps2
        slope = TURNS_PER_S2 * self.settings.full_steps_per_rev * microsteps
        limit = self.settings.limits.acceleration_max_pps2
        return self._within("acceleration_pps2", slope, "pps^2", "a turn a second within 0.25 s", limit)

    def deceleration_pps2(self, acceleration_pps2: float) -> float:
        """Deceleration: as asked, else the acceleration."""
        asked = self.figures.deceleration_pps2
        return acceleration_pps2 if asked is None else asked

    def _within(self, name: str, value: float, unit: str, why: str, limit: float | None) -> float:
        if limit is not None and limit < value:
            # A hair less, so that rounding to whole chip units stays within.
            return self.choose(name, limit * 0.99, unit, "just within the soft limit")
        return self.choose(name, value, unit, why)

    # --- currents -------------------------------------------------------------------------------

    def run_current_a(self) -> float | None:
        """RMS of a coil while it moves [A]: as asked, else the motor's rating, within the soft limit; None: unknown."""
        asked, rated, limit = self.figures.run_current_a, self.rated_current_a, self.settings.limits.current_max_a
        if asked is not None or rated is None:
            return asked
        if limit is not None and limit < rated:
            return self.choose("run_current_a", limit, "A", "RMS, the soft limit; the motor is rated higher")
        return self.choose("run_current_a", rated, "A", "RMS, the motor's rating")

    def hold_current_a(self, run_a: float) -> float:
        """RMS of a coil at rest [A]: as asked, else half of the run current."""
        asked = self.figures.hold_current_a
        if asked is not None:
            return asked
        return self.choose("hold_current_a", HOLD_SHARE * run_a, "A", "RMS, half the run current")

    def scales(self, most: int, run: int, hold: int, least: int = 0) -> tuple[int, int]:
        """Run and hold scale, each as asked, else these. Raises OutOfRange outside `least`..`most`."""
        for name, asked in (("run_scale", self.figures.run_scale), ("hold_scale", self.figures.hold_scale)):
            if asked is not None and not least <= asked <= most:
                raise OutOfRange(name, asked, least, most, "steps of this chip's current scale")
        asked_run, asked_hold = self.figures.run_scale, self.figures.hold_scale
        if asked_run is None:
            self.choose("run_scale", run, f"of {most}", "of the chip's full scale")
        if asked_hold is None:
            self.choose("hold_scale", hold, f"of {most}", "of the chip's full scale")
        return (run if asked_run is None else asked_run), (hold if asked_hold is None else asked_hold)

    def require_no_current(self, why: str) -> None:
        """For families that set none. Raises UsageError where one is asked for."""
        figures = self.figures
        for name in ("run_current_a", "hold_current_a", "run_scale", "hold_scale"):
            if getattr(figures, name) is not None:
                raise UsageError(f"{name} cannot be set here: {why}")
        if self.rated_current_a is not None:
            self.warnings.append(f"the current is not set: {why}")

    def share_of_full_scale(self, hint: str = "current_full_scale_a") -> tuple[float, float] | None:
        """Run and hold current as shares of full scale, 0..1; None where amperes cannot be told or none are wanted.

        Raises UsageError where amperes are asked for and nobody knows full scale, OutOfRange above it.
        """
        run_a, full_a = self.run_current_a(), self.settings.limits.current_full_scale_a
        if run_a is None:
            return None
        if full_a is None:
            self.no_amperes(hint)
            return None
        if run_a > full_a:
            raise OutOfRange("run_current_a", run_a, 0, full_a, "A RMS, the full scale of this axis")
        hold_a = self.hold_current_a(run_a)
        return run_a / full_a, min(hold_a, run_a) / full_a

    def no_amperes(self, needed: str) -> None:
        """Nobody knows what a scale is in A. Raises UsageError where amperes are asked for, else a warning tells."""
        if self.figures.run_current_a is not None or self.figures.hold_current_a is not None:
            raise UsageError(f"run_current_a needs {needed} in the axis's settings or in motor; or give run_scale")
        self.warnings.append(
            f"axis {self.axis}: what a current scale is in A is not known ({needed}); the scales are cautious ones"
        )


@dataclass(slots=True)
class StartPlan:
    """What to write, in the order of the data sheets; of a register that comes twice the last counts.

    tables : whole tables by the names of a profile's: `microstep` (64 values), `driver_chain` (32 words)
    encoders : by axis the counter of an encoder that shall show the position when its resolution is set
    """

    items: list[WriteItem]
    tables: Mapping[str, Sequence[int]] = field(default_factory=dict)
    encoders: Mapping[int, str] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


StartPlanner = Callable[[Device, Sequence[AxisStartUp]], Awaitable[StartPlan]]
"""How a family plans it. It may read the device and writes nothing. Raises UsageError for what its registers cannot
hold."""


def scale_of(share: float, most: int) -> int:
    """The greatest scale, n + 1 parts of `most` + 1, that is not above `share` of full scale."""
    return max(0, min(most, math.floor(share * (most + 1) * (1 + 1e-9)) - 1))
