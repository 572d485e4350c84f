"""A study as a document: which axis, what is looked for, and how much of trials, time and way it may cost.

Written by forms, REST, the command line or Python; versioned like a profile. An unknown key is an error.
"""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal, Protocol, TypeAlias, TypeVar, runtime_checkable

from pydantic import Field, StringConstraints, model_validator

from .parts import Part

FORMAT: Final = "stepscope-study"
VERSION: Final = 1

Int = Annotated[int, Field(strict=True)]
Positive = Annotated[float, Field(strict=True, gt=0, le=1e12, allow_inf_nan=False)]
Sampler = Literal["tpe", "cmaes", "nsga2"]


class Budget(Part):
    """What a study may cost at most; the first that is used up ends its search."""

    trials: Annotated[int, Field(strict=True, ge=1, le=1000)] = Field(
        default=30, description="settings that are tried by moving the motor"
    )
    time_s: Annotated[float, Field(strict=True, gt=0, le=86_400, allow_inf_nan=False)] = Field(
        default=900.0, description="of the server's clock, proof included [s]"
    )
    distance_fullsteps: Positive | None = Field(
        default=None, description="way of the motor, there and back, proof included [full steps]; null: no bound"
    )


class TwinMotor(Part):
    """What is known of the motor and its load, for a twin: of a name plate, a list, or an earlier study."""

    holding_torque_nm: Annotated[float, Field(strict=True, gt=0, le=50, allow_inf_nan=False)] = 0.45
    rated_current_a: Annotated[float, Field(strict=True, gt=0, le=20, allow_inf_nan=False)] = 1.5
    resistance_ohm: Annotated[float, Field(strict=True, gt=0, le=200, allow_inf_nan=False)] = 2.3
    inductance_h: Annotated[float, Field(strict=True, gt=0, le=0.5, allow_inf_nan=False)] = 4.4e-3
    rotor_inertia_kgm2: Annotated[float, Field(strict=True, gt=0, le=1e-2, allow_inf_nan=False)] = 58e-7
    load_inertia_kgm2: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = 0.0
    load_friction_nm: Annotated[float, Field(strict=True, ge=0, le=50, allow_inf_nan=False)] = 0.0
    friction_nm: Annotated[float, Field(strict=True, ge=0, le=10, allow_inf_nan=False)] = Field(
        default=0.005, description="Coulomb friction of the motor itself: 0 where the load's is that of both"
    )
    viscous_nms: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = Field(
        default=1e-3, description="viscous friction: what damps the resonance"
    )
    detent_torque_nm: Annotated[float, Field(strict=True, ge=-5, le=5, allow_inf_nan=False)] = Field(
        default=0.02, description="its amplitude"
    )
    backlash_deg: Annotated[float, Field(strict=True, ge=0, le=10, allow_inf_nan=False)] = Field(
        default=0.0, description="play between the shaft and its encoder [deg of the shaft]"
    )
    supply_v: Annotated[float, Field(strict=True, gt=0, le=60, allow_inf_nan=False)] = 24.0
    counts_per_turn: Annotated[int, Field(strict=True, ge=16, le=1 << 22)] = Field(
        default=40_000, description="of the encoder, four a line"
    )


AS_IDENTIFIED: Final = "as identified"


class Twin(Part):
    """Try on an emulated twin first: an emulator set as the axis is, with a motor as it is told here."""

    motor: TwinMotor = Field(default_factory=TwinMotor)
    as_identified: Annotated[bool, Field(strict=True)] = Field(
        default=False,
        description="what the latest study of motor and machine of the axis found takes the place of the told figures",
    )
    trials: Annotated[int, Field(strict=True, ge=5, le=500)] = Field(default=40, description="settings tried there")
    best: Annotated[int, Field(strict=True, ge=1, le=20)] = Field(
        default=4, description="so many of the best are tried on the axis first"
    )
    source: Annotated[str, StringConstraints(strict=True, max_length=500)] = Field(
        default="", description="where the motor's figures are from, for people; filled in where they were identified"
    )


TwinWish: TypeAlias = Annotated[
    Twin | Literal["as identified"] | None,
    Field(
        description="tried first. as identified: made of the latest study of motor and machine of the axis, if that "
        "tells enough (the plan says so), else none; null: none, on the axis alone. The record has the one it was"
    ),
]


