"""Shapes of the calculators."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag

from ...registers.names import ModelName
from ..schemas import Answer, Body, ChipName, Flag, Number
from ..tables.mslut_schemas import MslutDesign
from ..tables.schemas import DriverChain, TableValue
from .sixpoint_schemas import RegisterNumbers, SixPointUnits
from .sramp_schemas import RampFinding, RampLimit, RampMotor, RampRegister, RampRival, RampTorque

Divider = Annotated[int, Field(strict=True, ge=0, le=13)]
ChipValue = Annotated[int, Field(strict=True, ge=0, le=2047)]
ClockHz = Annotated[float, Field(strict=True, ge=1, le=32e6, allow_inf_nan=False)]


class PmulPdiv(Body):
    chip: ChipName = "tmc428"
    a_max: ChipValue
    ramp_div: Divider
    pulse_div: Divider
    reduction: Annotated[float, Field(strict=True, ge=0, lt=1, allow_inf_nan=False)] | None = Field(
        default=None, description="by how much p is made smaller; null: the data sheet's 0.05 (TMC428), 0.01 (TMC4210)"
    )
    v_max: ChipValue = 2047
    v_min: ChipValue = 1
    clock_hz: ClockHz = 16e6


class PmulPdivCandidate(Answer):
    pmul: int
    p_mul: int
    pdiv: int
    p: float
    quality: float
    overshoot_steps: int | None = Field(description="farthest beyond the target, in the exact ramp [microsteps]")
    settling_s: float | None = Field(
        description="from the first arrival at the target to rest [s]; null where the oscillation is unbounded"
    )
    move_s: float | None = Field(default=None, description="the whole reference move [s], to compare pairs by")


class PmulPdivResult(Answer):
    p_ideal: float
    p_reduced: float
    pmul: int | None = Field(description="counted 0..127 as in the TMC428 data sheet")
    p_mul: int | None = Field(description="counted 128..255 as in the TMC4210 data sheet")
    pdiv: int | None
    p: float | None
    quality: float | None
    candidates: list[PmulPdivCandidate]
    a_max_lower_limit: int
    a_max_upper_limit: int
    warnings: list[str]


class Mechanics(Body):
    model_config = ConfigDict(extra="forbid", from_attributes=True)

    full_steps_per_rev: Annotated[int, Field(strict=True, ge=1, le=100_000)] = 200
    microsteps_per_full_step: Annotated[int, Field(strict=True, ge=1, le=1024)] = 64
    gear_ratio: Annotated[float, Field(strict=True, gt=0, le=1e6, allow_inf_nan=False)] = 1.0
    travel_mm_per_rev: Annotated[float, Field(strict=True, gt=0, le=1e6, allow_inf_nan=False)] | None = None


class Quantity(Body):
    """A number with its unit, as it comes from a person."""

    value: Number
    unit: str


class RampInverse(Body):
    """From wanted speed and acceleration to register values."""

    model: ChipName = "tmc428"
    velocity: Quantity
    acceleration: Quantity
    mechanics: Mechanics = Mechanics()
    clock_hz: ClockHz = 16e6
    reduction: Annotated[float, Field(strict=True, ge=0, lt=1, allow_inf_nan=False)] | None = None


class RampInverseResult(Answer):
    pulse_div: int
    ramp_div: int
    v_max: int
    a_max: int
    usrs: int | None
    pmul: int | None
    p_mul: int | None
    pdiv: int | None
    achieved_velocity_pps: float
    achieved_acceleration_pps2: float
    velocity_error: float = Field(description="achieved / wanted - 1")
    acceleration_error: float = Field(description="achieved / wanted - 1")
    mechanics: Mechanics = Field(description="as given, with the microsteps of usrs")
    warnings: list[str]


class Units(Body):
    """Chip units and physical units of one axis, either way: give what you know.

    The chips' units hang on `pulse_div` and `ramp_div`, which they need. A PD42-1241 has none: its unit "chip" is that
    of the TMC5160 inside, in which it counts where axis parameter 255 is 0; otherwise it counts in pps and pps2.
    A TMC4361 counts in pps, pps2 and pps3 with a fixed point: its "chip" is the register's whole number.
    The TMC5xxx count by their clock: "chip" is the whole number in VMAX or AMAX. Of these `delay_s` and `tstep` are
    answered too, and `registers`, which go the other way: whole numbers in registers, by name.
    """

    model: ModelName = "tmc428"
    pulse_div: Divider | None = Field(default=None, description="TMC428, TMC4210: needed there")
    ramp_div: Divider | None = Field(default=None, description="TMC428, TMC4210: needed there")
    clock_hz: ClockHz = 16e6
    mechanics: Mechanics = Mechanics()
    velocity: Quantity | None = Field(
        default=None, description="unit: chip, pps, fullsteps_per_s, rps, rpm, rad_per_s, mm_per_s"
    )
    acceleration: Quantity | None = Field(
        default=None, description="unit: chip, pps2, fullsteps_per_s2, rps2, rpm_per_s, rad_per_s2, mm_per_s2"
    )
    position: Quantity | None = Field(default=None, description="unit: microsteps, fullsteps, rev, deg, rad, mm")
    bow: Quantity | None = Field(
        default=None, description="TMC4361; unit: chip, pps3, fullsteps_per_s3, rps3, rpm_per_s2, rad_per_s3, mm_per_s3"
    )
    direct_acceleration: Flag = Field(default=False, description="TMC4361: GENERAL_CONF.direct_acc_val_en")
    direct_bow: Flag = Field(default=False, description="TMC4361: GENERAL_CONF.direct_bow_val_en")
    delay_s: Annotated[float, Field(strict=True, ge=0, le=1e6, allow_inf_nan=False)] | None = Field(
        default=None, description="TMC5xxx: a time, for TZEROWAIT, TPOWERDOWN and each step of IHOLDDELAY"
    )
    registers: RegisterNumbers | None = Field(
        default=None, description="TMC5xxx: numbers in registers of ramp, thresholds and delays"
    )
    small_hysteresis: Flag = Field(default=False, description="TMC5130, TMC5160: GCONF.small_hysteresis")


class RampUnits(Answer):
    """What the registers of a TMC4361 get: whole numbers, and what they really are."""

    velocity: int | None = Field(description="VMAX (VSTART, VSTOP, VBREAK); null where the register cannot hold it")
    velocity_pps: float | None = Field(description="that, back in pps")
    acceleration: int | None = Field(description="AMAX, DMAX, ASTART, DFINAL, DSTOP")
    acceleration_pps2: float | None = Field(description="that, back in pps^2")
    bow: int | None = Field(description="BOW1 to BOW4")
    bow_pps3: float | None = Field(description="that, back in pps^3")
    limits: list[str] = Field(description="which limit each number that is null, or better kept away from, is beyond")


class ModuleUnits(Answer):
    """What the TMC5160 of a module gets: whole numbers, and what they really are."""

    velocity: int | None = Field(description="VMAX, V1, VSTART, VSTOP")
    velocity_pps: float | None = Field(description="that, back in pps")
    acceleration: int | None = Field(description="AMAX, A1, DMAX, D1")
    acceleration_pps2: float | None = Field(description="that, back in pps^2")
    tstep: int | None = Field(
        description="clocks between two of 256 microsteps a full step: what thresholds of velocity compare with"
    )


class UnitsResult(Answer):
    """Every unit of each quantity that was given; mm only where the axis knows it."""

    velocity: dict[str, float | None] | None
    acceleration: dict[str, float | None] | None
    position: dict[str, float | None] | None
    acceleration_steps: float | None = Field(description="microsteps from rest to that velocity at that acceleration")
    acceleration_time_s: float | None
    module: ModuleUnits | None = Field(default=None, description="null for chips")
    bow: dict[str, float | None] | None = None
    ramp: RampUnits | None = Field(default=None, description="TMC4361 alone")
    sixpoint: SixPointUnits | None = Field(default=None, description="TMC5xxx alone")


class Ramp(Body):
    """`parameters` bear the chip's register names; for "trapezoid" vmax, amax, dmax in pps and pps^2.

    `ramp_mode` "velocity" turns at `v_target`, "hold" at `v_actual`; without them at v_max, the way of `distance`.

    "sixpoint" is the ramp of a PD42-1241 (TMC5160): amax, vmax, dmax, and vstart, a1, v1, d1, vstop, all in pps and
    pps^2; v1 = 0 makes a trapezoid. `v_actual` is the velocity at the beginning (a move that is changed under way),
    `t_zero_wait_s` the pause before a reversal [s]. `ramp_mode` "velocity" goes to `v_target` by amax alone. What the
    registers of a chip get at `clock_hz` (16 MHz) is answered too; with `rounding` "registers" the curve is of that.

    "s_ramp" is the ramp of a TMC4361: vmax, amax, dmax, bow1 to bow4, vstart, vstop, astart, dfinal, in pps, pps^2 and
    pps^3; dmax is amax and bow2 to bow4 are bow1 where they are left out. `ramp_mode` is "position", "velocity" (to
    `v_target`) or "hold" (no ramp at all). `v_actual` and `a_actual` are the state at the beginning. `shape`
    "trapezoid" has no bows but `vbreak`, below which astart and dfinal hold. With `rounding` "registers" the curve is
    that of what the registers hold, at `clock_hz` and with `direct_acc_val_en`, `direct_bow_val_en` (0 or 1).
    `use_astart_and_vstart` (0 or 1) lets a start with VSTART begin with ASTART.
    """

    model: Literal["tmc428", "tmc429", "tmc4210", "trapezoid", "sixpoint", "s_ramp"]
    parameters: dict[str, Number | str]
    distance: Number
    samples: Annotated[int, Field(strict=True, ge=2, le=100_000)] = 500
    motor: RampMotor | None = Field(default=None, description="s_ramp, sixpoint and trapezoid: a motor to compare with")


class Phase(Answer):
    name: str
    start_s: float
    end_s: float


class RampResult(Answer):
    duration_s: float
    phases: list[Phase]
    time_s: list[float]
    position: list[float]
    velocity_pps: list[float]
    acceleration_pps2: list[float]
    overshoot_steps: int
    warnings: list[str]
    jerk_pps3: list[float] = Field(default=[], description="s_ramp alone")
    limits: list[RampLimit] = Field(default=[], description="s_ramp: how much of VMAX, AMAX and DMAX it uses")
    findings: list[RampFinding] = Field(default=[], description="s_ramp, sixpoint: `warnings` with their parameters")
    registers: list[RampRegister] = Field(default=[], description="s_ramp, sixpoint: what goes into the chip")
    rivals: list[RampRival] = Field(default=[], description="s_ramp: other ways to make the same move, from rest")
    torque: RampTorque | None = Field(default=None, description="s_ramp, sixpoint and trapezoid with a `motor`")


class MicrostepDesign(Body):
    chip: Literal["tmc428"] = "tmc428"
    sigma: Annotated[float, Field(strict=True, ge=-1, le=1, allow_inf_nan=False)] = 0.0
    offset: Annotated[float, Field(strict=True, ge=0, le=63, allow_inf_nan=False)] = 0.0
    amplitude: Annotated[float, Field(strict=True, ge=0, le=63, allow_inf_nan=False)] | None = None
    full_scale: Flag = Field(default=False, description="stretch a box (sigma > 0) until it reaches the amplitude")
    method: Literal["half_rounded_64", "63", "offset"] = Field(
        default="half_rounded_64", description="the three formulas of chapter 12 of the TMC428 data sheet, in its order"
    )
    values: Annotated[list[TableValue], Field(min_length=64, max_length=64)] | None = Field(
        default=None, description="a table drawn by hand: only its datagrams and metrics are wanted"
    )
    usrs: Annotated[int, Field(strict=True, ge=0, le=6)] = 6


def _chip_of(body: object) -> str:
    chip = body.get("chip", "tmc428") if isinstance(body, dict) else getattr(body, "chip", "")
    return "quarter" if chip == "tmc428" else "mslut"


AnyMicrostepDesign = Annotated[
    Annotated[MicrostepDesign, Tag("quarter")] | Annotated[MslutDesign, Tag("mslut")], Discriminator(_chip_of)
]
"""64 values of 6 bits for a TMC428; 256 one-bit differences for a TMC4361."""


class MicrostepMetrics(Answer):
    vector_length_mean: float
    vector_length_ripple: float | None = Field(description="(max - min) / mean; null for a table without current")
    angle_error_deg: list[float | None] = Field(
        description="electrical, at each microstep of the full period; null where there is no current and so no angle"
    )
    angle_error_max_deg: float | None
    angle_error_rms_deg: float | None
    harmonics: list[float] = Field(description="amplitude of harmonic 1, 2, ... relative to the first; empty without")
    thd: float | None
    worst_step: int | None
    worst_step_ratio: float | None = Field(description="longest angle step over the ideal one")
    smallest_step_ratio: float | None


class SequencerRow(Answer):
    index: int
    current_a: int
    current_b: int
    ph_a: int
    ph_b: int
    fd_a: int
    fd_b: int


class MicrostepResult(Answer):
    chip: Literal["tmc428"] = "tmc428"
    values: list[int]
    datagrams: list[str]
    metrics: MicrostepMetrics
    sequence: list[SequencerRow] = Field(description="the full period as the chip steps through it at usrs")
    warnings: list[str]


class ChainRequest(DriverChain):
    clock_hz: ClockHz = 16e6
    clk2_div: Annotated[int, Field(strict=True, ge=0, le=255)] = 7
    ramp_divs: Annotated[list[Divider], Field(min_length=3, max_length=3)] | None = None
