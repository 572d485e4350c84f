"""Shapes of what TMC5xxx alone are answered with: registers in their units, and the settings of current and chopper."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ...registers.names import ChopperName
from ..schemas import Answer, Body, Flag

Amperes = Annotated[float, Field(strict=True, ge=1e-3, le=100, allow_inf_nan=False)]
Ohms = Annotated[float, Field(strict=True, ge=1e-3, le=1e6, allow_inf_nan=False)]
Volts = Annotated[float, Field(strict=True, ge=1, le=1000, allow_inf_nan=False)]
Henries = Annotated[float, Field(strict=True, ge=1e-6, le=10, allow_inf_nan=False)]
Seconds = Annotated[float, Field(strict=True, ge=0, le=1e6, allow_inf_nan=False)]
ClockHz = Annotated[float, Field(strict=True, ge=4e6, le=18e6, allow_inf_nan=False)]
Scale = Annotated[int, Field(strict=True, ge=0, le=31)]
RegisterNumber = Annotated[int, Field(strict=True, ge=0, lt=1 << 32)]
RegisterNumbers = Annotated[dict[str, RegisterNumber], Field(max_length=32)]


class HeldRegister(Answer):
    """What a wanted number becomes in a register, or what a register's number stands for."""

    name: str = Field(description="the register")
    raw: int | None = Field(description="the whole number in the register; null where it cannot hold as much")
    value: float | None = Field(description="what that stands for [unit]; of a threshold as the motor slows down")
    rising: float | None = Field(
        default=None, description="of TPWMTHRS, TCOOLTHRS, THIGH: where it switches as the motor speeds up [unit]"
    )
    unit: Literal["pps", "pps^2", "s"]
    error: float | None = Field(default=None, description="value / wanted - 1")
    least: float = Field(description="the step from one value to the next, and the smallest above 0 [unit]")
    highest: float = Field(description="the greatest that the register can stand for [unit]")
    note: str = Field(default="", description="why `raw` is null, or what else to know")


class SixPointUnits(Answer):
    """What the model's registers make of velocity, acceleration and delay, and what `registers` stand for."""

    registers: list[HeldRegister] = Field(description="those that could hold one of them, in the order of addresses")
    tstep: int | None = Field(description="clocks between two of 256 microsteps a full step at the velocity")
    given: list[HeldRegister] = Field(description="of the request's `registers`, in their order")


# --- current ------------------------------------------------------------------------------------


class CoilCurrent(Body):
    """Currents from settings, settings from wanted currents: what is left out is chosen.

    With `run_a` (and `hold_a`) the nearest settings are searched; with `irun` (and `ihold`) they are as said. One of
    the two for the run current, at most one for the hold current.
    """

    model: ChopperName
    clock_hz: ClockHz = 16e6
    sense_resistor_ohm: Ohms | None = Field(
        default=None, description="external; TMC5130: null measures inside of the chip (internal_Rsense)"
    )
    reference_resistor_ohm: Ohms | None = Field(
        default=None,
        description="TMC5130 without sense resistors: between 5VOUT and AIN_IREF; TMC5240: between IREF and ground",
    )
    current_range: Annotated[int, Field(strict=True, ge=0, le=3)] | None = Field(
        default=None, description="TMC5240; null: the lowest that gets to a wanted current, without one the widest"
    )
    ain_v: Annotated[float, Field(strict=True, ge=0, le=5, allow_inf_nan=False)] | None = Field(
        default=None, description="TMC5130 with sense resistors: voltage at AIN_IREF, with I_scale_analog [V]"
    )
    vsense: Annotated[int, Field(strict=True, ge=0, le=1)] | None = Field(
        default=None, description="all but TMC5160 and TMC5240; null: chosen, without a wanted current 0"
    )
    global_scaler: Annotated[int, Field(strict=True, ge=0, le=255)] | None = Field(
        default=None, description="TMC5160, TMC5240: 0 (256) or 32..255; null: chosen, without a wanted current 0"
    )
    run_a: Amperes | None = Field(default=None, description="wanted current in motion, as `measure` says [A]")
    hold_a: Annotated[float, Field(strict=True, ge=0, le=100, allow_inf_nan=False)] | None = Field(
        default=None, description="wanted current at rest, as `measure` says [A]"
    )
    measure: Literal["rms", "peak"] = Field(default="rms", description="what `run_a` and `hold_a` are, of a sine wave")
    irun: Scale | None = None
    ihold: Scale | None = None
    ihold_delay: Annotated[int, Field(strict=True, ge=0, le=15)] | None = None
    tpowerdown: Annotated[int, Field(strict=True, ge=0, le=255)] | None = Field(
        default=None, description="TMC5130, TMC5160, TMC5240"
    )
    lowering_s: Seconds | None = Field(default=None, description="wanted time from IRUN down to IHOLD, for IHOLDDELAY")
    waiting_s: Seconds | None = Field(default=None, description="wanted time at rest before that, for TPOWERDOWN")


