"""Ground truth of an emulated axis: what no driver can read."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ProgramGroundTruth:
    """What an interpreter holds that no command reads."""

    flags: tuple[str, ...]
    """Those that are set, by name."""
    stack: tuple[int, ...]
    """Where subroutines return to, the innermost last."""
    waits: bool
    """A WAIT is not met yet."""
    interrupted: bool
    """An interrupt is being served."""


@dataclass(frozen=True, slots=True)
class GroundTruth:
    """One axis, now. Full steps; None where the emulator has no such thing."""

    shaft_fullsteps: float
    """Where the rotor, or the carriage, is."""
    lost_fullsteps: int | None = None
    """What the rotor fell behind (> 0) or got ahead since power-on: multiples of four."""
    blocked: bool | None = None
    """The shaft is clamped."""
    speed_fullsteps_s: float | None = None
    bridges: str = ""
    """What the driver's bridges do."""
    program: ProgramGroundTruth | None = None
    """Of one that executes programs."""
