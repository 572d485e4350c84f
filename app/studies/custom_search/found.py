"""What an own search tells beside its trials. Objectives stand in the order of the document."""

from __future__ import annotations

from pydantic import Field

from ..document import ScoredFigure
from ..parts import Interval, PairOrder, Part
from ..scored_move.found import Scored


class Searchable(Part):
    """A setting of an axis that may be searched: how it is named, and what it takes."""

    name: str
    unit: str = Field(description="of low, high and now; empty: the numbers of the register")
    low: float
    high: float = Field(description="as far as the register goes; of currents as now")
    now: float
    one: float = Field(description="what one more in the register is")
    group: str
    help: str


class CustomTried(Part):
    """All figures of a trial."""

    number: int = Field(description="of the trial")
    figures: Scored
    told: list[float] = Field(description="what the search was told of each objective: the less the better")
    violation: float = Field(description="above 0: it lost steps, did not come to rest, or broke a bound")


class FigurePair(Part):
    """The same moves with the setting before and with the new one: each objective."""

    baseline: list[float]
    winner: list[float]
    order: PairOrder


class FigureEffect(Part):
    """One objective of the new setting against the one before, by pairs. Differences are new less old."""

    figure: ScoredFigure
    unit: str
    baseline: float
    winner: float
    difference: float
    interval: Interval = Field(description="of the mean difference, 95 %")
    p: float = Field(description="of the paired test (Wilcoxon), two-sided; with two objectives taken twice")
    significant: bool = Field(description="shown to be better")
    worse: bool = Field(description="may be worse by more than the smallest gain")


class CustomFound(Part):
    """What came of an own search."""

    objectives: list[ScoredFigure]
    before: Scored | None = None
    tried: list[CustomTried] = Field(default_factory=list)
    again: list[CustomTried] = Field(
        default_factory=list, description="the best few, measured again before the proof: by these one is chosen"
    )
    pairs: list[FigurePair] = Field(default_factory=list)
    effects: list[FigureEffect] = Field(default_factory=list, description="one an objective; empty: no proof yet")
    runs: int = Field(default=0, description="of the new setting in the proof, all moves each; none lost steps")
    loss_rate_max: float | None = Field(default=None, description="upper bound of its loss rate, 95 %")
