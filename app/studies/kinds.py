"""The studies that there are: what each is for, how it is planned, and how it runs."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from ..clock import Clock
from ..devices.core.device import Device
from .chopper import plan as chopper
from .chopper.study import ChopperStudy
from .closed_loop import plan as closed_loop
from .closed_loop.study import ClosedLoopStudy
from .document import Kind, StudyDocument
from .fastest_move import ranges as fastest_move
from .fastest_move.study import FastestMoveStudy
from .fastest_move.trials import ON_TWIN as MOVE_ON_TWIN
from .first_look import plan as first_look
from .first_look.study import FirstLookStudy
from .identification import plan as identification
from .identification.study import IdentificationStudy
from .least_current import plan as least_current
from .least_current.study import LeastCurrentStudy
from .microstep_calibration import plan as microstep_calibration
from .microstep_calibration.study import MicrostepCalibrationStudy
from .plan import StudyPlan
from .record import StudyRecord
from .resonance_map import plan as resonance_map
from .resonance_map.study import ResonanceMapStudy
from .run import Keeper, StudyRun
from .scored_move import plan as scored_move
from .scored_move.study import ScoredMoveStudy
from .stallguard import plan as stallguard
from .stallguard.study import StallGuardStudy
from .stealthchop import plan as stealthchop
from .stealthchop.study import StealthChopStudy
from .torque_curve import plan as torque_curve
from .torque_curve.study import TorqueCurveStudy
from .twins.on_twin import OnTwin


@dataclass(frozen=True, slots=True)
class StudyKind:
    """One of them.

    channels : what its recording has of the axis
    sets_nothing : its setting is that of the axis; what was before is what there is when it is taken
    on_twin : how one of its settings is tried on an emulated twin; None: it runs on the axis alone
    no_twin : why it does
    """

    kind: Kind
    title: str
    purpose: str
    channels: tuple[str, ...]
    make: Callable[[Device, int, Clock, StudyRecord, Keeper], StudyRun]
    plan: Callable[[Device, int, StudyDocument], Awaitable[StudyPlan]]
    on_twin: OnTwin | None = None
    sets_nothing: bool = False
    no_twin: str = ""


MADE_OF_IT = "a twin is made of what it finds"
MEASURES = "it measures what this axis does, and searches nothing"
POSITIONS = ("position", "encoder_position", "velocity")
KINDS: dict[Kind, StudyKind] = {
    "first_look": StudyKind(
        "first_look",
        "First look",
        "direction, encoder, switches, travel, and what is missing: small moves alone",
        POSITIONS,
        FirstLookStudy,
        first_look.plan,
        no_twin=MADE_OF_IT,
    ),
    "fastest_move": StudyKind(
        "fastest_move",
        "Fastest move",
        "faster: the ramp with the shortest move at which no step is lost, with a margin",
        POSITIONS,
        FastestMoveStudy,
        fastest_move.plan,
        MOVE_ON_TWIN,
    ),
    "identification": StudyKind(
        "identification",
        "Motor and machine",
        "what hangs on it: resonance, damping, friction, inertia, backlash and encoder, by the encoder",
        POSITIONS,
        IdentificationStudy,
        identification.plan,
        no_twin=MADE_OF_IT,
    ),
    "least_current": StudyKind(
        "least_current",
        "Least current",
        "cooler: the least run current at which a load cycle loses no step, with a margin, and what it saves",
        POSITIONS,
        LeastCurrentStudy,
        least_current.plan,
        no_twin="load and friction decide it, which is what a twin knows least",
    ),
    "microstep_calibration": StudyKind(
        "microstep_calibration",
        "Microstep calibration",
        "more exact: a microstep table that makes up for the motor's angle error, by the encoder",
        POSITIONS,
        MicrostepCalibrationStudy,
        microstep_calibration.plan,
        no_twin="it mends the angle error of this very motor, which no twin has",
    ),
    "resonance_map": StudyKind(
        "resonance_map",
        "Resonance map",
        "quieter: how much it vibrates at each speed, which order meets the resonance, and which setting moves that",
        POSITIONS,
        ResonanceMapStudy,
        resonance_map.plan,
        no_twin=MEASURES,
    ),
    "chopper": StudyKind(
        "chopper",
        "Chopper",
        "quieter: hysteresis, TOFF and TBL of SpreadCycle by which the shaft shakes least, by the encoder",
        POSITIONS,
        ChopperStudy,
        chopper.plan,
        no_twin="the ripple of this driver and motor decides it, which a twin only models",
    ),
    "stealthchop": StudyKind(
        "stealthchop",
        "StealthChop",
        "silent: amplitudes that fit the motor, and up to which speed StealthChop works before the change jolts",
        POSITIONS,
        StealthChopStudy,
        stealthchop.plan,
        no_twin="the ripple of this driver and motor decides it, which a twin only models",
    ),
    "scored_move": StudyKind(
        "scored_move",
        "Scored move",
        "by hand: change what you like, move, and compare; the settings in force are kept with the figures",
        (*POSITIONS, "load_value"),
        ScoredMoveStudy,
        scored_move.plan,
        sets_nothing=True,
        no_twin="it moves with the setting as it is, and searches nothing",
    ),
    "closed_loop": StudyKind(
        "closed_loop",
        "Closed loop",
        "holds by its encoder: gains of a position loop for asked margins, by the motor's own resonance",
        POSITIONS,
        ClosedLoopStudy,
        closed_loop.plan,
        no_twin="gains are worked out from what it measures, and not searched",
    ),
    "stallguard": StudyKind(
        "stallguard",
        "StallGuard threshold",
        "reliable homing: the threshold that tells a stall from a free run, with rates of both errors",
        (*POSITIONS, "load_value"),
        StallGuardStudy,
        stallguard.plan,
        no_twin="load values are those of this motor and driver, which no twin knows",
    ),
    "torque_curve": StudyKind(
        "torque_curve",
        "Torque over speed",
        "how much the motor has at each speed, and what its ramp leaves of it: accelerated until steps are lost",
        POSITIONS,
        TorqueCurveStudy,
        torque_curve.plan,
        no_twin=MEASURES,
    ),
}
