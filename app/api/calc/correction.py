"""The calculator that corrects a motor's angle error by its microstep table."""

from __future__ import annotations

from ...calc.microsteps.angle_correction import TooUneven, corrected_for, motor_of, rms
from ...calc.microsteps.angle_error import Harmonic
from ...calc.microsteps.mslut import POWER_ON, decode
from ...calc.microsteps.table_correction import table_for
from ...errors import UsageError
from .correction_schemas import MicrostepCorrection, MicrostepCorrectionResult, ShapedTable


def microstep_correction(body: MicrostepCorrection) -> MicrostepCorrectionResult:
    """Raises UsageError for a motor whose rotor would turn back while its field goes on."""
    motor = motor_of(Harmonic(each.order, each.sine_deg, each.cosine_deg, 0.0) for each in body.harmonics)
    try:
        if body.table == "ram64":
            found = table_for(motor)
            shaped = list(found.shaped)
            return MicrostepCorrectionResult(
                values=list(found.values),
                left_deg=found.values_deg,
                sine_deg=found.sine_deg,
                beyond_deg=found.beyond_deg,
                shaped=ShapedTable(sigma=found.sigma, offset=found.offset, values=shaped, left_deg=found.shaped_deg),
            )
        wave = corrected_for(motor, decode(POWER_ON))
    except TooUneven as error:
        raise UsageError(f"{error}: no table makes up for harmonics as large as these") from error
    return MicrostepCorrectionResult(
        values=list(wave.wave.values),
        left_deg=rms(wave.after),
        sine_deg=rms(wave.before),
        beyond_deg=rms(wave.beyond),
        shaped=None,
    )
