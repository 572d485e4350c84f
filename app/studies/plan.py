"""What a study will do to the machine, told before it does."""

from __future__ import annotations

from pydantic import Field

from .document import Part


class StudyPlan(Part):
    """What will happen. Nothing begins while something is `missing`."""

    title: str
    missing: list[str] = Field(description="what is missing, each with its cure; empty: it can begin")
    warnings: list[str] = Field(default_factory=list)
    steps: list[str] = Field(default_factory=list, description="what it does, in order, for people")
    position_from: int | None = Field(default=None, description="it stays between these [microsteps]")
    position_to: int | None = None
    velocity_max_pps: float | None = None
    acceleration_max_pps2: float | None = None
    moves_max: int = 0
    way_fullsteps: float = Field(default=0.0, description="at most, of the motor [full steps]")
    time_s: float = Field(default=0.0, description="about, at most [s]")
    registers: list[str] = Field(default_factory=list, description="those that it sets, and sets back")
    unwatched: list[str] = Field(default_factory=list, description="what nothing of it would notice")
