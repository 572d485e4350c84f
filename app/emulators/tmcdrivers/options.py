"""What an emulated driver can be asked for when it is made, and changed in while it runs."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import ConfigDict, Field, model_validator

from ...errors import OutOfRange, WrongState
from ...form_hints import form, rest_only, shown
from ..core.pins import PinWire
from ..drive.documents import ChipFaultsChange, Closed, Flag, Supply, TimeScale
from ..drive.options import DriveOptions, FullSteps, StageSwitches
from ..motor_documents import LoadChange, MotorDocument, NoiseSeed, require_physics

STEP_HZ_MAX = 9e6
DriverModel = Literal["tmc2130", "tmc2209", "tmc2240", "tmc2660"]
MODELS: tuple[DriverModel, ...] = get_args(DriverModel)


class DriverWire(PinWire):
    pin: Literal["STEP1", "DIAG"]


class TmcDriverOptions(MotorDocument):
    """How an emulated driver and its motor are made: the `link` of an emulated device."""

    model_config = ConfigDict(json_schema_extra=form(fold="motor, load"))

    seed: NoiseSeed = 2209
    node: Annotated[int, Field(strict=True, ge=0, le=3)] = shown(
        0,
        "Node address",
        "of a TMC2209, by its pins: MS1 is 1 of it, MS2 2. They also set its microsteps, unless "
        "mstep_reg_select says otherwise",
        where={"nodes": [4]},
    )
    clock_hz: Annotated[float, Field(strict=True, ge=4e6, le=20e6, allow_inf_nan=False)] = rest_only(
        12e6, "fCLK, which velocities and delays hang on [Hz]; left out, each chip has its own"
    )
    full_scale_a: Annotated[float, Field(strict=True, ge=0.1, le=30, allow_inf_nan=False)] | None = rest_only(
        None, "peak coil current at current scale 31 and vsense 0; null: as the chip's evaluation board has it [A]"
    )

    wires: Annotated[list[DriverWire], Field(max_length=2)] = rest_only(
        [],
        "pins that are wired to an emulated controller of this server: STEP1, STEP and DIR, to its step output; DIAG, "
        "of a TMC2660 SG_TST, to an input for a stop switch",
    )
    left_end_fullsteps: FullSteps | None = rest_only(
        None, "the load can be turned no further to the left than here [full steps]; null: no hard end"
    )
    right_end_fullsteps: FullSteps | None = rest_only(
        None, "the load can be turned no further to the right than here [full steps]; null: no hard end"
    )

    def for_clock(self, clock_hz: float) -> TmcDriverOptions:
        """The same with the clock that a chip has by itself, where nobody has said another."""
        return self if "clock_hz" in self.model_fields_set else self.model_copy(update={"clock_hz": clock_hz})

    def drive(self, full_scale_a: float) -> DriveOptions:
        """The part that motor and bridges are made with; `full_scale_a` [A] is what the chip has by itself."""
        return DriveOptions(
            motor=self.physics,
            load=self.load,
            clock_hz=self.clock_hz,
            supply_v=self.supply_v,
            supply_resistance_ohm=self.supply_resistance_ohm,
            full_scale_a=self.full_scale_a or full_scale_a,
            start_fullsteps=self.start_fullsteps,
            stage=StageSwitches(
                left_end_fullsteps=self.left_end_fullsteps, right_end_fullsteps=self.right_end_fullsteps
            ),
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
    vref_v: Annotated[float, Field(strict=True, ge=0, le=5, allow_inf_nan=False)] | None = Field(
        default=None, description="voltage at VREF, or at AIN of a TMC2130 [V]: 2.5 and more is full scale"
    )
    step_hz: Annotated[float, Field(strict=True, ge=-STEP_HZ_MAX, le=STEP_HZ_MAX, allow_inf_nan=False)] | None = Field(
        default=None,
        description="steps a second that come in at STEP, negative with DIR high; at most half of the clock [Hz]",
    )


class TmcDriverPatch(LoadChange):
    """A change to a running driver; what is left out stays. A power cycle comes first."""

    time_scale: TimeScale | None = None
    supply_v: Supply | None = Field(default=None, description="motor supply [V]; the driver needs 4.75")
    pins: DriverPinsChange = Field(default_factory=DriverPinsChange)
    faults: ChipFaultsChange = Field(default_factory=ChipFaultsChange)
    power_cycle: Flag = Field(default=False, description="off and on again; the motor stays where it is")


def check_change(options: TmcDriverOptions, change: TmcDriverPatch, *, has_vref: bool = False) -> None:
    """Raises WrongState for a load on a rigid motor and for a voltage at a pin that the chip has not, OutOfRange for
    steps faster than the chip can see."""
    require_physics(options.rigid, change)
    if change.pins.vref_v is not None and not has_vref:
        raise WrongState("this chip has no pin that scales its current", "leave vref_v out")
    steps, most = change.pins.step_hz, options.clock_hz / 2
    if steps is not None and abs(steps) >= most:
        raise OutOfRange("step_hz", steps, -most, most, "less than half of the chip's clock")
