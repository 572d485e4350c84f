"""What an emulated driver tells about itself, and its plant: motor, load, stage and what is at its pins."""

from __future__ import annotations

from pydantic import Field

from ...deferred import DeferredModel
from ..core.base import EmulatedState
from ..drive.documents import ChipFaultsState, MotorState, TruthState
from .options import DriverModel


class DriverUartState(DeferredModel):
    """The single-wire interface."""

    node: int = Field(description="address, by MS1 and MS2")
    reply_delay_bits: int = Field(description="bit times before an answer (SENDDELAY)")
    writes: int = Field(description="IFCNT: accepted writes, modulo 256")


class DriverPinsState(DeferredModel):
    """Levels: true is high."""

    enn: bool
    diag: bool = Field(description="DIAG, or DIAG0 or DIAG1, is active: an error of the driver, or a stall")
    index: bool | None = Field(default=None, description="INDEX is active; null: the chip has no such pin")
    vref_v: float | None = Field(default=None, description="voltage at VREF [V]; null: the chip has no such pin")
    step_hz: float = Field(description="steps a second that come in at STEP, negative with DIR high")
    steps: int = Field(
        default=0, description="steps taken from a wired controller since power-on, those back taken off"
    )


class TmcDriverState(EmulatedState):
    """Everything that GET .../emulator answers for a driver."""

    model: DriverModel
    clock_hz: float
    rigid: bool = Field(description="no physics: the shaft follows the field exactly")
    supply_v: float
    motor: MotorState
    load_torque_nm: float
    blocked: bool
    friction: float = Field(description="friction on top of the motor's own [N m]")
    truth: TruthState
    uart: DriverUartState | None = Field(description="null: it has none")
    pins: DriverPinsState
    faults: ChipFaultsState
