"""The studies that there are: what each is for, how it is planned, and how it runs."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import cached_property

from ..clock import Clock
from ..devices.core.device import Device
from .document import Kind, StudyDocument
from .plan import StudyPlan
from .record import StudyRecord
from .run import Keeper, StudyRun
from .twins.on_twin import OnTwin


@dataclass(frozen=True, slots=True)
class StudyParts:
    """What a study is made of: see the properties of `StudyKind`."""

    make: Callable[[Device, int, Clock, StudyRecord, Keeper], StudyRun]
    plan: Callable[[Device, int, StudyDocument], Awaitable[StudyPlan]]
    on_twin: OnTwin | None = None


@dataclass(frozen=True)
class StudyKind:
    """One of them. A server starts without what studies are made of: most of it nobody asks for.

    channels : what its recording has of the axis
    import_parts : imports its modules
    sets_nothing : its setting is that of the axis; what was before is what there is when it is taken
    goes_on : cut off, it keeps what is whole and goes on with the rest; else its pieces hang on one another, or are
        few, and it begins anew
    no_twin : why none of its settings is tried on an emulated twin
    """

    kind: Kind
    title: str
    purpose: str
    channels: tuple[str, ...]
    import_parts: Callable[[], StudyParts]
    sets_nothing: bool = False
    goes_on: bool = False
    no_twin: str = ""

    @cached_property
    def _parts(self) -> StudyParts:
        return self.import_parts()

    @property
    def make(self) -> Callable[[Device, int, Clock, StudyRecord, Keeper], StudyRun]:
        """A run of it."""
        return self._parts.make

    @property
    def plan(self) -> Callable[[Device, int, StudyDocument], Awaitable[StudyPlan]]:
        """What it would do. Nothing moves."""
        return self._parts.plan

    @property
    def on_twin(self) -> OnTwin | None:
        """How one of its settings is tried on an emulated twin; None: it runs on the axis alone."""
        return self._parts.on_twin


def _chopper() -> StudyParts:
    from .chopper import plan
    from .chopper.study import ChopperStudy

    return StudyParts(ChopperStudy, plan.plan)


def _closed_loop() -> StudyParts:
    from .closed_loop import plan
    from .closed_loop.study import ClosedLoopStudy

    return StudyParts(ClosedLoopStudy, plan.plan)


def _custom_search() -> StudyParts:
    from .custom_search import plan
    from .custom_search.study import CustomSearchStudy

    return StudyParts(CustomSearchStudy, plan.plan)


def _fastest_move() -> StudyParts:
    from .fastest_move import ranges
    from .fastest_move.study import FastestMoveStudy
    from .fastest_move.trials import ON_TWIN

    return StudyParts(FastestMoveStudy, ranges.plan, ON_TWIN)


def _first_look() -> StudyParts:
    from .first_look import plan
    from .first_look.study import FirstLookStudy

    return StudyParts(FirstLookStudy, plan.plan)


def _identification() -> StudyParts:
    from .identification import plan
    from .identification.study import IdentificationStudy

    return StudyParts(IdentificationStudy, plan.plan)


def _least_current() -> StudyParts:
    from .least_current import plan
    from .least_current.cycles import ON_TWIN
    from .least_current.study import LeastCurrentStudy

    return StudyParts(LeastCurrentStudy, plan.plan, ON_TWIN)


def _microstep_calibration() -> StudyParts:
    from .microstep_calibration import plan
    from .microstep_calibration.study import MicrostepCalibrationStudy

    return StudyParts(MicrostepCalibrationStudy, plan.plan)


def _resonance_map() -> StudyParts:
    from .resonance_map import plan
    from .resonance_map.study import ResonanceMapStudy

    return StudyParts(ResonanceMapStudy, plan.plan)


def _scored_move() -> StudyParts:
    from .scored_move import plan
    from .scored_move.study import ScoredMoveStudy

    return StudyParts(ScoredMoveStudy, plan.plan)


def _stallguard() -> StudyParts:
    from .stallguard import plan
    from .stallguard.study import StallGuardStudy

    return StudyParts(StallGuardStudy, plan.plan)


def _stealthchop() -> StudyParts:
    from .stealthchop import plan
    from .stealthchop.study import StealthChopStudy

    return StudyParts(StealthChopStudy, plan.plan)


def _torque_curve() -> StudyParts:
    from .torque_curve import plan
    from .torque_curve.study import TorqueCurveStudy

    return StudyParts(TorqueCurveStudy, plan.plan)


MADE_OF_IT = "a twin is made of what it finds"
MEASURES = "it measures what this axis does, and searches nothing"
POSITIONS = ("position", "encoder_position", "velocity")
KINDS: dict[Kind, StudyKind] = {
    "first_look": StudyKind(
        "first_look",
        "First look",
        "direction, encoder, switches, travel, and what is missing: small moves alone",
        POSITIONS,
        _first_look,
        no_twin=MADE_OF_IT,
    ),
    "fastest_move": StudyKind(
        "fastest_move",
        "Fastest move",
        "faster: the ramp with the shortest move at which no step is lost, with a margin",
        POSITIONS,
        _fastest_move,
        goes_on=True,
    ),
    "identification": StudyKind(
        "identification",
        "Motor and machine",
        "what hangs on it: resonance, damping, friction, inertia, backlash and encoder, by the encoder",
        POSITIONS,
        _identification,
        no_twin=MADE_OF_IT,
    ),
    "least_current": StudyKind(
        "least_current",
        "Least current",
        "cooler: the least run current at which a load cycle loses no step, with a margin, and what it saves",
        POSITIONS,
        _least_current,
        goes_on=True,
    ),
    "microstep_calibration": StudyKind(
        "microstep_calibration",
        "Microstep calibration",
        "more exact: a microstep table that makes up for the motor's angle error, by the encoder",
        POSITIONS,
        _microstep_calibration,
        no_twin="it mends the angle error of this very motor, which no twin has",
    ),
    "resonance_map": StudyKind(
        "resonance_map",
        "Resonance map",
        "quieter: how much it vibrates at each speed, which order meets the resonance, and which setting moves that",
        POSITIONS,
        _resonance_map,
        goes_on=True,
        no_twin=MEASURES,
    ),
    "chopper": StudyKind(
        "chopper",
        "Chopper",
        "quieter: hysteresis, TOFF and TBL of SpreadCycle by which the shaft shakes least, by the encoder",
        POSITIONS,
        _chopper,
        goes_on=True,
        no_twin="the ripple of this driver and motor decides it, which a twin only models",
    ),
    "stealthchop": StudyKind(
        "stealthchop",
        "StealthChop",
        "silent: amplitudes that fit the motor, and up to which speed StealthChop works before the change jolts",
        POSITIONS,
        _stealthchop,
        goes_on=True,
        no_twin="the ripple of this driver and motor decides it, which a twin only models",
    ),
    "scored_move": StudyKind(
        "scored_move",
        "Scored move",
        "by hand: change what you like, move, and compare; the settings in force are kept with the figures",
        (*POSITIONS, "load_value"),
        _scored_move,
        sets_nothing=True,
        no_twin="it moves with the setting as it is, and searches nothing",
    ),
    "closed_loop": StudyKind(
        "closed_loop",
        "Closed loop",
        "holds by its encoder: gains of a position loop for asked margins, by the motor's own resonance",
        POSITIONS,
        _closed_loop,
        goes_on=True,
        no_twin="gains are worked out from what it measures, and not searched",
    ),
    "stallguard": StudyKind(
        "stallguard",
        "StallGuard threshold",
        "reliable homing: the threshold that tells a stall from a free run, with rates of both errors",
        (*POSITIONS, "load_value"),
        _stallguard,
        goes_on=True,
        no_twin="load values are those of this motor and driver, which no twin knows",
    ),
    "torque_curve": StudyKind(
        "torque_curve",
        "Torque over speed",
        "how much the motor has at each speed, and what its ramp leaves of it: accelerated until steps are lost",
        POSITIONS,
        _torque_curve,
        goes_on=True,
        no_twin=MEASURES,
    ),
    "custom_search": StudyKind(
        "custom_search",
        "Own search",
        "as you say: your own settings, ranges, moves and objectives, searched and proved like any other",
        (*POSITIONS, "load_value"),
        _custom_search,
        goes_on=True,
        no_twin="a twin does not model all that may be searched",
    ),
}