class CurrentSetting(Answer):
    """One way to set a current."""

    scale: int = Field(description="IRUN or IHOLD: CS")
    vsense: int | None = Field(description="null for a TMC5160 or TMC5240")
    global_scaler: int | None = Field(description="as in the register, 0 for 256; null for the others")
    rms_a: float
    peak_a: float
    error: float | None = Field(description="of the wanted current, value / wanted - 1; null without one")


class HoldDelay(Answer):
    """How the current goes down after a motion."""

    ihold_delay: int
    step_s: float = Field(description="for each of the steps")
    steps: int = Field(description="from IRUN to IHOLD")
    lowering_s: float = Field(description="all of them")
    tpowerdown: int | None = Field(description="null for the chips with two axes, which have none")
    waiting_s: float | None = Field(description="from standstill seen to the first step")
    standstill_s: float = Field(
        description="from the last step to standstill seen, 2^20 clocks; 0 with two axes: TZEROWAIT"
    )


class FieldSetting(Answer):
    """A register or a field of one, as it is to be written."""

    name: str = Field(description="the register")
    field: str | None = Field(description="null for the whole register")
    value: int


class CoilCurrentResult(Answer):
    current_range: int | None = Field(default=None, description="of `run`, of a chip that has ranges")
    full_scale_rms_a: float = Field(description="at CS = 31, with the vsense and global scaler of `run`")
    full_scale_peak_a: float
    least_a: float = Field(description="the least step of `run_a` there, as `measure` says: 1/32 of full scale [A]")
    run: CurrentSetting
    hold: CurrentSetting | None
    nearest: list[CurrentSetting] = Field(description="ways to set a wanted run current, best first; else empty")
    sense_voltage_v: float | None = Field(description="peak at the sense resistor; null without one")
    sense_power_w: float | None = Field(description="of one sense resistor, at most, at rest with the run current")
    delay: HoldDelay
    settings: list[FieldSetting] = Field(description="what to write")
    formula: str
    source: str
    warnings: list[str]


# --- chopper ------------------------------------------------------------------------------------


class Chopper(Body):
    """A motor, its supply and its current, for which settings to begin with are to be found."""

    model: ChopperName
    clock_hz: ClockHz = 16e6
    resistance_ohm: Ohms = Field(description="of a coil")
    inductance_h: Henries = Field(description="of a coil")
    current_a: Amperes = Field(description="of the run current, as RMS [A]")
    supply_v: Volts = Field(description="of the motor")
    holding_torque_nm: Annotated[float, Field(strict=True, ge=1e-4, le=1000, allow_inf_nan=False)] | None = Field(
        default=None, description="both phases at the rated current; null leaves out what needs the back-EMF"
    )
    rated_current_a: Amperes | None = Field(default=None, description="null: as `current_a`")
    full_steps_per_rev: Annotated[int, Field(strict=True, ge=1, le=100_000)] = 200
    microsteps_per_full_step: Literal[1, 2, 4, 8, 16, 32, 64, 128, 256] = Field(
        default=256, description="in which velocities are answered"
    )
    irun: Scale = Field(default=31, description="with it the run current is reached")
    chopper_hz: Annotated[float, Field(strict=True, ge=5e3, le=200e3, allow_inf_nan=False)] = Field(
        default=25e3, description="wanted chopper frequency of SpreadCycle"
    )
    tbl: Annotated[int, Field(strict=True, ge=0, le=3)] | None = Field(default=None, description="null: chosen")
    toff: Annotated[int, Field(strict=True, ge=1, le=15)] | None = Field(default=None, description="null: chosen")
    hysteresis: Annotated[int, Field(strict=True, ge=-2, le=16)] | None = Field(
        default=None, description="effective, at its start; null: chosen"
    )
    pwm_freq: Annotated[int, Field(strict=True, ge=0, le=3)] | None = Field(default=None, description="null: chosen")
    automatic: Flag = Field(default=True, description="StealthChop regulates the current (pwm_autoscale)")


class ChopperSetting(Answer):
    """A setting to begin with, and why."""

    name: str = Field(description="the register")
    field: str
    value: int
    exact: float | None = Field(description="before rounding and limits; null where there is no such number")
    meaning: str = Field(description="what the value stands for")
    reason: str
    source: str
    chosen: bool = Field(description="false: as asked for")


class ChopperFigure(Answer):
    """A number that follows, and why."""

    name: str = Field(description="stable, for programs: chopper_frequency, lowest_current, current_limit, ...")
    label: str
    value: float
    unit: str = Field(description='"A", "Hz", "pps", "rpm", "clocks", "V s/rad", or "" for a ratio')
    reason: str
    source: str


class ChopperResult(Answer):
    settings: list[ChopperSetting]
    figures: list[ChopperFigure]
    warnings: list[str]