def told_twin(wish: TwinWish) -> Twin | None:
    """The twin that is tried; None where it was left open, and nobody made one of what was identified."""
    return wish if isinstance(wish, Twin) else None


SeenBy = Literal["encoder", "left switch", "right switch"]
"""What tells of lost steps."""


@runtime_checkable
class MayKeep(Protocol):
    """A study that leaves what it found set, where that is shown to be better, if it is asked to."""

    keep: bool


Shape = Literal["six points", "bows"]
"""A ramp of more than one acceleration or jerk."""


class FastestMove(Part):
    """The fastest ramp for a distance at which no step is lost, with a margin: seen by the encoder, or by a switch."""

    kind: Literal["fastest_move"] = "fastest_move"
    seen_by: SeenBy = Field(
        default="encoder",
        description="what tells of lost steps: an encoder, or an end switch near which the moves begin, whose edge is "
        "looked at after each half of them",
    )
    distance: Int = Field(description="of a move, and back again; its sign says to which side [microsteps]")
    distances: list[Int] = Field(
        default_factory=list,
        max_length=8,
        description="further ones, to the same side: each run moves by all of them and back, and the time of all "
        "together counts [microsteps]; empty: by the one distance alone",
    )
    margin: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = Field(
        default=0.1, description="no step may be lost at so much more speed and acceleration either: 0.1 is 10 %"
    )
    velocity_max_pps: Positive | None = Field(
        default=None, description="never faster, margin included [pps]; null: as the soft limit, else ten times as now"
    )
    acceleration_max_pps2: Positive | None = Field(default=None, description="the same of the acceleration [pps^2]")
    shape: Shape | None = Field(
        default=None,
        description="what is searched beside speed and acceleration. six points: a speed V1 below which it accelerates "
        "and brakes by more, and how much more it brakes than it accelerates; bows: the jerk near rest and that near "
        "the greatest speed apart. null: a trapezoid, or S-ramps of one jerk where they are set",
    )
    repeats: Annotated[int, Field(strict=True, ge=1, le=20)] = Field(
        default=2, description="moves there and back with each setting that is tried"
    )
    pairs: Annotated[int, Field(strict=True, ge=10, le=300)] = Field(
        default=10, description="of the proof: as many moves with the old setting and with the new, in turn"
    )
    loss_rate_max: Annotated[float, Field(strict=True, ge=0.001, le=0.2, allow_inf_nan=False)] | None = Field(
        default=None,
        description="bound of the share of moves that lose a step, 95 %: after the pairs the new setting moves until "
        "so much is shown, 299 times for 0.01; null: what the pairs show",
    )
    band_fullsteps: Annotated[float, Field(strict=True, gt=0, le=20, allow_inf_nan=False)] = Field(
        default=1.0, description="a move is over when the encoder stays within it of the target [full steps]"
    )
    smallest_gain: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = Field(
        default=0.01, description="what is less than this share faster is no improvement"
    )
    quiet: Annotated[bool, Field(strict=True)] = Field(
        default=False,
        description="look for little deviation under way too: a front of both, of which the setting is proposed that "
        "is nearest to the best of both",
    )
    deviation_max_fullsteps: Positive | None = Field(
        default=None,
        description="with quiet: propose the fastest of the front that never deviates by more under way [full steps]; "
        "null: the one nearest to the best of both",
    )
    candidate: dict[str, Positive] | None = Field(
        default=None,
        description="search nothing, and prove this setting alone, by the names and units of an earlier study's trial, "
        "e.g. speed [pps] and acceleration [pps^2]; null: search",
    )
    twin: TwinWish = AS_IDENTIFIED
    sampler: Sampler | None = Field(default=None, description="null: TPE for one objective, NSGA-II for two")

    @model_validator(mode="after")
    def _goes_somewhere(self) -> FastestMove:
        if self.distance == 0:
            raise ValueError("distance is 0: a move goes somewhere")
        for each in self.distances:
            if each == 0 or (each > 0) != (self.distance > 0):
                raise ValueError(f"distances has {each}: all of them go to the same side as distance, {self.distance}")
        if self.quiet and self.sampler == "cmaes":
            raise ValueError("CMA-ES knows one objective: leave quiet out, or take tpe or nsga2")
        if self.deviation_max_fullsteps is not None and not self.quiet:
            raise ValueError("deviation_max_fullsteps chooses among a front: set quiet too, or leave it out")
        if self.candidate is not None and isinstance(self.twin, Twin):
            raise ValueError("a candidate is proved on the axis, and nothing is searched: leave the twin out")
        if self.seen_by != "encoder":
            if (self.distance > 0) != (self.seen_by == "left switch"):
                raise ValueError(f"distance leads into the {self.seen_by}: moves go away from it, and back")
            if self.quiet:
                raise ValueError("quiet is told by an encoder alone: leave it out, or let the encoder see")
            if isinstance(self.twin, Twin):
                raise ValueError("a twin sees lost steps by its encoder: leave it out, or let the encoder see")
        return self

    @property
    def no_twin(self) -> str:
        """Why it is tried on no twin, whatever is known of the axis; empty where one may be."""
        if self.candidate is not None:
            return "a candidate is proved on the axis, and nothing is searched"
        return "" if self.seen_by == "encoder" else "a twin sees lost steps by its encoder"

    @property
    def every_distance(self) -> tuple[int, ...]:
        """Those of one run, in its order [microsteps]."""
        return (self.distance, *self.distances)

    @property
    def farthest(self) -> int:
        """The one that takes most room [microsteps]."""
        return max(self.every_distance, key=abs)


