"""What the feedback unit tells about motor and encoder, and what may be done to them: parts of REST documents."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Field

from ....deferred import DeferredModel
from ...drive.documents import MotorState, TruthState
from ...drive.options import FullSteps
from ...drive.plant import Short
from .options import EncoderKind


class FeedbackMotor(MotorState):
    full_scale_a: float = Field(description="peak coil current at current scale 255 [A]")
    inertia_kgm2: float = Field(description="rotor and load")


class EncoderState(DeferredModel):
    kind: EncoderKind
    counts_per_turn: int
    counts: int = Field(description="since the start, not wrapped: what no register tells")
    slip_fullsteps: float = Field(description="how far it has slipped on the shaft in all")
    zero_fullsteps: float = Field(description="mounting offset: place of the rotor at which it counts 0")
    eccentricity_deg: float = Field(description="amplitude of its once-a-turn error [deg of the shaft]")
    eccentricity_phase_deg: float
    status_bits: int = Field(description="what an absolute encoder's status bits are")
    single_turn_bits: int = Field(description="ssi, spi: bits of the place in the turn")
    multi_turn_bits: int = Field(description="ssi, spi: bits of the turns counted")
    gray: bool
    status_bit_count: int


class EncoderOutputState(DeferredModel):
    """The serial encoder output, as a listener gets it."""

    enabled: bool
    length: int = Field(description="bits of an answer")
    heard: str = Field(description="the latest answer that was clocked out, first bit first; empty: none yet")
    repeated: bool = Field(description="it was the one before again: the monoflop time had not passed")


class PwmState(DeferredModel):
    """STPOUT_PWMA and DIROUT_PWMB while pwm_out_en is set."""

    frequency_hz: float = Field(description="fCLK / PWM_FREQ")
    duty_a: float
    duty_b: float


class FeedbackState(DeferredModel):
    motor: FeedbackMotor
    load_torque_nm: float
    blocked: bool
    friction_nm: float = Field(description="Coulomb friction on top of the motor's own [N m]")
    inertia_kgm2: float = Field(description="of the load [kg m^2]")
    supply_v: float
    encoder: EncoderState
    encoder_output: EncoderOutputState
    pwm: PwmState | None
    truth: TruthState


class _Patch(DeferredModel):
    model_config = ConfigDict(extra="forbid")


class EncoderPatch(_Patch):
    """Whatever is not given stays."""

    slip_fullsteps: FullSteps | None = Field(default=None, description="how far it has slipped on the shaft in all")
    eccentricity_deg: Annotated[float, Field(ge=0, le=10)] | None = None
    eccentricity_phase_deg: Annotated[float, Field(ge=-360, le=360)] | None = None
    zero_fullsteps: FullSteps | None = Field(default=None, description="mounts it anew on the shaft")
    status_bits: Annotated[int, Field(ge=0, le=7)] | None = None
    kind: EncoderKind | None = Field(default=None, description="another encoder on the shaft")
    lines: Annotated[int, Field(strict=True, ge=1, le=1 << 22)] | None = None
    single_turn_bits: Annotated[int, Field(strict=True, ge=2, le=24)] | None = None
    multi_turn_bits: Annotated[int, Field(strict=True, ge=0, le=24)] | None = None
    gray: bool | None = None
    status_bit_count: Annotated[int, Field(strict=True, ge=0, le=3)] | None = None
    spoil_next: Annotated[int, Field(ge=0, lt=1 << 48)] | None = Field(
        default=None, description="bits of an absolute encoder's next answer that arrive wrong"
    )


class FeedbackPatch(_Patch):
    """Whatever is not given stays."""

    load_torque_nm: Annotated[float, Field(ge=-50, le=50)] | None = None
    friction_nm: Annotated[float, Field(ge=0, le=50)] | None = None
    inertia_kgm2: Annotated[float, Field(ge=0, le=1)] | None = None
    blocked: bool | None = None
    connected: bool | None = Field(default=None, description="whether the motor is plugged in")
    supply_v: Annotated[float, Field(ge=0, le=60)] | None = None
    temperature_c: Annotated[float, Field(ge=-55, le=250)] | None = None
    short_to_ground: Short | None = None
    rotor_fullsteps: FullSteps | None = Field(default=None, description="turns the shaft by hand to there")
    encoder: EncoderPatch | None = None
