"""What hangs on an emulated TMC4361: motor with load, current driver, encoder."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, model_validator

from ....deferred import DeferredModel
from ....form_hints import REST_ONLY, rest_only, shown
from ...drive import DriveOptions, EncoderOptions, LoadOptions, MotorOptions
from ...drive.options import FullSteps, LineError, StageSwitches, SupplyResistance

EncoderKind = Literal["abn", "ssi", "spi"]


class _Closed(DeferredModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ShaftEncoder(_Closed):
    """The encoder on the motor's shaft. It sees theta + e1 sin(theta + p1), an error once a line too, in counts."""

    eccentricity_deg: Annotated[float, Field(strict=True, ge=0, le=10)] = shown(
        0.0, "Eccentricity", "amplitude e1 of the once-a-turn error [deg of the shaft]", unit="°"
    )
    kind: EncoderKind = rest_only("abn", "incremental with N channel, or absolute over SSI or SPI")
    lines: Annotated[int, Field(strict=True, ge=1, le=1 << 22)] = shown(
        10_000, "Lines", "abn: lines a turn, four counts each"
    )
    single_turn_bits: Annotated[int, Field(strict=True, ge=2, le=24)] = rest_only(
        13, "ssi, spi: bits of the place in the turn"
    )
    multi_turn_bits: Annotated[int, Field(strict=True, ge=0, le=24)] = rest_only(
        12, "ssi, spi: bits of the turns counted"
    )
    gray: Annotated[bool, Field(strict=True)] = rest_only(False, "ssi, spi: answers in Gray code")
    status_bits: Annotated[int, Field(strict=True, ge=0, le=3)] = rest_only(
        0, "ssi, spi: status bits after the position"
    )
    zero_fullsteps: FullSteps = rest_only(
        37.3, "mounting offset: place of the rotor at which the encoder counts 0 (N pulse)"
    )
    reversed: Annotated[bool, Field(strict=True)] = rest_only(False, "counts down as the motor goes up")
    eccentricity_phase_deg: Annotated[float, Field(strict=True, ge=-360, le=360)] = Field(
        default=0.0, json_schema_extra=REST_ONLY
    )

    line_error: LineError = rest_only(0.0, "once a line, of an absolute one once every four counts [lines]")

    @property
    def counts(self) -> int:
        """Counts a turn."""
        return 4 * self.lines if self.kind == "abn" else 1 << self.single_turn_bits


DriverBehind = Literal["wired", "tmc2130", "tmc2660"]
"""What the chip drives: bridges that its currents are wired to, or a driver with registers of its own."""


class FeedbackOptions(_Closed):
    """Everything behind the ramp generator of an emulated TMC4361."""

    motor: MotorOptions = MotorOptions()
    load: LoadOptions = LoadOptions()
    stage: StageSwitches = StageSwitches()
    """Of it the hard ends are the motor's affair; its switches are the chip's."""
    encoder: ShaftEncoder = ShaftEncoder()
    supply_v: Annotated[float, Field(strict=True, ge=0, le=60)] = Field(default=24.0, description="motor supply")
    supply_resistance_ohm: SupplyResistance = 0.0
    full_scale_a: Annotated[float, Field(strict=True, ge=0.1, le=30)] = Field(
        default=2.1, description="peak coil current at scale 255: the default motor's holding torque"
    )
    regulator_s: Annotated[float, Field(strict=True, ge=2e-5, le=1e-3)] = Field(
        default=1e-4, description="time constant of the chopper, taken as a first-order lag"
    )
    stall_threshold: Annotated[int, Field(strict=True, ge=-64, le=63)] = Field(
        default=0, description="SGT of the driver's StallGuard2"
    )
    driver: DriverBehind = "wired"
    start_fullsteps: FullSteps = Field(default=0.0, description="where the rotor stands at first")
    seed: Annotated[int, Field(strict=True, ge=0, le=2**32 - 1)] = Field(default=4361, description="of the noise")

    def drive(self, clock_hz: float) -> DriveOptions:
        """The same as the drive's physics takes it, for a chip clocked with `clock_hz`."""
        return DriveOptions(
            motor=self.motor,
            load=self.load,
            stage=self.stage,
            encoders=EncoderOptions(eccentricity_deg=self.encoder.eccentricity_deg),
            clock_hz=clock_hz,
            supply_v=self.supply_v,
            supply_resistance_ohm=self.supply_resistance_ohm,
            full_scale_a=self.full_scale_a,
            regulator_s=self.regulator_s,
            start_fullsteps=self.start_fullsteps,
            seed=self.seed,
        )

    @model_validator(mode="after")
    def _can_be_computed(self) -> FeedbackOptions:
        self.drive(4.2e6)  # the slowest clock has the longest ticks
        return self
