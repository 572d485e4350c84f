"""What an emulated TMC4361 can be asked for when it is made, and changed in while it runs."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, model_validator

from ...form_hints import form, rest_only, shown
from ..core.pins import WIRES_MAX, PinWire
from ..drive.documents import (
    ChipFaultsChange,
    Closed,
    Flag,
    Forced,
    StageChange,
    Supply,
    TimeScale,
)
from ..drive.options import MotorOptions, StageSwitches
from ..motor_documents import LoadChange, MotorDocument, NoiseSeed
from .feedback import DriverBehind, EncoderPatch, FeedbackOptions, FeedbackPatch, ShaftEncoder

FaultsChange = ChipFaultsChange


class Tmc4361Wire(PinWire):
    pin: Literal["START", "STEP1", "STOPL", "STOPR"]


class Tmc4361Options(MotorDocument):
    """How an emulated chip, its motor, its encoder and its stage are made: the `link` of an emulated device."""

    model_config = ConfigDict(json_schema_extra=form(fold="motor, load, stage, encoder, driver"))

    seed: NoiseSeed = 4361
    clock_hz: Annotated[float, Field(strict=True, ge=4.2e6, le=32e6, allow_inf_nan=False)] = rest_only(
        16e6, "the clock at CLK_EXT [Hz]; CLK_FREQ only tells the chip what it is"
    )
    motor: MotorOptions = Field(default_factory=MotorOptions, title="Motor and load")
    stage: StageSwitches = Field(default_factory=StageSwitches, title="Stage: where switches are")
    encoder: ShaftEncoder = Field(default_factory=ShaftEncoder, title="Encoder")
    full_scale_a: Annotated[float, Field(strict=True, ge=0.1, le=30, allow_inf_nan=False)] = rest_only(
        2.1, "peak coil current at current scale 255 [A]: the default motor's holding torque"
    )
    driver: DriverBehind = shown(
        "wired",
        "Motor driver",
        "what is behind the chip: wired, bridges that take its currents; tmc2130 or tmc2660, a driver that cover "
        "datagrams have to set up and that follows steps or currents",
        words={
            "wired": "bridges that take the chip's currents",
            "tmc2130": "TMC2130, set up by cover datagrams",
            "tmc2660": "TMC2660, set up by cover datagrams",
        },
    )
    stall_threshold: Annotated[int, Field(strict=True, ge=-64, le=63)] = rest_only(
        0, "SGT of a wired driver's StallGuard2"
    )

    wires: Annotated[list[Tmc4361Wire], Field(max_length=WIRES_MAX)] = rest_only(
        [],
        "pins that are wired to other emulators of this server: START; STEP1, its step and direction output; STOPL and "
        "STOPR to DIAG of a driver, in place of switches",
    )

    def feedback(self) -> FeedbackOptions:
        """The part that the feedback unit and the motor are made with."""
        return FeedbackOptions(
            motor=self.motor,
            load=self.load,
            stage=self.stage,
            encoder=self.encoder,
            supply_v=self.supply_v,
            full_scale_a=self.full_scale_a,
            stall_threshold=self.stall_threshold,
            driver=self.driver,
            start_fullsteps=self.start_fullsteps,
            seed=self.seed,
        )

    @model_validator(mode="after")
    def _can_be_computed(self) -> Tmc4361Options:
        self.feedback()
        return self


class SwitchesChange(Closed):
    """Forces switches, or gives them back to the stage with "auto"."""

    left: Forced | None = Field(default=None, description="level at STOPL: true is high")
    right: Forced | None = Field(default=None, description="level at STOPR")
    home: Forced | None = Field(default=None, description="level at HOME_REF")


class PinsChange(Closed):
    """Levels from outside: true is high. "auto" gives START its inactive level, and leaves NFREEZE high."""

    start: Forced | None = Field(default=None, description="level at START")
    freeze: Forced | None = Field(default=None, description="level at NFREEZE: false freezes")


class StepDirChange(Closed):
    """Pulses at STPIN, as from a pulse generator. They count while sdin_mode is not 0."""

    pulses: Annotated[int, Field(strict=True, ge=-(2**24), le=2**24)] = Field(
        description="so many more; negative: DIRIN says so"
    )
    rate_hz: Annotated[float, Field(strict=True, ge=1, le=8e6, allow_inf_nan=False)] = Field(
        default=1000.0, description="pulses a second"
    )


class ListenChange(Closed):
    """Clocks at the serial encoder output, as from a listener."""

    clocks: Annotated[int, Field(strict=True, ge=1, le=80)] = Field(description="so many, at once")
    rate_hz: Annotated[float, Field(strict=True, ge=1e3, le=8e6, allow_inf_nan=False)] = Field(
        default=100e3, description="clocks a second"
    )


class Tmc4361Patch(LoadChange):
    """A change to a running chip; what is left out stays. A power cycle comes first."""

    time_scale: TimeScale | None = None
    inertia: Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)] | None = Field(
        default=None, description="of the load [kg m^2]"
    )
    supply_v: Supply | None = Field(default=None, description="motor supply [V]; the driver needs 8")
    stage: StageChange = Field(default_factory=StageChange)
    switches: SwitchesChange = Field(default_factory=SwitchesChange)
    pins: PinsChange = Field(default_factory=PinsChange)
    encoder: EncoderPatch = Field(default_factory=EncoderPatch)
    step_dir: StepDirChange | None = None
    listen: ListenChange | None = None
    faults: FaultsChange = Field(default_factory=FaultsChange)
    power_cycle: Flag = Field(default=False, description="off and on again; motor and stage stay where they are")

    def feedback(self) -> FeedbackPatch:
        """The part that is the feedback unit's."""
        return FeedbackPatch(
            load_torque_nm=self.load_torque_nm,
            friction_nm=self.friction,
            inertia_kgm2=self.inertia,
            blocked=self.blocked,
            connected=self.motor.connected,
            supply_v=self.supply_v,
            temperature_c=self.motor.temperature_c,
            short_to_ground=self.motor.short_to_ground,
            rotor_fullsteps=self.stage.position_fullsteps,
            encoder=self.encoder if self.encoder.model_fields_set else None,
        )
