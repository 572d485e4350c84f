"""What an emulator tells about itself and what is at its pins."""

from __future__ import annotations

from pydantic import Field

from ...deferred import DeferredModel
from ...registers.names import PmulName
from ..core.base import EmulatedState
from ..drive.documents import ChipFaultsState, MotorState, TruthState
from .options import ChipSelects, VActualWritable


class SwitchState(DeferredModel):
    active: bool
    forced: bool | None = Field(description="null while the switch follows the stage")


class Switches(DeferredModel):
    left: SwitchState
    right: SwitchState
    reference: SwitchState


class StageState(DeferredModel):
    """Where the switches stand [full steps]."""

    left_at_fullsteps: float
    right_at_fullsteps: float
    ref_from_fullsteps: float
    ref_to_fullsteps: float


class AxisState(DeferredModel):
    axis: int
    position_fullsteps: float = Field(description="where the carriage really is [full steps]")
    stage: StageState
    switches: Switches


class Inputs(DeferredModel):
    gp_in: bool = Field(description="TMC4210: general purpose input")


class ChainBit(DeferredModel):
    """One bit of a driver's part of the datagram."""

    signal: str
    value: int


class DriverLoadState(DeferredModel):
    """What acts on the motor of one driver."""

    load_torque_nm: float = Field(description="constant, like a weight: a positive one pulls to negative positions")
    friction: float = Field(description="friction on top of the motor's own [N m]")
    blocked: bool
    supply_v: float = Field(description="motor supply [V]")


class DriverState(DeferredModel):
    """What one driver got with the last datagram, and the coils behind it."""

    driver: int
    bits: list[ChainBit]
    dac_a: int
    dac_b: int
    ph_a: int
    ph_b: int
    fd_a: int
    fd_b: int
    status: int = Field(description="12 status bits that the driver reports, of one without a motor of its own")
    selected: bool = Field(default=True, description="the chip selects are wired as csCommonIndividual says")
    motor: MotorState | None = Field(
        default=None, description="of a driver with a motor: its plug, temperature, shorts"
    )
    truth: TruthState | None = Field(default=None, description="how that motor and its shaft really are")
    load: DriverLoadState | None = Field(default=None, description="what acts on that motor and its driver")


class ChainState(DeferredModel):
    """The driver chain of a TMC428 or TMC429."""

    datagrams_sent: int
    busy: bool
    endless: bool = Field(description="no NxM bit in the RAM: the datagram never ends (DS-TMC428 11)")
    duration_us: float | None = Field(description="what one datagram takes now; null if endless")
    last_bits: str = Field(description="the last datagram, first bit first")
    covered: bool
    drivers: list[DriverState]


class StepDirState(DeferredModel):
    """The step/direction output of one motor."""

    enabled: bool
    steps_sent: int = Field(description="step pulses that left the chip")
    steps_merged: int = Field(description="steps whose pulse merged with the one before: the driver missed them")
    step_level: int
    dir_level: int
    pulse_clocks: int


class EmulatorState(EmulatedState):
    model: PmulName
    clock_hz: float
    wiring: str
    chip_selects: ChipSelects = Field(description="how the drivers' chip selects are wired")
    v_actual_writable: VActualWritable = Field(description="where a write to V_ACTUAL counts: see the link's option")
    axes: list[AxisState]
    inputs: Inputs
    faults: ChipFaultsState
    powered_down: bool
    driver_chain: ChainState | None
    step_dir: StepDirState | None = Field(description="of motor 1; null: the chip has no such output")
    step_dirs: list[StepDirState] = Field(description="of each motor")
