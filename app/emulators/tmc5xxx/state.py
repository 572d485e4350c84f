"""What an emulated TMC5xxx tells about itself, and its plant: motors, loads, stages and what is at its pins."""

from __future__ import annotations

from pydantic import Field

from ...deferred import DeferredModel
from ..core.base import EmulatedState
from ..drive.documents import ChipFaultsState, MotorState, StageState, TruthState
from .options import Tmc5xxxModel


class SwitchState(DeferredModel):
    active: bool = Field(description="the pin is high: polarity and swapping by SW_MODE do not enter")
    forced: bool | None = Field(description="null while the switch follows the stage")


class SwitchesState(DeferredModel):
    left: SwitchState
    right: SwitchState


class EncoderState(DeferredModel):
    counts: int = Field(description="since the start, not wrapped: what no register tells")
    counts_per_turn: int
    connected: bool = Field(description="false while GCONF gives the encoder's pins to something else")
    n_level: bool = Field(description="level of the N line")
    slip_fullsteps: float = Field(description="how far it has slipped on the shaft in all")


class PositionCompareState(DeferredModel):
    """The comparison of XACTUAL with X_COMPARE."""

    x_compare: int
    output: bool = Field(description="level at the pin, where GCONF lets it out: high while both are equal")
    enabled: bool = Field(description="whether the pin shows it (dual chips: poscmp_enable)")
    passed: int = Field(description="how often XACTUAL has come upon X_COMPARE since power-on")


class AxisState(DeferredModel):
    axis: int
    motor: MotorState
    load_torque_nm: float
    blocked: bool
    friction: float = Field(description="friction on top of the motor's own [N m]")
    stage: StageState
    switches: SwitchesState
    encoder: EncoderState | None = Field(description="null: the chip has none")
    truth: TruthState


class UartState(DeferredModel):
    """The single-wire interface."""

    node: int | None = Field(description="address now: NODECONF and the NEXTADDR pin; null: a TMC5062 has none")
    reply_delay_bits: int = Field(description="bit times before an answer (SENDDELAY)")
    writes: int = Field(description="IFCNT: accepted writes, modulo 256")


class PinsState(DeferredModel):
    """Levels: true is high."""

    drv_enn: bool
    nextaddr: bool
    interrupt: bool = Field(description="the interrupt output is active")


class Tmc5xxxState(EmulatedState):
    """Everything that GET .../emulator answers for a TMC5xxx."""

    model: Tmc5xxxModel
    clock_hz: float
    rigid: bool = Field(description="no physics: the shafts follow the fields exactly")
    supply_v: float
    axes: list[AxisState]
    position_compare: PositionCompareState = Field(description="of motor 1")
    uart: UartState | None
    pins: PinsState
    faults: ChipFaultsState