class FirstLook(Part):
    """What an axis is: direction, encoder, switches, travel, and what is missing. Small moves alone."""

    kind: Literal["first_look"] = "first_look"
    turns: Annotated[float, Field(strict=True, gt=0, le=20, allow_inf_nan=False)] = Field(
        default=1.0, description="how far it turns to either side, to look at the encoder [turns of the motor]"
    )
    velocity_rps: Annotated[float, Field(strict=True, gt=0, le=5, allow_inf_nan=False)] = Field(
        default=0.5, description="of these moves [turns of the motor a second]"
    )
    travel_turns: Annotated[float, Field(strict=True, ge=0, le=10_000, allow_inf_nan=False)] = Field(
        default=0.0, description="how far to look for switches to either side [turns of the motor]; 0: not at all"
    )


class MicrostepCalibration(Part):
    """A microstep table that makes up for the motor's angle error, as far as the chip's table can: by the encoder."""

    kind: Literal["microstep_calibration"] = "microstep_calibration"
    turns: Annotated[int, Field(strict=True, ge=1, le=10)] = Field(
        default=1, description="of each run, there or back, to positions above [turns of the motor]"
    )
    velocity_rps: Annotated[float, Field(strict=True, ge=0.002, le=0.25, allow_inf_nan=False)] = Field(
        default=0.05,
        description="so slow that the load follows: four errors a full step have to stay far below its resonance "
        "[turns of the motor a second]",
    )
    pairs: Annotated[int, Field(strict=True, ge=6, le=50)] = Field(
        default=6, description="of the proof: there and back with the old table and with the new one, in turn"
    )
    smallest_gain: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = Field(
        default=0.05, description="what makes the error less than this share smaller is no improvement"
    )
    keep: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="leave the new table set where it is shown to be better"
    )


class Identification(Part):
    """What hangs on an axis: resonance, damping, friction, detent torque, backlash, encoder, and by them the inertia.

    It changes nothing that stays.
    """

    kind: Literal["identification"] = "identification"
    velocity_rps: Annotated[float, Field(strict=True, ge=0.01, le=0.5, allow_inf_nan=False)] = Field(
        default=0.1,
        description="of the slow turns: so fast that the rotor does not stick at each microstep, so slow that four "
        "errors a full step stay far below its resonance [turns of the motor a second]",
    )
    hops: Annotated[int, Field(strict=True, ge=6, le=100)] = Field(
        default=24, description="short, fast moves, after each of which the rotor rings"
    )
    current_share: Annotated[float, Field(strict=True, ge=0.2, le=0.8, allow_inf_nan=False)] = Field(
        default=0.5, description="of the run current, for the turns that tell friction from backlash"
    )
    hold_torque_nm: Annotated[float, Field(strict=True, gt=0, le=50, allow_inf_nan=False)] | None = Field(
        default=None,
        description="holding torque with the current that it runs with, by the motor's data sheet [N m]; null: inertia "
        "and torques are told as shares of it alone",
    )
    torque_tolerance: Annotated[float, Field(strict=True, ge=0, le=0.5, allow_inf_nan=False)] = Field(
        default=0.1, description="by so much may that torque be off: 0.1 is 10 %"
    )
    supply_v: Annotated[float, Field(strict=True, gt=0, le=100, allow_inf_nan=False)] | None = Field(
        default=None, description="of the motor; null: resistance, inductance and back-EMF are not told"
    )
    run_current_a: Annotated[float, Field(strict=True, gt=0, le=50, allow_inf_nan=False)] | None = Field(
        default=None, description="RMS of one coil, as it is set now [A]; null: the same"
    )


