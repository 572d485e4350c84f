"""What came of a study: its document, what was tried, measured and found, and what is left. One JSON file a study."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from .chopper.found import ChopperFound
from .closed_loop.found import LoopFound
from .custom_search.found import CustomFound
from .document import MayKeep, StudyDocument
from .first_look.found import LookFound
from .identification.found import Identified
from .least_current.found import LeastCurrentFound
from .parts import Interval, PairOrder, Part
from .resonance_map.found import ResonanceFound
from .scored_move.found import Scored
from .stallguard.found import StallFound
from .stealthchop.found import StealthFound
from .torque_curve.found import TorqueFound

State = Literal["running", "done", "failed", "aborted", "interrupted"]
"""interrupted: the server ended in the middle of it."""
Phase = Literal["preconditions", "baseline", "twin", "search", "proof", "look", "over"]


class Held(Part):
    """A register as a study found it, or set it."""

    name: str
    axis: int | None = None
    value: int


class Switched(Part):
    """A field that no profile holds, as a study found it. off : what it holds while registers are set"""

    name: str
    field: str
    axis: int | None = None
    before: int
    off: int


class Figures(Part):
    """Of a setting: means over its moves. Null where nothing was measured."""

    time_s: float | None = Field(
        default=None,
        description="from the command until the encoder stays in its band; of several distances: of all together [s]",
    )
    spread_s: float | None = Field(default=None, description="standard deviation of that [s]")
    by_distance_s: list[float] = Field(
        default_factory=list, description="that of each of several distances, in their order [s]; empty of one"
    )
    deviation_fullsteps: float | None = Field(default=None, description="peak of encoder less position, under way")
    lost_fullsteps: float = Field(default=0.0, description="worst of all moves; multiples of 4 of a whole loss")
    runs: int = Field(default=0, description="moves there and back")


class Trial(Part):
    """A setting that was tried."""

    number: int
    setting: dict[str, float] = Field(description="in physical units, as the chip holds it")
    registers: list[Held]
    state: Literal["feasible", "infeasible", "pruned", "failed"]
    figures: Figures
    expected_s: float | None = Field(default=None, description="the least time that this ramp can take [s]")
    why: str = ""
    at_s: float = Field(default=0.0, description="since the study began [s]")


class Pair(Part):
    """A move with the old setting and the same one with the new."""

    baseline_s: float
    winner_s: float
    order: PairOrder
    baseline_deviation_fullsteps: float | None = Field(
        default=None, description="of two objectives: peak of encoder less position, under way"
    )
    winner_deviation_fullsteps: float | None = None


class DeviationEvidence(Part):
    """The deviation under way of the same pairs, where it is an objective [full steps]. Differences are winner less
    baseline."""

    baseline_fullsteps: float
    winner_fullsteps: float
    difference_fullsteps: float
    interval_fullsteps: Interval = Field(description="of the mean difference, 95 %")
    share: float = Field(description="difference over the baseline")
    p: float = Field(description="of the paired test (Wilcoxon), two-sided")
    significant: bool = Field(description="less deviation is shown")


class Evidence(Part):
    """The winner against the baseline, by pairs. Differences are winner less baseline."""

    pairs: int
    baseline_s: float
    winner_s: float
    difference_s: float
    interval_s: Interval = Field(description="of the mean difference, 95 %")
    share: float = Field(description="difference over the baseline: -0.2 is a fifth faster")
    p: float = Field(description="of the paired test (Wilcoxon), two-sided")
    test: str
    significant: bool
    runs: int = Field(description="of the winner, margin included; none of them lost a step")
    loss_rate_max: float = Field(description="upper bound of the winner's loss rate, 95 %: what so many runs can show")
    deviation: DeviationEvidence | None = Field(default=None, description="of two objectives: the other one")


class Taken(Part):
    """The setting of a study that the axis was set to."""

    trial: int
    proved: bool = Field(description="whether the study has shown it to be better; false: it held when it was tried")


class Mend(Part):
    """A call of the REST API that sets something right; `path` is behind the device's own address."""

    label: str
    method: Literal["POST", "PUT", "PATCH"]
    path: str
    body: dict[str, Any] | None = None
    moves: bool = Field(default=False, description="it may set the motor in motion")


