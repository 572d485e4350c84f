"""What an emulated driver can be asked for when it is made, and changed in while it runs."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import ConfigDict, Field, model_validator

from ...form_hints import REST_ONLY, form
from ..drive.bench import ChipFaultsChange, Closed, Flag, Friction, MotorChange, Seed, Supply, TimeScale, Torque
from ..drive.options import DriveOptions, FullSteps, LoadOptions, MotorOptions

DriverModel = Literal["tmc2209"]
MODELS: tuple[DriverModel, ...] = get_args(DriverModel)
Rigid = Literal["rigid"]


class TmcDriverOptions(Closed):
    """How an emulated driver and its motor are made: the `link` of an emulated device."""

    model_config = ConfigDict(json_schema_extra=form(fold="motor, load"))

    time_scale: TimeScale = Field(
        default=1.0,
        title="Time runs at",
        description="how fast the chip's time passes; 0 stands still",
        json_schema_extra=form(unit="x real time"),
    )
    supply_v: Supply = Field(default=24.0, title="Supply", description="motor supply [V]")
    node: Annotated[int, Field(strict=True, ge=0, le=3)] = Field(
        default=0,
        title="Node address",
        description="of a TMC2209, by its pins: MS1 is 1 of it, MS2 2. They also set its microsteps, unless "
        "mstep_reg_select says otherwise",
        json_schema_extra=form(where={"nodes": [4]}),
    )
    seed: Seed = Field(
        default=2209, title="Seed of noise and faults", description="of the noise in the load value and of bit errors"
    )
    start_fullsteps: FullSteps = Field(
        default=0.0, title="Rotor at first", description="where the rotor stands at first [full steps]"
    )
    clock_hz: Annotated[float, Field(strict=True, ge=4e6, le=16e6, allow_inf_nan=False)] = Field(
        default=12e6, description="fCLK, which velocities and delays hang on [Hz]", json_schema_extra=REST_ONLY
    )
    motor: MotorOptions | Rigid = Field(
        default_factory=MotorOptions,
        title="Motor and load",
        description='"rigid": no physics, the shaft follows the field exactly, and long stretches at constant velocity '
        "take no time to work out",
    )
    load: LoadOptions = Field(default_factory=LoadOptions, title="Motor and load")
    full_scale_a: Annotated[float, Field(strict=True, ge=0.1, le=30, allow_inf_nan=False)] | None = Field(
        default=None,
        description="peak coil current at current scale 31 and vsense 0; null: as the chip's evaluation board has it "
        "[A]",
        json_schema_extra=REST_ONLY,
    )

    @property
    def rigid(self) -> bool:
        """Whether the shaft follows the field exactly."""
        return self.motor == "rigid"

    def drive(self, full_scale_a: float) -> DriveOptions:
        """The part that motor and bridges are made with; `full_scale_a` [A] is what the chip has by itself."""
        return DriveOptions(
            motor=MotorOptions() if self.motor == "rigid" else self.motor,
            load=self.load,
            clock_hz=self.clock_hz,
            supply_v=self.supply_v,
            full_scale_a=self.full_scale_a or full_scale_a,
            start_fullsteps=self.start_fullsteps,
            seed=self.seed,
            rigid=self.rigid,
        )

    @model_validator(mode="after")
    def _can_be_computed(self) -> TmcDriverOptions:
        self.drive(1.0)
        return self


class DriverPinsChange(Closed):
    """Levels from outside: true is high."""

    enn: Flag | None = Field(default=None, description="level at ENN: high switches the bridges off")


class TmcDriverPatch(Closed):
    """A change to a running driver; what is left out stays. A power cycle comes first."""

    time_scale: TimeScale | None = None
    motor: MotorChange = Field(default_factory=MotorChange)
    load_torque_nm: Torque | None = Field(
        default=None, description="constant, like a weight: a positive one pulls to negative positions [N m]"
    )
    blocked: Flag | None = Field(default=None, description="clamps the shaft where it is")
    friction: Friction | None = Field(default=None, description="friction on top of the motor's own [N m]")
    supply_v: Supply | None = Field(default=None, description="motor supply [V]; the driver needs 4.75")
    pins: DriverPinsChange = Field(default_factory=DriverPinsChange)
    faults: ChipFaultsChange = Field(default_factory=ChipFaultsChange)
    power_cycle: Flag = Field(default=False, description="off and on again; the motor stays where it is")