class ClosedLoop(Part):
    """Gains of a position loop (PID alone) for asked margins: the motor's resonance is measured, the loop worked out,
    and shown by steps."""

    kind: Literal["closed_loop"] = "closed_loop"
    phase_margin_deg: Annotated[float, Field(strict=True, ge=30, le=80, allow_inf_nan=False)] = Field(
        default=60.0, description="of the worst plant that the measurement leaves open [deg]"
    )
    gain_margin: Annotated[float, Field(strict=True, ge=1.3, le=10, allow_inf_nan=False)] = Field(
        default=2.0, description="so many times more gain would it take to oscillate; 2 is 6 dB"
    )
    step_fullsteps: Annotated[float, Field(strict=True, ge=0.5, le=50, allow_inf_nan=False)] = Field(
        default=2.0, description="of the steps by which it is shown [full steps]"
    )
    tolerance_microsteps: Annotated[int, Field(strict=True, ge=0, le=1000)] = Field(
        default=4, description="a deviation within it is none: a count of the encoder at the least [microsteps]"
    )
    hops: Annotated[int, Field(strict=True, ge=6, le=20)] = Field(
        default=10, description="short, fast moves without regulation, after each of which the rotor rings"
    )
    pairs: Annotated[int, Field(strict=True, ge=6, le=50)] = Field(
        default=6, description="of the proof: steps there and back with the old gains and with the new, in turn"
    )
    smallest_gain: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = Field(
        default=0.05, description="what settles less than this share sooner is no improvement"
    )
    keep: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="leave the new gains set, and the loop on, where they do as was asked"
    )


CurrentShare = Annotated[float, Field(strict=True, ge=0.2, le=2, allow_inf_nan=False)]
Speed = Annotated[float, Field(strict=True, gt=0, le=50, allow_inf_nan=False)]


class StallGuard(Part):
    """The threshold by which StallGuard tells a stall from a free run, at each of some speeds; seen by the encoder.

    It runs into a hard stop, many times: whoever asks for it says that there is one that may be run into.
    """

    kind: Literal["stallguard"] = "stallguard"
    side: Literal["left", "right"] = Field(default="left", description="where the stop is, seen from here")
    within_fullsteps: Annotated[float, Field(strict=True, gt=0, le=1e6, allow_inf_nan=False)] = Field(
        description="how far from here it is at most; it is looked for that far [full steps]"
    )
    stop_confirmed: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="a hard stop is there, and the motor may run into it some dozen times"
    )
    speeds_rps: Annotated[list[Speed], Field(min_length=1, max_length=8)] = Field(
        default=[0.5, 1.0, 2.0], description="at which a stall is to be told [turns of the motor a second]"
    )
    run_fullsteps: Annotated[float, Field(strict=True, ge=20, le=1e5, allow_inf_nan=False)] = Field(
        default=200.0, description="a free run: a false stall is one in so far a way [full steps]"
    )
    push_fullsteps: Annotated[float, Field(strict=True, ge=4, le=40, allow_inf_nan=False)] = Field(
        default=8.0, description="a stall that is not told so far into the stop is missed [full steps]"
    )
    free_runs: Annotated[int, Field(strict=True, ge=20, le=3000)] = Field(
        default=100,
        description="of the proof, at each speed: 299 without a false stall show less than 1 %; from 366 on up to two "
        "false ones are made up for by more runs",
    )
    stops: Annotated[int, Field(strict=True, ge=10, le=1000)] = Field(
        default=20, description="runs into the stop of the proof, at each speed: the same of missed ones"
    )
    rate_max: Annotated[float, Field(strict=True, gt=0, le=0.5, allow_inf_nan=False)] = Field(
        default=0.01,
        description="of false stalls and of missed ones: one in the proof is too many unless its runs bound it below",
    )
    each_speed: Annotated[bool, Field(strict=True)] = Field(
        default=True,
        description="at a speed at which the threshold of the others does not do it, prove one of its own: by as many "
        "runs more",
    )
    generation: Literal[2, 4] | None = Field(
        default=None, description="StallGuard2 (SpreadCycle) or 4 (StealthChop); null: as the chopper is set now"
    )

    @model_validator(mode="after")
    def _rising(self) -> StallGuard:
        if self.speeds_rps != sorted(set(self.speeds_rps)):
            raise ValueError("speeds_rps has to rise")
        return self