Fault = Literal["open phase", "overload", "encoder slips", "switch backlash"]


class Finding(Part):
    """Something that was found of the axis."""

    name: str
    text: str
    fault: Fault | None = Field(default=None, description="what is broken; null: nothing that has a name")
    value: float | None = None
    unit: str = ""
    interval: Interval | None = Field(default=None, description="95 %")
    sure: Literal["certain", "measured", "cannot be told", "missing"] = "measured"
    remedy: Mend | None = Field(default=None, description="what would set it right")


class MoveCurve(Part):
    """A move as its encoder saw it, thinned out for a plot."""

    which: Literal["before", "best", "present"] = Field(description="present: of the latest trial")
    time_s: list[float] = Field(description="from the command on [s]")
    fullsteps: list[float] = Field(description="of the encoder, from where the move began [full steps]")


class TwinSetting(Part):
    """A setting that held on the twin."""

    setting: dict[str, float]
    time_s: float | None = Field(default=None, description="there, where what is looked for is a time [s]")
    value: float = Field(default=0.0, description="there, of the first objective: the less the better")


class AngleHarmonic(Part):
    """The part sine * sin(order * angle) + cosine * cos(order * angle) of an error [deg]."""

    order: int
    sine_deg: float
    cosine_deg: float
    amplitude_deg: float
    half_deg: float = Field(description="half the 95 % interval of sine and of cosine")


class AngleFigures(Part):
    """How far a motor stands from where it was told, over the electrical angle [deg electrical]."""

    rms_deg: float
    harmonics: list[AngleHarmonic]
    shaft: list[AngleHarmonic] = Field(
        description="once and twice a turn, of encoder or coupling [deg of the shaft]; not corrected"
    )
    friction_deg: float = Field(description="half of what is between both ways: friction, hysteresis")
    friction_half_deg: float
    residual_deg: float = Field(description="root mean square of what none of this explains")
    periods: int = Field(description="electrical periods, of both ways")
    curve_deg: list[float] = Field(description="mean of both ways, in equal steps over the electrical period")
    both_ways_deg: list[float] = Field(description="half their difference there")


class AnglePair(Part):
    """The error with the old table and with the new one, root mean square [deg electrical]."""

    baseline_deg: float
    winner_deg: float
    order: PairOrder


class AngleEffect(Part):
    """The new table against the old one, by pairs. Differences are new less old [deg electrical]."""

    pairs: int
    baseline_deg: float
    winner_deg: float
    difference_deg: float
    interval_deg: Interval
    p: float = Field(description="of the paired test (Wilcoxon), two-sided")
    significant: bool


class MicrostepFigures(Part):
    """What came of a microstep calibration."""

    microsteps_per_deg: float = Field(description="of the axis, in a degree electrical")
    before: AngleFigures
    wave_before: list[int] = Field(description="quarter wave of the table, 256 values")
    wave: list[int] | None = Field(default=None, description="of the new one; null: none could be better")
    predicted_rms_deg: float | None = Field(default=None, description="what the new table was expected to leave")
    predicted_deg: list[float] = Field(default_factory=list, description="the same over the electrical period")
    beyond_rms_deg: float | None = Field(
        default=None, description="what no table of a quarter wave can take away: what is between the phases"
    )
    after: AngleFigures | None = None
    pairs: list[AnglePair] = Field(default_factory=list)
    effect: AngleEffect | None = None


