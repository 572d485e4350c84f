"""What an emulated TMC4361 tells about itself, and its plant: motor, load, stage and what is at its pins."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...deferred import DeferredModel
from ..core.base import EmulatedState
from ..drive.documents import ChipFaultsState, StageState, TruthState
from .feedback.state import EncoderOutputState, EncoderState, FeedbackMotor, PwmState


class LevelState(DeferredModel):
    active: bool = Field(description="the pin is high: polarity and filters do not enter")
    forced: bool | None = Field(description="null while nobody forces it")


class SwitchesState(DeferredModel):
    left: LevelState
    right: LevelState
    home: LevelState


class PinsState(DeferredModel):
    """Pins besides those of the switches, as levels: true is high."""

    start: LevelState = Field(description="START as an input")
    freeze: LevelState = Field(description="NFREEZE")
    start_out: bool = Field(description="the chip gives a start pulse at START")
    intr: bool = Field(description="INTR")
    target_reached: bool = Field(description="TARGET_REACHED")
    step: bool = Field(description="STPOUT at rest")
    direction: bool = Field(description="DIROUT")
    standby: bool = Field(description="STDBY_CLK while it tells standby; false while it does not")
    clock_out_hz: float | None = Field(
        description="STDBY_CLK while it gives a clock: chopSync's or the chip's own; null while it does not"
    )


class DcStepState(DeferredModel):
    """dcStep, as it is seen at the pins MP1 (STEP_READY) and MP2 (enable)."""

    enabled: bool = Field(description="it works at this speed")
    step_ready: bool = Field(description="the motor has followed")
    waited_s: float = Field(description="how long the ramp has waited for the motor until now")


class StepOutputState(DeferredModel):
    """The step output since power-on."""

    steps_sent: int = Field(description="step pulses that left the chip")
    steps_merged: int = Field(description="steps whose pulse merged with the one before: the driver missed them")
    steps_held: int = Field(description="steps that wait for the direction's setup time or the pulse before")
    direction_changes: int
    pulse_clocks: int
    microsteps_256: int = Field(description="microsteps sent, in 1/256 full step")


class RampState(DeferredModel):
    """The ramp generator, finer than its registers."""

    kind: Literal["rest", "ramp", "to standstill", "stop", "freeze", "step input"]
    velocity_pps: float
    acceleration_pps2: float
    position: float = Field(description="XACTUAL with the fraction of a step")
    starts: int = Field(description="start signals so far")
    frozen: bool
    standby: bool
    clocks_gated: bool


class SpiOutputState(DeferredModel):
    """What the SPI output sends for the currents of now. The phases of absolute values are at STPOUT and DIROUT."""

    form: str = Field(description="the kind of driver or DAC that spi_output_format names")
    datagrams: list[str] = Field(description="as bits, the first sent first: of two those of A and of B")


class DriverBehindState(DeferredModel):
    """A driver with registers of its own behind the chip, as it is now."""

    kind: Literal["tmc2130", "tmc2660"]
    follows: Literal["steps", "currents"] = Field(description="what it is set up for: STEP and DIR, or coil currents")
    bridges: str = Field(description='"regulated" or "open"')
    current_scale: int = Field(description="CS in use, 0..31")
    load: int = Field(description="StallGuard2 value, 0..1023")
    flags: list[str] = Field(description="of its status, those that are set: SG, OT, OTPW, S2GA, S2GB, OLA, OLB, STST")


class Tmc4361State(EmulatedState):
    """Everything that GET .../emulator answers for a TMC4361."""

    model: Literal["tmc4361"] = "tmc4361"
    clock_hz: float
    motor: FeedbackMotor
    load_torque_nm: float
    blocked: bool
    friction: float = Field(description="friction on top of the motor's own [N m]")
    inertia: float = Field(description="of the load [kg m^2]")
    supply_v: float = Field(description="motor supply [V]")
    stage: StageState
    switches: SwitchesState
    pins: PinsState
    encoder: EncoderState
    encoder_output: EncoderOutputState
    pwm: PwmState | None
    ramp: RampState
    dcstep: DcStepState
    step_output: StepOutputState
    spi_output: SpiOutputState | None = Field(default=None, description="null: nothing is sent by itself")
    driver: DriverBehindState | None = Field(
        default=None, description="null: the chip's currents are wired to the motor"
    )
    driver_words: dict[str, int] = Field(description="what cover datagrams have written into the motor driver")
    faults: ChipFaultsState
    truth: TruthState