class ScoredMove(Part):
    """A move there and back with all settings as they are, and its figures: for tuning by hand. It sets nothing."""

    kind: Literal["scored_move"] = "scored_move"
    distance: Int = Field(description="of the move, and back; its sign says to which side [microsteps]")
    repeats: Annotated[int, Field(strict=True, ge=1, le=20)] = Field(default=2, description="there and back")
    band_fullsteps: Annotated[float, Field(strict=True, gt=0, le=20, allow_inf_nan=False)] = Field(
        default=1.0, description="a move is over when the encoder stays within it of the target [full steps]"
    )

    @model_validator(mode="after")
    def _goes_somewhere(self) -> ScoredMove:
        if self.distance == 0:
            raise ValueError("distance is 0: a move goes somewhere")
        return self


class LeastCurrent(Part):
    """The least run current at which a load cycle (there and back, the ramp as it is) loses no step, with a margin."""

    kind: Literal["least_current"] = "least_current"
    distance: Int = Field(description="of a load cycle, and back; its sign says to which side [microsteps]")
    margin: Annotated[float, Field(strict=True, ge=0, le=0.6, allow_inf_nan=False)] = Field(
        default=0.25, description="no step may be lost at so much less current either: for warmth, supply and load"
    )
    speed_margin: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = Field(
        default=0.25,
        description="no step may be lost at so much more speed either: a lower supply and a warm winding take from the "
        "motor what more speed takes, and no current scale gives it back; 0: not tried",
    )
    repeats: Annotated[int, Field(strict=True, ge=1, le=20)] = Field(
        default=3, description="cycles at each current that is tried"
    )
    loss_rate_max: Annotated[float, Field(strict=True, ge=0.001, le=0.2, allow_inf_nan=False)] = Field(
        default=0.05, description="bound of the share of cycles that lose a step, at the current less the margin"
    )
    smallest_gain: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = Field(
        default=0.1, description="what is less than this share less heat is no improvement"
    )
    resistance_ohm: Annotated[float, Field(strict=True, gt=0, le=200, allow_inf_nan=False)] | None = Field(
        default=None, description="of one coil, at 20 deg C; null: the saving is told as a share"
    )
    run_current_a: Annotated[float, Field(strict=True, gt=0, le=50, allow_inf_nan=False)] | None = Field(
        default=None, description="RMS of one coil, as it is set now [A]; null: the same"
    )

    coolstep: bool = Field(
        default=True, description="then CoolStep as well, where the chip has it: less current where the load is small"
    )
    twin: TwinWish = Field(
        default=AS_IDENTIFIED,
        description="every current is tried there first, whatever `trials` says. as identified: made of the latest "
        "study of motor and machine of the axis, if that tells enough (the plan says so), else none; null: none, on "
        "the axis alone. The record has the one it was",
    )

    @model_validator(mode="after")
    def _goes_somewhere(self) -> LeastCurrent:
        if self.distance == 0:
            raise ValueError("distance is 0: a load cycle goes somewhere")
        return self


CoilResistance = Annotated[
    float, Field(strict=True, gt=0, le=200, allow_inf_nan=False, description="of one coil, by the motor's data sheet")
]
CoilInductance = Annotated[
    float, Field(strict=True, gt=0, le=0.5, allow_inf_nan=False, description="of one coil, by the motor's data sheet")
]
RunCurrent = Annotated[
    float, Field(strict=True, gt=0, le=50, allow_inf_nan=False, description="RMS of one coil, as it is set now [A]")
]
Supply = Annotated[float, Field(strict=True, gt=0, le=100, allow_inf_nan=False, description="of the motor")]


