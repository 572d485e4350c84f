"""What an emulated PD42-1241 tells about itself, and its plant: motor, load, stage and what is at its plugs."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...deferred import DeferredModel
from ...registers.names import ModuleName
from ..core.base import EmulatedState
from ..drive.documents import MotorState, StageState, TruthState
from ..wire_documents import WireFaultsState


class SwitchState(DeferredModel):
    active: bool = Field(description="pressed: polarity and swapping by axis parameters do not enter")
    forced: bool | None = Field(description="null while the switch follows the stage")


class SwitchesState(DeferredModel):
    left: SwitchState
    right: SwitchState
    home: SwitchState


class EncoderState(DeferredModel):
    absolute: int = Field(description="place of the built-in encoder in its turn, 0..1023")
    counts: int = Field(description="built-in encoder, since the start")
    external_counts: int = Field(description="external encoder, since the start: four a line")
    slip_fullsteps: float = Field(description="how far the built-in encoder's magnet has slipped in all")
    external_slip_fullsteps: float
    eccentricity_deg: float = Field(description="once-a-turn error of the built-in encoder [deg of the shaft]")


class InputsState(DeferredModel):
    in0: bool = Field(description="home switch")
    in1: bool
    in2: bool
    in3: bool = Field(description="the analog input as a digital one")
    analog: int = Field(description="ADC counts")
    outputs: list[int] = Field(description="what SIO has set")


class FaultsState(WireFaultsState):
    undervoltage: bool


class ApplicationState(DeferredModel):
    """The program in the module, and the registers of its interpreter."""

    status: Literal["stopped", "runs", "steps"]
    counter: int = Field(description="command that would come next")
    downloading: bool
    commands: int = Field(description="commands in program memory")
    accumulator: int
    x: int
    flags: list[str] = Field(description="flags that are set")
    stack: list[int] = Field(description="addresses that subroutines return to, the innermost last")
    waits: bool = Field(description="a WAIT is not met yet")
    interrupted: bool = Field(description="an interrupt is being served")
    error: int = Field(description="status of the latest command of a program that was refused; 0 for none")


class SearchState(DeferredModel):
    mode: int = Field(description="axis parameter 193")
    phase: str = Field(description="what the reference search does; empty while none runs")


class TmclState(EmulatedState):
    """Everything that GET .../emulator answers for a PD42-1241."""

    model: ModuleName
    address: int = Field(description="serial address now")
    baud: int = Field(description="baud rate in force: a change waits for the next power-on")
    motor: MotorState
    rigid: bool = Field(description="no physics: the shaft follows the field exactly")
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
