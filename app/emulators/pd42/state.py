"""What an emulated PD42-1241 tells about itself, its motor and the world behind its plugs."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, Field


class MotorState(BaseModel):
    connected: bool
    temperature_c: float = Field(description="of the driver's bridges [deg C]")
    fullsteps_per_turn: int
    torque_constant_nm_a: float = Field(description="of one phase, peak values; also back-EMF constant [V s/rad]")
    holding_torque_nm: float = Field(description="both coils at rated current [N m]")
    rated_current_a: float = Field(description="in both coils [A]")


class StageState(BaseModel):
    """Where switches and carriage are [full steps of the rotor]."""

    left_at_fullsteps: float
    right_at_fullsteps: float
    home_from_fullsteps: float
    home_to_fullsteps: float
    position_fullsteps: float = Field(description="where the carriage really is")


class SwitchState(BaseModel):
    active: bool = Field(description="pressed: polarity and swapping by axis parameters do not enter")
    forced: bool | None = Field(description="null while the switch follows the stage")


class SwitchesState(BaseModel):
    left: SwitchState
    right: SwitchState
    home: SwitchState


class EncoderState(BaseModel):
    absolute: int = Field(description="place of the built-in encoder in its turn, 0..1023")
    counts: int = Field(description="built-in encoder, since the start")
    external_counts: int = Field(description="external encoder, since the start: four a line")
    slip_fullsteps: float = Field(description="how far the built-in encoder's magnet has slipped in all")
    external_slip_fullsteps: float
    eccentricity_deg: float = Field(description="once-a-turn error of the built-in encoder [deg of the shaft]")


class InputsState(BaseModel):
    in0: bool = Field(description="home switch")
    in1: bool
    in2: bool
    in3: bool = Field(description="the analog input as a digital one")
    analog: int = Field(description="ADC counts")
    outputs: list[int] = Field(description="what SIO has set")


class FaultsState(BaseModel):
    silence: bool
    late_reply_s: float
    bit_error_rate: float
    half_frame_rate: float
    unplugged: bool
    undervoltage: bool


class ApplicationState(BaseModel):
    """The program in the module. It is stored and its run state kept; nothing executes it."""

    status: Literal["stopped", "runs", "steps"]
    counter: int = Field(description="command that would come next")
    downloading: bool
    commands: int = Field(description="commands in program memory")
    accumulator: int
    x: int


class SearchState(BaseModel):
    mode: int = Field(description="axis parameter 193")
    phase: str = Field(description="what the reference search does; empty while none runs")


class TruthState(BaseModel):
    """How motor and shaft really are: what no command of the module tells."""

    rotor_rad: float = Field(description="shaft angle, not wrapped [rad]")
    rotor_fullsteps: float = Field(description="the same in full steps")
    field_fullsteps: float = Field(description="where an ideal unloaded rotor would stand [full steps]")
    speed_rad_s: float
    load_angle_deg: float = Field(description="field minus rotor [deg electrical]; more than 90 does not hold")
    current_a_a: float = Field(description="coil A [A]")
    current_b_a: float = Field(description="coil B [A]")
    torque_nm: float
    lost_fullsteps: int = Field(description="full steps lost since power-on: multiples of four")
    current_scale: int = Field(description="current scale in use, 0..31")
    bridges: str = Field(description='"regulated", "open" or "shorted"')


class Pd42State(BaseModel):
    """Everything that GET .../emulator answers for a PD42-1241."""

    model: Literal["pd42-1241"] = "pd42-1241"
    time_scale: float
    chip_time_s: float
    address: int = Field(description="serial address now")
    baud: int = Field(description="baud rate in force: a change waits for the next power-on")
    motor: MotorState
    load_torque_nm: float
    blocked: bool
    friction: float = Field(description="friction on top of the motor's own [N m]")
    supply_v: float = Field(description="motor supply [V]")
    stage: StageState
    switches: SwitchesState
    encoder: EncoderState
    inputs: InputsState
    faults: FaultsState
    application: ApplicationState
    search: SearchState
    truth: TruthState
    eeprom_path: str | None = Field(description="file that keeps the EEPROM; null: forgotten with the process")
