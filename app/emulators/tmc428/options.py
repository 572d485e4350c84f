"""What an emulator can be asked for when it is made, and changed in while it runs."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, model_validator

from ...form_hints import form, rest_only, shown
from ..core.pins import PinWire
from ..drive.documents import ChipFaultsChange, Closed, Forced, Supply
from ..drive.options import LoadOptions, MotorOptions, SupplyResistance
from ..motor_documents import LoadChange

Wiring = Literal["multiplexed", "two-one-null", "left-only"]
ChipSelects = Literal["common", "individual"]
VActualWritable = Literal["hold-mode", "velocity-mode"]
FullSteps = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False, strict=True)]
AxisIndex = Annotated[int, Field(strict=True, ge=0, le=2)]


class StageOptions(Closed):
    """A linear stage with three switches. Positions in full steps of the motor.

    The default is 300 mm of travel at 200 full steps and 8 mm a turn, started in the middle, the
    reference switch 10..14 mm from the left one.
    """

    left_at_fullsteps: FullSteps = shown(
        0.0, "Left switch", "left switch is active here and to the left [full steps]", heading="Left"
    )
    ref_from_fullsteps: FullSteps = shown(
        250.0, "Left end of the reference switch", "left end of the reference switch [full steps]", heading="Ref. from"
    )
    ref_to_fullsteps: FullSteps = shown(
        350.0,
        "Right end of the reference switch",
        "right end of the reference switch [full steps]",
        heading="Ref. to",
        at_least="ref_from_fullsteps",
    )
    right_at_fullsteps: FullSteps = shown(
        7500.0,
        "Right switch",
        "right switch is active here and to the right [full steps]",
        heading="Right",
        above="left_at_fullsteps",
    )
    start_fullsteps: FullSteps = shown(
        3750.0, "Carriage at first", "where the carriage stands at first [full steps]", heading="Start"
    )

    @model_validator(mode="after")
    def _in_order(self) -> StageOptions:
        if self.ref_from_fullsteps > self.ref_to_fullsteps:
            raise ValueError("ref_from_fullsteps lies right of ref_to_fullsteps")
        if self.left_at_fullsteps >= self.right_at_fullsteps:
            raise ValueError("left_at_fullsteps does not lie left of right_at_fullsteps")
        return self


class RampChipWire(PinWire):
    pin: Literal["STEP1", "STEP2", "STEP3", "REF1", "REF2", "REF3"]


class ChainDriverOptions(Closed):
    """A driver of the chain with its motor."""

    driver: Literal["tmc236", "tmc2660"] = shown(
        "tmc236",
        "Driver",
        "tmc236: 12 bits, a status that is told, and a carriage that follows every step. tmc2660: 20 bits, "
        "its registers by cover datagrams, and a motor with physics that turns as its currents let it",
        words={"tmc236": "TMC236", "tmc2660": "TMC2660"},
    )
    motor: MotorOptions = shown(
        MotorOptions(), "Motors and loads of the chain", "of a tmc2660; the carriage of a tmc236 follows every step"
    )
    load: LoadOptions = shown(LoadOptions(), "Motors and loads of the chain", "of a tmc2660")
    supply_v: Supply = shown(24.0, "Supply", "motor supply, of a tmc2660 [V]")
    supply_resistance_ohm: SupplyResistance = 0.0
    full_scale_a: Annotated[float, Field(strict=True, ge=0.1, le=30, allow_inf_nan=False)] = shown(
        3.1,
        "Full scale",
        "peak coil current at current scale 31 and VSENSE 0, of a tmc2660: 310 mV over 100 mOhm [A]",
    )


class EmulatorOptions(Closed):
    """How an emulated chip and what hangs on it are made: the `link` of an emulated device."""

    model_config = ConfigDict(json_schema_extra=form(fold="time, seed, wiring, writes of V_ACTUAL, stages, drivers"))

    time_scale: Annotated[float, Field(strict=True, ge=0, le=1000, allow_inf_nan=False)] = shown(
        1.0, "Chip time runs at", "how fast chip time passes; 0 stands still", unit="x real time"
    )
    seed: Annotated[int, Field(strict=True, ge=0, le=2**32 - 1)] = shown(
        428, "Seed of RAM noise and bit errors", "seed of the RAM noise after power-on and of bit errors"
    )
    clock_hz: Annotated[float, Field(strict=True, ge=1.0, le=32e6, allow_inf_nan=False)] = rest_only(
        16e6, "the chip's clock [Hz]: TMC428 up to 16 MHz, TMC429 and TMC4210 up to 32 MHz"
    )
    wiring: Wiring = shown(
        "multiplexed",
        "How the switches reach REF1 to REF3",
        "TMC428: how the switches reach REF1..REF3 (DS-TMC428 Figures 9-3 to 9-5); the reference switch is "
        "wired or with the left one (9.8). The chip interprets its pins by refmux and mot1r whatever the wiring.",
        where={"axes": [2, 3]},
        words={
            "multiplexed": "multiplexed: both switches of every axis",
            "two-one-null": "two-one-null: both of motor 1, left of motor 2",
            "left-only": "left only: one switch an axis",
        },
    )
    chip_selects: ChipSelects = shown(
        "common",
        "Chip selects of the drivers",
        "TMC428, TMC429: one for a chain, or three, as csCommonIndividual = 1 wants it (DS-TMC428 9.7)",
        where={"axes": [2, 3]},
        words={"common": "one: the drivers are a chain", "individual": "three: a driver each"},
    )
    v_actual_writable: VActualWritable = shown(
        "hold-mode",
        "V_ACTUAL can be written in",
        "where a write to V_ACTUAL counts: in HOLD_MODE only, as DS-TMC428 8.6 says, so that a stop in "
        "VELOCITY_MODE brakes; or in VELOCITY_MODE too, where 0 then stops dead, as Trinamic's own software expects",
        words={
            "hold-mode": "hold mode only: 0 in velocity mode brakes",
            "velocity-mode": "velocity mode too: 0 there stops dead",
        },
    )
    stages: Annotated[list[StageOptions], Field(max_length=3)] = Field(
        default_factory=list,
        title="Stages: switches and carriage",
        description="one stage an axis; axes beyond the list have the default stage",
    )
    wires: Annotated[list[RampChipWire], Field(max_length=6)] = rest_only(
        [],
        "pins that are wired to emulated drivers of this server: STEP1 to STEP3 of a TMC4210, or of a TMC429 with "
        "en_sd, to their steps; REF1 to REF3 to DIAG, in place of the left switch of an axis",
    )
    drivers: Annotated[list[ChainDriverOptions], Field(max_length=3)] = Field(
        default_factory=list,
        title="Drivers of the chain",
        description="TMC428, TMC429: drivers of the chain, one an axis, the first next to SDI_S; none: three tmc236",
        json_schema_extra=form(where={"axes": [2, 3]}),
    )
    driver_microsteps: Annotated[int, Field(strict=True, ge=1, le=256)] = rest_only(
        16, "TMC4210, TMC429 with en_sd: microsteps per full step of the step/direction drivers"
    )


class SwitchChange(Closed):
    """Forces switches of one axis, or gives them back to the stage with "auto"."""

    axis: AxisIndex
    left: Forced | None = None
    right: Forced | None = None
    reference: Forced | None = None


class StageChange(Closed):
    """Moves switches of one stage, or the carriage itself as by hand. Full steps."""

    axis: AxisIndex
    left_at_fullsteps: FullSteps | None = None
    right_at_fullsteps: FullSteps | None = None
    ref_from_fullsteps: FullSteps | None = None
    ref_to_fullsteps: FullSteps | None = None
    position_fullsteps: FullSteps | None = Field(default=None, description="puts the carriage there")


class InputsChange(Closed):
    gp_in: Annotated[bool, Field(strict=True)] | None = Field(
        default=None, description="TMC4210: level of the general purpose input"
    )


class DriverChange(LoadChange):
    """TMC428: one driver of the chain. Of a tmc236 the 12 status bits that it reports; of a tmc2660 its motor, load,
    temperature and supply, of which its status follows."""

    axis: AxisIndex
    status: Annotated[int, Field(strict=True, ge=0, le=0xFFF)] | None = Field(
        default=None, description="of a tmc236: LD2 LD1 LD0 1 OT OTPW UV OCHS OLB OLA OCB OCA"
    )
    supply_v: Supply | None = Field(default=None, description="of a tmc2660: motor supply [V]")

    @property
    def of_motor(self) -> bool:
        """Whether anything is said of motor, load or supply."""
        return bool(self.model_dump(exclude_unset=True, exclude={"axis", "status"}))


class EmulatorPatch(Closed):
    """A change to a running emulator; what is left out stays. A power cycle comes first."""

    time_scale: Annotated[float, Field(strict=True, ge=0, le=1000, allow_inf_nan=False)] | None = None
    switches: Annotated[list[SwitchChange], Field(max_length=3)] = Field(default_factory=list)
    stages: Annotated[list[StageChange], Field(max_length=3)] = Field(default_factory=list)
    inputs: InputsChange = Field(default_factory=InputsChange)
    faults: ChipFaultsChange = Field(default_factory=ChipFaultsChange)
    drivers: Annotated[list[DriverChange], Field(max_length=3)] = Field(default_factory=list)
    power_cycle: Annotated[bool, Field(strict=True)] = Field(
        default=False, description="resets the chip; the carriages stay where they are"
    )