class CalmChopper(Part):
    """The setting of SpreadCycle (TOFF, TBL, hysteresis) by which the shaft shakes least: seen by the encoder."""

    kind: Literal["chopper"] = "chopper"
    resistance_ohm: CoilResistance
    inductance_h: CoilInductance
    run_current_a: RunCurrent
    supply_v: Supply
    speeds_rps: Annotated[list[Speed], Field(min_length=1, max_length=6)] = Field(
        default=[0.25, 0.5, 1.0], description="at which the motor is to be calm [turns of the motor a second]"
    )
    lowest_hz: Annotated[float, Field(strict=True, ge=5e3, le=50e3, allow_inf_nan=False)] = Field(
        default=20e3, description="no setting is tried whose chopper would be slower, by an estimate: it is heard [Hz]"
    )
    pairs: Annotated[int, Field(strict=True, ge=10, le=100)] = Field(
        default=10, description="of the proof: runs with the old setting and with the new, in turn"
    )
    smallest_gain: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = Field(
        default=0.02, description="what shakes less than this share less is no improvement"
    )
    keep: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="leave the new setting where it is shown to be calmer"
    )

    @model_validator(mode="after")
    def _rising(self) -> CalmChopper:
        if self.speeds_rps != sorted(set(self.speeds_rps)):
            raise ValueError("speeds_rps has to rise")
        return self


class QuietStealthChop(Part):
    """StealthChop: amplitudes (PWM_OFS, PWM_GRAD) that need no regulation, and up to which speed it may work before
    SpreadCycle takes over with a jolt (TPWMTHRS)."""

    kind: Literal["stealthchop"] = "stealthchop"
    resistance_ohm: CoilResistance
    inductance_h: CoilInductance
    run_current_a: RunCurrent
    supply_v: Supply
    holding_torque_nm: Annotated[float, Field(strict=True, gt=0, le=50, allow_inf_nan=False)] | None = Field(
        default=None, description="both coils at the rated current; null: PWM_GRAD is only tuned by the chip"
    )
    rated_current_a: Annotated[float, Field(strict=True, gt=0, le=50, allow_inf_nan=False)] | None = Field(
        default=None, description="RMS of one coil at that torque; null: the run current"
    )
    velocity_max_rps: Annotated[float, Field(strict=True, ge=0.3, le=20, allow_inf_nan=False)] = Field(
        default=3.0, description="runs go through all speeds up to this one [turns of the motor a second]"
    )
    jolt_max_fullsteps: Annotated[float, Field(strict=True, ge=0.02, le=2, allow_inf_nan=False)] = Field(
        default=0.5, description="so far the shaft may swing as one chopper takes over from the other"
    )
    pairs: Annotated[int, Field(strict=True, ge=10, le=100)] = Field(
        default=10, description="of the proof: runs with the old setting and with the new, in turn"
    )
    smallest_gain: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = Field(
        default=0.05, description="what jolts less than this share less is no improvement"
    )
    keep: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="leave the new setting where it is shown to be better"
    )


class TorqueCurve(Part):
    """How much torque the motor has at each speed beyond friction: it is accelerated until steps are lost."""

    kind: Literal["torque_curve"] = "torque_curve"
    seen_by: SeenBy = Field(
        default="encoder",
        description="what tells of lost steps: an encoder, which shows the slip itself, or an end switch near which "
        "runs begin, whose edge is looked at after each",
    )
    velocity_max_rps: Annotated[float, Field(strict=True, gt=0, le=100, allow_inf_nan=False)] = Field(
        default=20.0, description="never faster [turns of the motor a second]"
    )
    travel_turns: Annotated[float, Field(strict=True, ge=10, le=10_000, allow_inf_nan=False)] = Field(
        default=60.0,
        description="room from where it stands, to positions above, or away from the switch [turns of the motor]; a "
        "load out of step may run on",
    )
    speeds: Annotated[int, Field(strict=True, ge=2, le=30)] = Field(
        default=8, description="how many between the first and the greatest at which there is torque left"
    )
    repeats: Annotated[int, Field(strict=True, ge=2, le=20)] = Field(default=4, description="slips at each speed")
    inertia_kgm2: Annotated[float, Field(strict=True, gt=0, le=1, allow_inf_nan=False)] | None = Field(
        default=None,
        description="of rotor and load: torque is it times what is measured; null: accelerations alone are told",
    )
    inertia_share: Annotated[float, Field(strict=True, ge=0, le=0.5, allow_inf_nan=False)] = Field(
        default=0.05, description="how well the inertia is known: 0.05 is +-5 %, of its 95 % interval"
    )
    friction_nm: Annotated[float, Field(strict=True, ge=0, le=50, allow_inf_nan=False)] = Field(
        default=0.0, description="of the axis where it is known; it is added to the torque"
    )


