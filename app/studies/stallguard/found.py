"""What a study of StallGuard tells of each speed: load values of free runs and of stalls, and how often either is told
wrong."""

from __future__ import annotations

from pydantic import Field

from ..parts import Part


class Rate(Part):
    """How often something went wrong."""

    wrong: int
    runs: int
    most: float = Field(description="upper bound of the rate, 95 %, one-sided, exact (Clopper and Pearson)")


class RocPoint(Part):
    """A level, and what a threshold there would do with the runs that were measured."""

    level: float
    false: float = Field(description="share of free runs with a stall told")
    missed: float = Field(description="share of stalls not told")


class StallAlone(Part):
    """The threshold that suits one speed alone best. Not proved: it is counted in the very runs it was chosen by."""

    threshold: int
    filtered: bool
    level: float = Field(description="at it or below a value is a stall")
    false: int = Field(description="false stalls it would have told in the free runs that were measured")
    free_runs: int
    missed: int = Field(description="stalls it would have missed in the runs into the stop that were measured")
    stops: int
    may_do: bool = Field(description="whether these runs leave it open that it gets no more wrong than was asked for")


class StallOwn(Part):
    """The threshold of one speed at which that of the others does not do it, proved there by held-out runs."""

    threshold: int
    filtered: bool
    level: float = Field(description="at it or below a value is a stall")
    from_pps: float = Field(description="speed from which on a stall has to stop the motor, as it was proved [pps]")
    trial: int = Field(description="its number: that has the registers")


class StallSpeed(Part):
    """One speed. Load values are those at threshold 0; least: of each run, with the filter where the choice has it."""

    speed_rps: float
    speed_pps: float
    free: list[float] = Field(default_factory=list, description="least load value of each free run")
    stops: list[float] = Field(default_factory=list, description="least load value of each run into the stop")
    values: list[float] = Field(default_factory=list, description="edges of the histogram [counts]")
    free_share: list[float] = Field(default_factory=list, description="of all values of free runs, between two edges")
    stop_share: list[float] = Field(default_factory=list, description="the same against the stop")
    roc: list[RocPoint] = Field(default_factory=list)
    alone: StallAlone | None = Field(
        default=None, description="what suits this speed alone, not held out; null: too few runs of it were measured"
    )
    own: StallOwn | None = Field(
        default=None,
        description="what is proved at this speed alone; null: the choice does it here, or `why` says why nothing is",
    )
    why: str = Field(
        default="", description="why the choice does not do it at this speed, and of no own, why nothing does"
    )
    false: Rate | None = Field(
        default=None,
        description="false stalls in held-out free runs, the motor stopping by them: by the choice; of a speed with "
        "its own threshold by that; where nothing is proved by the last that was tried",
    )
    missed: Rate | None = Field(default=None, description="stalls missed in held-out runs into the stop, by the same")
    false_before: Rate | None = Field(default=None, description="the same with the setting before")
    missed_before: Rate | None = None


class StallFound(Part):
    """What StallGuard tells of this axis."""

    generation: int = Field(description="2: StallGuard2, with SpreadCycle; 4: StallGuard4, with StealthChop")
    stop_at: int | None = Field(default=None, description="where the stop is [microsteps]")
    slope: float = Field(default=0.0, description="what one more of the threshold adds to a load value [counts]")
    level: float | None = Field(default=None, description="of the choice: at it or below a value is a stall")
    filtered: bool = False
    from_rps: float | None = Field(default=None, description="least speed at which the choice does it")
    to_rps: float | None = Field(default=None, description="greatest of the asked speeds at which it does")
    run_fullsteps: float = Field(description="what a free run is [full steps]")
    push_fullsteps: float = Field(description="how far into the stop a stall has to be told [full steps]")
    speeds: list[StallSpeed] = Field(default_factory=list)
