"""The calculators. Nothing here touches a device; plain functions, so that a long one runs in a thread."""

from __future__ import annotations

from ...errors import UsageError
from ..http.problems import problems
from ..policy import Policy, policy_of_all
from ..router import subject_router
from ..tables import mslut as mslut_tables
from ..tables.mslut_schemas import MslutDesign, MslutResult
from ..tables.schemas import ChainDesign
from . import calculators, correction
from . import ramps as ramp_calculators
from . import units as unit_calculators
from .correction_schemas import MicrostepCorrection, MicrostepCorrectionResult
from .schemas import (
    AnyMicrostepDesign,
    ChainRequest,
    MicrostepResult,
    PmulPdiv,
    PmulPdivResult,
    Ramp,
    RampInverse,
    RampInverseResult,
    RampResult,
    Units,
    UnitsResult,
)
from .sixpoint_schemas import Chopper, ChopperResult, CoilCurrent, CoilCurrentResult
from .tmc5xxx import motor as motor_calculators
from .tmc428.current_scales import current_scales
from .tmc428.current_schemas import CurrentScaling, CurrentScalingResult
from .tmc428.start_stop import StartStop, StartStopResult, start_stop
from .tmc4361 import currents, input_filters
from .tmc4361.current_schemas import DriveCurrent, DriveCurrentResult, PwmDuty, PwmDutyResult
from .tmc4361.driver_sync import driver_sync
from .tmc4361.filter_schemas import InputFilter, InputFilterResult, InputFilters
from .tmc4361.sequence import target_sequence
from .tmc4361.sequence_schemas import TargetSequence, TargetSequenceResult
from .tmc4361.serial_encoder import serial_encoder
from .tmc4361.serial_schemas import SerialEncoder, SerialEncoderResult
from .tmc4361.sync_schemas import DriverSync, DriverSyncResult
from .tmcdrivers.scale_current import ScaleCurrent, ScaleCurrentResult, scale_current

router = subject_router(prefix="/calc", tags=["calculators"], responses=problems(UsageError))


@router.post("/pmul-pdiv")
def calculate_pmul_pdiv(body: PmulPdiv) -> PmulPdivResult:
    """The pair pmul/pdiv for an acceleration, its neighbours with overshoot and settling, limits and warnings."""
    return calculators.pmul_pdiv(body)


@router.post("/ramp-inverse")
def calculate_ramp_inverse(body: RampInverse) -> RampInverseResult:
    """Register values for a wanted speed and acceleration, and what they really give."""
    return calculators.ramp_inverse(body)


@router.post("/units")
def convert_units(body: Units) -> UnitsResult:
    """Chip units and physical units of one axis, every unit of what is given."""
    return unit_calculators.units(body)


@router.post("/ramp")
def calculate_ramp(body: Ramp) -> RampResult:
    """A move over time: bit for bit as a chip makes it, a module's SixPoint ramp, or an ideal trapezoid."""
    return ramp_calculators.ramp(body)


@router.post("/coil-current")
def calculate_coil_current(body: CoilCurrent) -> CoilCurrentResult:
    """Motor current of a TMC5xxx from its settings, or the nearest settings for a wanted current, and its delays."""
    return motor_calculators.coil_current(body)


@router.post("/scale-current")
def calculate_scale_current(body: ScaleCurrent) -> ScaleCurrentResult:
    """Motor current and chopper times of a driver with one current scale, or the nearest scale for a wanted current."""
    return scale_current(body)


@router.post("/current-scales")
def calculate_current_scales(body: CurrentScaling) -> CurrentScalingResult:
    """Which of a TMC428's three current scales holds when over a move, for how long, and what it saves."""
    return current_scales(body)


@router.post("/start-stop")
def calculate_start_stop(body: StartStop) -> StartStopResult:
    """From how fast a motor may be stopped dead, v_min of a TMC428 against that, and what it does to a move's time."""
    return start_stop(body)


@router.post("/chopper")
def calculate_chopper(body: Chopper) -> ChopperResult:
    """Chopper settings of a TMC5xxx to begin with, from a motor's data; each with its reason and source."""
    return motor_calculators.chopper(body)


@router.post("/microstep-table")
def design_microstep_table(body: AnyMicrostepDesign) -> MicrostepResult | MslutResult:
    """A microstep table from a formula (or drawn by hand), as it goes to the chip, and its figures.

    For a TMC4361 a wave that cannot be encoded is answered too: with the places and reasons, and the nearest wave.
    """
    return mslut_tables.design(body) if isinstance(body, MslutDesign) else calculators.microstep_table(body)


@router.post("/microstep-correction")
def calculate_microstep_correction(body: MicrostepCorrection) -> MicrostepCorrectionResult:
    """The microstep table that makes up for a motor's angle error, and what it is expected to leave.

    Where there is an encoder, the study "microstep calibration" measures that error and does the same.
    """
    return correction.microstep_correction(body)


@router.post("/driver-chain")
def design_driver_chain(body: ChainRequest) -> ChainDesign:
    """A driver chain's RAM, datagrams and frequencies."""
    return calculators.driver_chain(body)


@router.get("/input-filter")
def list_input_filters() -> InputFilters:
    """The four input filters of a TMC4361, their pins and fields, and examples of what they do."""
    return input_filters.input_filters()


@router.post("/input-filter")
def calculate_input_filter(body: InputFilter) -> InputFilterResult:
    """What one of the filters makes of a waveform, clock by clock, and how it treats any edge and pulse."""
    return input_filters.input_filter(body)


@router.post("/target-sequence")
def calculate_target_sequence(body: TargetSequence) -> TargetSequenceResult:
    """The registers of a sequence of targets that a TMC4361 makes alone, and its whole motion."""
    return target_sequence(body)


@router.post("/serial-encoder")
def calculate_serial_encoder(body: SerialEncoder) -> SerialEncoderResult:
    """The bits of a serial encoder's answer at a TMC4361, how long it takes, and how fast the shaft may turn."""
    return serial_encoder(body)


@router.post("/drive-current")
def calculate_drive_current(body: DriveCurrent) -> DriveCurrentResult:
    """Current scale and coil current of a TMC4361 over a move: boost, drive, hold, freewheeling, their delays."""
    return currents.drive_current(body)


@router.post("/pwm-duty")
def calculate_pwm_duty(body: PwmDuty) -> PwmDutyResult:
    """Duty of a TMC4361's PWM outputs: their amplitude over speed, and both of them over the electrical turn."""
    return currents.pwm_duty(body)


@router.post("/driver-sync")
def calculate_driver_sync(body: DriverSync) -> DriverSyncResult:
    """What chopSync and dcStep of a TMC4361 come to in Hz, seconds and speeds, and what does not fit."""
    return driver_sync(body)


policy_of_all(router, Policy(lease="free", role="look", audit="silent"))