class ResonanceMap(Part):
    """Ripple over speed and order of the electrical frequency, by the encoder, and which setting moves it where.

    Nothing of it stays set.
    """

    kind: Literal["resonance_map"] = "resonance_map"
    velocity_min_rps: Annotated[float, Field(strict=True, ge=0.05, le=20, allow_inf_nan=False)] = Field(
        default=0.2, description="the slowest [turns of the motor a second]"
    )
    velocity_max_rps: Annotated[float, Field(strict=True, gt=0.05, le=50, allow_inf_nan=False)] = Field(
        default=4.0, description="the fastest, as far as the travel lets it get there with the acceleration that is set"
    )
    speeds: Annotated[int, Field(strict=True, ge=8, le=60)] = Field(
        default=20, description="by equal ratios; more are made around what resonates"
    )
    travel_turns: Annotated[float, Field(strict=True, ge=1, le=10_000, allow_inf_nan=False)] = Field(
        default=12.0, description="room from where it stands, to positions above [turns of the motor]"
    )
    repeats: Annotated[int, Field(strict=True, ge=1, le=10)] = Field(
        default=2, description="ways there and back at each speed; of a change so many with it and without, in turn"
    )
    current_shares: Annotated[list[CurrentShare], Field(max_length=4)] = Field(
        default=[0.7], description="of the run current: changes to be compared with how it is set"
    )
    other_chopper: Annotated[bool, Field(strict=True)] = Field(
        default=True, description="compare StealthChop, or SpreadCycle where that is what is off, too"
    )
    smallest_gain: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = Field(
        default=0.05, description="what makes the ripple less than this share smaller is no improvement"
    )

    @model_validator(mode="after")
    def _has_a_range(self) -> ResonanceMap:
        if self.velocity_max_rps < 2 * self.velocity_min_rps:
            raise ValueError("velocity_max_rps has to be twice velocity_min_rps at the least")
        if 1 in self.current_shares:
            raise ValueError("current_shares has 1: that is the current as it is set, and no change")
        return self


SearchedNumber = Annotated[float, Field(strict=True, ge=-1e12, le=1e12, allow_inf_nan=False)]
ScoredFigure = Literal[
    "time_s", "overshoot_fullsteps", "peak_fullsteps", "vibration_fullsteps", "rest_fullsteps", "load_min"
]
"""What is told of a scored move: of the last more is better, of all others less."""


class SearchedSetting(Part):
    """One dimension of a space: a register field, a parameter or a figure of the ramp, and from where to where."""

    name: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=100, strip_whitespace=True)] = Field(
        description="as the catalog has it: a register, register.field, or a parameter of a module; or ramp.speed, "
        "ramp.acceleration, ramp.jerk, with all registers that belong to them"
    )
    low: SearchedNumber = Field(description="in the physical unit where it has one (pps, pps^2, s ...), else raw")
    high: SearchedNumber
    log: Annotated[bool, Field(strict=True)] = Field(default=False, description="looked at by equal ratios")

    @model_validator(mode="after")
    def _is_a_range(self) -> SearchedSetting:
        if self.low >= self.high:
            raise ValueError(f"{self.name}: low has to be below high")
        if self.log and self.low <= 0:
            raise ValueError(f"{self.name}: equal ratios begin above 0: raise low, or leave log out")
        return self


class FigureBound(Part):
    """Between what a figure has to stay for a setting to count."""

    figure: ScoredFigure
    least: SearchedNumber | None = None
    most: SearchedNumber | None = None

    @model_validator(mode="after")
    def _bounds_something(self) -> FigureBound:
        if self.least is None and self.most is None:
            raise ValueError(f"the bound of {self.figure} has neither least nor most")
        return self


Distance = Annotated[int, Field(strict=True, ge=-(2**31), lt=2**31)]