class StudyRecord(Part):
    """A study and all that came of it."""

    id: str
    document: StudyDocument
    state: State = "running"
    phase: Phase = "preconditions"
    progress: float = 0.0
    left_s: float | None = Field(default=None, description="about how long it takes yet [s]")
    message: str = ""
    started_unix_s: float
    ended_unix_s: float | None = None
    by: str = ""
    device_name: str = ""
    model: str = ""
    baseline: list[Held] = Field(default_factory=list, description="what the axis was set to before")
    switched: Switched | None = Field(default=None, description="what no profile holds, and the study switches")
    baseline_setting: dict[str, float] = Field(default_factory=dict)
    baseline_figures: Figures | None = None
    units: dict[str, str] = Field(default_factory=dict, description="of each setting of the space")
    trials: list[Trial] = Field(default_factory=list)
    best: int | None = Field(default=None, description="number of the trial that is the best so far")
    moves: list[MoveCurve] = Field(default_factory=list, description="of a fastest move: moves to the far end")
    front: list[int] = Field(default_factory=list, description="of two objectives: those that none beats in both")
    pairs: list[Pair] = Field(default_factory=list)
    evidence: Evidence | None = None
    improved: bool | None = Field(default=None, description="null: it did not come to a proof")
    verdict: str = ""
    findings: list[Finding] = Field(default_factory=list)
    looked: LookFound | None = Field(default=None, description="of a first look: its encoder on the way")
    microsteps: MicrostepFigures | None = Field(default=None, description="of a microstep calibration")
    identified: Identified | None = Field(default=None, description="motor and machine, as a study found them")
    loop: LoopFound | None = Field(default=None, description="of a study of the closed loop")
    runs: int = 0
    way_fullsteps: float = 0.0
    start: int | None = Field(default=None, description="where it began, and goes on from [microsteps]")
    ran_s: float = Field(default=0.0, description="how long it has run, all its beginnings together [s]")
    left: list[str] = Field(default_factory=list, description="what is not as it was before; empty where all is")
    taken: Taken | None = Field(default=None, description="what the axis was set to of it; null: nothing, or undone")
    recording: str | None = None
    twin: list[TwinSetting] = Field(default_factory=list, description="the best on the twin, tried on the axis first")
    no_twin: str = Field(default="", description="why none was tried first, where the document left that open")
    stallguard: StallFound | None = Field(default=None, description="of a study of StallGuard")
    least_current: LeastCurrentFound | None = Field(default=None, description="of a study of the least current")
    chopper: ChopperFound | None = Field(default=None, description="of a study of the chopper")
    stealthchop: StealthFound | None = Field(default=None, description="of a study of StealthChop")
    torque: TorqueFound | None = Field(default=None, description="of a study of torque over speed")
    resonances: ResonanceFound | None = Field(default=None, description="of a resonance map")
    scored: Scored | None = Field(default=None, description="of a scored move")
    custom: CustomFound | None = Field(default=None, description="of an own search")
    noticed: bool = Field(default=False, description="the scored move was made by somebody, and noticed")
    next: str = Field(default="", description="what would be worth doing next")

    @model_validator(mode="before")
    @classmethod
    def _kept_before_twins(cls, data: Any) -> Any:
        """A record tells the twin that was tried: one that is older than twins names none, and had none."""
        match data:
            case {"document": {"study": {"kind": "fastest_move" | "least_current"} as study}}:
                study.setdefault("twin", None)
        return data

    def trial(self, number: int | None) -> Trial | None:
        """The trial of that number."""
        return next((trial for trial in self.trials if trial.number == number), None)

    @property
    def proved_alone(self) -> list[int]:
        """Numbers of the trials that are proved at one speed each, beside the best one."""
        return [] if self.stallguard is None else [one.own.trial for one in self.stallguard.speeds if one.own]

    @property
    def left_switched(self) -> Switched | None:
        """What no profile holds, and the study has not switched back: it was cut off, or keeps what it found."""
        study = self.document.study
        keeps = self.improved is True and isinstance(study, MayKeep) and study.keep
        return self.switched if self.left or keeps else None

    def before_told(self) -> list[str]:
        """What the axis was set to before, register by register."""
        told = [f"{each.name} (was {each.value})" for each in self.baseline]
        switched = self.switched
        return told if switched is None else [*told, f"{switched.name} ({switched.field} was {switched.before})"]
