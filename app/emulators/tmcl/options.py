"""What an emulated PD42-1241 can be asked for when it is made, and changed in while it runs."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from ...form_hints import REST_ONLY, form, rest_only
from ..drive.documents import (
    Closed,
    Flag,
    Forced,
    StageChange,
    Supply,
    TimeScale,
)
from ..drive.options import DriveOptions, EncoderOptions, FullSteps, StageSwitches
from ..motor_documents import LoadChange, MotorDocument, NoiseSeed
from ..wire_documents import WireFaultsChange

Level = Flag | Literal["open"]


class TmclOptions(MotorDocument):
    """How an emulated module, its motor and its stage are made: the `link` of an emulated device."""

    model_config = ConfigDict(json_schema_extra=form(fold="motor, load, stage, encoders"))

    seed: NoiseSeed = 1241
    address: Annotated[int, Field(strict=True, ge=1, le=255)] = rest_only(
        1, "serial address at delivery; what its EEPROM holds comes first"
    )
    baud_code: Annotated[int, Field(strict=True, ge=0, le=11)] = rest_only(
        0, "code of the baud rate at delivery (global parameter 65); 0 is 9600, 7 is 115200"
    )
    can_receive_id: Annotated[int, Field(strict=True, ge=0, le=2047)] = rest_only(
        1, "CAN identifier that it listens to at delivery (global parameter 71)"
    )
    can_send_id: Annotated[int, Field(strict=True, ge=0, le=2047)] = rest_only(
        2, "CAN identifier of its answers at delivery (global parameter 70)"
    )
    ripple: Flag = rest_only(
        False, "SpreadCycle bends the coils' currents by its blank time, slow decay and hysteresis, as real ones do"
    )
    stage: StageSwitches = Field(default_factory=StageSwitches, title="Stage: where switches are")
    encoders: EncoderOptions = Field(default_factory=EncoderOptions, title="Encoders")
    unknown_parameters: Annotated[list[Annotated[int, Field(strict=True, ge=0, le=255)]], Field(max_length=256)] = (
        Field(
            default_factory=list,
            description="axis parameters that its firmware, as another version, does not have: answered with status 3",
            json_schema_extra=REST_ONLY,
        )
    )
    later_commands: Flag = rest_only(
        False, "its firmware knows the commands of later ones too (CALCV and its kin); firmware 1.44 does not"
    )
    command_us: Annotated[float, Field(strict=True, ge=1, le=1e6, allow_inf_nan=False)] = rest_only(
        100.0, "how long a command of a program takes [us of the module's time]; no source tells it"
    )

    def drive(self, full_scale_a: float) -> DriveOptions:
        """The part that the motor and its driver chip, of that peak coil current, are made with."""
        return DriveOptions(
            motor=self.physics,
            load=self.load,
            stage=self.stage,
            encoders=self.encoders,
            supply_v=self.supply_v,
            supply_resistance_ohm=self.supply_resistance_ohm,
            full_scale_a=full_scale_a,
            start_fullsteps=self.start_fullsteps,
            seed=self.seed,
            rigid=self.rigid,
            ripple=self.ripple,
        )


class SwitchesChange(Closed):
    """Forces switches, or gives them back to the stage with "auto"."""

    left: Forced | None = None
    right: Forced | None = None
    home: Forced | None = None


class EncoderChange(Closed):
    slip_fullsteps: FullSteps | None = Field(
        default=None, description="one shot: lets the built-in encoder's magnet slip on the shaft by so much"
    )
    external_slip_fullsteps: FullSteps | None = Field(default=None, description="one shot: the same, external encoder")
    eccentricity_deg: Annotated[float, Field(strict=True, ge=0, le=10, allow_inf_nan=False)] | None = Field(
        default=None, description="once-a-turn error of the built-in encoder [deg of the shaft]"
    )


class InputsChange(Closed):
    in1: Level | None = Field(default=None, description='level on IN1, or "open"')
    in2: Level | None = Field(default=None, description='level on IN2, or "open"')
    analog: Annotated[int, Field(strict=True, ge=0, le=4095)] | None = Field(
        default=None, description="counts of the analog input AIN0; IN3 is 1 from 2048 on"
    )


class StepDirChange(Closed):
    """Pulses on the step input, as from a pulse generator. They count while axis parameter 254 is 1."""

    pulses: Annotated[int, Field(strict=True, ge=-(2**24), le=2**24)] = Field(
        description="so many more; negative: direction left"
    )
    rate_hz: Annotated[float, Field(strict=True, ge=1, le=1e6, allow_inf_nan=False)] = Field(
        default=1000.0, description="pulses a second"
    )


class FaultsChange(WireFaultsChange):
    """Faults on the wire and of the supply."""

    undervoltage: Flag | None = Field(
        default=None, description="motor supply below what the driver needs: bridges off, motor free"
    )


class TmclPatch(LoadChange):
    """A change to a running module; what is left out stays. A power cycle or factory default comes first."""

    time_scale: TimeScale | None = None
    supply_v: Supply | None = Field(default=None, description="motor supply [V]; the driver needs 8")
    stage: StageChange = Field(default_factory=StageChange)
    switches: SwitchesChange = Field(default_factory=SwitchesChange)
    encoder: EncoderChange = Field(default_factory=EncoderChange)
    inputs: InputsChange = Field(default_factory=InputsChange)
    step_dir: StepDirChange | None = None
    faults: FaultsChange = Field(default_factory=FaultsChange)
    power_cycle: Flag = Field(default=False, description="off and on again; motor and stage stay where they are")
    factory_default: Flag = Field(default=False, description="erases the EEPROM, then power cycles")
