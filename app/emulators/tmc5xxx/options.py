"""What an emulated TMC5xxx can be asked for when it is made, and changed in while it runs."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import ConfigDict, Field, model_validator

from ...form_hints import form, rest_only, shown
from ..drive.documents import (
    ChipFaultsChange,
    Closed,
    Flag,
    Forced,
    StageChange,
    Supply,
    TimeScale,
)
from ..drive.options import DriveOptions, EncoderErrors, EncoderOptions, FullSteps, StageSwitches
from ..motor_documents import LoadChange, MotorDocument

Tmc5xxxModel = Literal["tmc5031", "tmc5062", "tmc5072", "tmc5130", "tmc5160", "tmc5240"]
MODELS: tuple[Tmc5xxxModel, ...] = get_args(Tmc5xxxModel)


class LineEncoder(Closed):
    """An encoder with A, B and N lines on the shaft of each motor. N is high for one line a turn, from its count 0."""

    lines: Annotated[int, Field(strict=True, ge=1, le=1 << 20)] = shown(10_000, "Lines", "of a turn, four counts each")
    reversed: Flag = rest_only(False, "A and B are swapped")
    errors: EncoderErrors = rest_only(EncoderErrors(), "how far its graduation is off")


class Tmc5xxxOptions(MotorDocument):
    """How an emulated chip, its motors, encoders and stages are made: the `link` of an emulated device.

    Two motors of one chip are alike.
    """

    model_config = ConfigDict(json_schema_extra=form(fold="motor, load, stage"))

    clock_hz: Annotated[float, Field(strict=True, ge=4e6, le=18e6, allow_inf_nan=False)] = rest_only(
        16e6, "fCLK, which the units of all registers hang on [Hz]; left out, a TMC5240 has its own 12.5 MHz"
    )
    stage: StageSwitches = Field(default_factory=StageSwitches, title="Stage: where switches are")
    encoder: LineEncoder = Field(
        default_factory=LineEncoder,
        title="Encoder",
        description="on the shaft of each motor",
        json_schema_extra=form(where={"capabilities": ["encoder"]}),
    )
    full_scale_a: Annotated[float, Field(strict=True, ge=0.1, le=30, allow_inf_nan=False)] | None = rest_only(
        None,
        "peak coil current at current scale 31, vsense 0 or GLOBALSCALER 0, and the widest CURRENT_RANGE; "
        "null: as the chip's evaluation board has it [A]",
    )
    ripple: Flag = rest_only(
        False, "SpreadCycle bends the coils' currents by its blank time, slow decay and hysteresis, as real ones do"
    )
    node_pin: Flag = rest_only(False, "NEXTADDR is high: the UART's node address is one more")

    def for_clock(self, clock_hz: float) -> Tmc5xxxOptions:
        """The same with the clock that a chip has by itself, where nobody has said another."""
        return self if "clock_hz" in self.model_fields_set else self.model_copy(update={"clock_hz": clock_hz})

    def drive(self, full_scale_a: float, has_encoder: bool) -> DriveOptions:
        """The part that each motor and its driver are made with; `full_scale_a` [A] is what the chip has by itself."""
        return DriveOptions(
            motor=self.physics,
            load=self.load,
            stage=self.stage,
            encoders=EncoderOptions(
                external_lines=self.encoder.lines,
                external_reversed=self.encoder.reversed,
                external_errors=self.encoder.errors,
            ),
            clock_hz=self.clock_hz,
            supply_v=self.supply_v,
            supply_resistance_ohm=self.supply_resistance_ohm,
            full_scale_a=self.full_scale_a or full_scale_a,
            ripple=self.ripple,
            start_fullsteps=self.start_fullsteps,
            seed=self.seed,
            rigid=self.rigid,
            n_line=has_encoder,
        )

    @model_validator(mode="after")
    def _can_be_computed(self) -> Tmc5xxxOptions:
        self.drive(1.0, has_encoder=True)
        return self


class SwitchesChange(Closed):
    """Forces switches, or gives them back to the stage with "auto"."""

    left: Forced | None = Field(default=None, description="level at REFL: true is high, as a pressed switch is")
    right: Forced | None = Field(default=None, description="level at REFR")


class EncoderChange(Closed):
    slip_fullsteps: FullSteps | None = Field(
        default=None, description="one shot: lets the encoder slip on the shaft by so much"
    )


class AxisChange(LoadChange):
    """One motor, its load, its switches; what is left out stays."""

    axis: Annotated[int, Field(strict=True, ge=0, le=1)]
    stage: StageChange = Field(default_factory=StageChange)
    switches: SwitchesChange = Field(default_factory=SwitchesChange)
    encoder: EncoderChange = Field(default_factory=EncoderChange)


class PinsChange(Closed):
    """Levels from outside: true is high."""

    drv_enn: Flag | None = Field(default=None, description="level at DRV_ENN: high switches all bridges off")
    nextaddr: Flag | None = Field(default=None, description="level at NEXTADDR: high adds 1 to the node address")


class Tmc5xxxPatch(Closed):
    """A change to a running chip; what is left out stays. A power cycle comes first."""

    time_scale: TimeScale | None = None
    axes: list[AxisChange] = Field(default_factory=list, max_length=2)
    supply_v: Supply | None = Field(default=None, description="motor supply [V]; the driver needs 8, of a TMC5240 4.5")
    pins: PinsChange = Field(default_factory=PinsChange)
    faults: ChipFaultsChange = Field(default_factory=ChipFaultsChange)
    power_cycle: Flag = Field(default=False, description="off and on again; motors and stages stay where they are")