class CustomSearch(Part):
    """An own space of settings, searched for the best figures of moves there and back; seen by the encoder."""

    kind: Literal["custom_search"] = "custom_search"
    space: Annotated[list[SearchedSetting], Field(min_length=1, max_length=8)]
    distances: Annotated[list[Distance], Field(min_length=1, max_length=4)] = Field(
        description="of the moves, each and back again; the sign says to which side [microsteps]"
    )
    objectives: Annotated[list[ScoredFigure], Field(min_length=1, max_length=2)] = Field(
        description="what is to be better: less, of load_min more. Of two a front is told; the proof asks for one "
        "that is better, and none that may be worse"
    )
    bounds: Annotated[list[FigureBound], Field(max_length=12)] = Field(
        default_factory=list, description="what has to hold beside that no step is lost"
    )
    repeats: Annotated[int, Field(strict=True, ge=1, le=20)] = Field(
        default=2, description="of all moves with each setting, from other places of the electrical period"
    )
    band_fullsteps: Annotated[float, Field(strict=True, gt=0, le=20, allow_inf_nan=False)] = Field(
        default=1.0, description="a move is over when the encoder stays within it of the target [full steps]"
    )
    pairs: Annotated[int, Field(strict=True, ge=10, le=100)] = Field(
        default=10, description="of the proof: all moves with the old setting and with the new, in turn"
    )
    smallest_gain: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] = Field(
        default=0.02, description="what is less than this share better is no improvement"
    )
    more_current: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="settings may take more current than now, within the soft limit"
    )
    sampler: Sampler | None = Field(default=None, description="null: TPE for one objective, NSGA-II for two")

    @model_validator(mode="after")
    def _can_be_searched(self) -> CustomSearch:
        if 0 in self.distances:
            raise ValueError("distances has 0: a move goes somewhere")
        both: dict[str, list[str]] = {
            "space": [each.name.casefold() for each in self.space],
            "objectives": [*self.objectives],
        }
        for what, names in both.items():
            twice = next((name for name in names if names.count(name) > 1), None)
            if twice is not None:
                raise ValueError(f"{what} has {twice} twice")
        if len(self.objectives) > 1 and self.sampler == "cmaes":
            raise ValueError("CMA-ES knows one objective: take tpe or nsga2 for two")
        return self


What: TypeAlias = Annotated[
    CalmChopper
    | ClosedLoop
    | CustomSearch
    | FastestMove
    | FirstLook
    | Identification
    | LeastCurrent
    | MicrostepCalibration
    | QuietStealthChop
    | ResonanceMap
    | ScoredMove
    | StallGuard
    | TorqueCurve,
    Field(discriminator="kind"),
]
Kind = Literal[
    "chopper",
    "closed_loop",
    "custom_search",
    "fastest_move",
    "first_look",
    "identification",
    "least_current",
    "microstep_calibration",
    "resonance_map",
    "scored_move",
    "stallguard",
    "stealthchop",
    "torque_curve",
]
TITLES: dict[Kind, str] = {
    "chopper": "Chopper",
    "closed_loop": "Closed loop",
    "custom_search": "Own search",
    "fastest_move": "Fastest move",
    "first_look": "First look",
    "identification": "Motor and machine",
    "least_current": "Least current",
    "microstep_calibration": "Microstep calibration",
    "resonance_map": "Resonance map",
    "scored_move": "Scored move",
    "stallguard": "StallGuard threshold",
    "stealthchop": "StealthChop",
    "torque_curve": "Torque over speed",
}
Wanted = TypeVar("Wanted", bound=Part)


class StudyDocument(Part):
    """One study of one axis. Raises ValidationError for what is none."""

    format: Literal["stepscope-study"] = FORMAT
    version: Literal[1] = VERSION
    name: Annotated[str, StringConstraints(strict=True, max_length=100, strip_whitespace=True)] = ""
    device: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=200)] = Field(
        description="the device's id: a slug of its name"
    )
    axis: Annotated[int, Field(strict=True, ge=0, le=31)] = 0
    study: What
    budget: Budget = Field(default_factory=Budget)
    seed: Annotated[int, Field(strict=True, ge=0, le=2**31 - 1)] = Field(
        default=1, description="of everything drawn: the same seed asks for the same settings first"
    )

    @model_validator(mode="before")
    @classmethod
    def _of_this_format(cls, data: Any) -> Any:
        if isinstance(data, dict):
            if data.get("format", FORMAT) != FORMAT:
                raise ValueError("this is no study of stepscope")
            version = data.get("version", VERSION)
            if isinstance(version, int) and version > VERSION:
                raise ValueError(f"it is of a newer stepscope: version {version}, known is {VERSION}")
        return data

    @property
    def title(self) -> str:
        """Its name, or what it is."""
        return self.name or TITLES[self.study.kind]

    def wanted(self, kind: type[Wanted]) -> Wanted:
        """What is looked for, of the kind that it is known to be."""
        assert isinstance(self.study, kind)
        return self.study
