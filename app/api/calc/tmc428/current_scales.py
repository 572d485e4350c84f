"""Between the shapes of current scales and the calculator behind them, app/calc/tmc428/current_scales.py."""

from __future__ import annotations

from ....calc.tmc428.current_scales import CurrentScales, scaled_ramp
from ...devices.views import calculating
from ..ramps import exact_parameters
from .current_schemas import CurrentScaling, CurrentScalingResult, CurrentSpan


def current_scales(body: CurrentScaling) -> CurrentScalingResult:
    with calculating():
        scales = CurrentScales(body.is_v0, body.is_aleat, body.is_agtat, body.a_threshold)
        found = scaled_ramp(*exact_parameters(body.parameters, body.distance), scales, body.continuous_update)
    return CurrentScalingResult(
        spans=[CurrentSpan.model_validate(span) for span in found.spans],
        motion_s=found.motion_s,
        rest_delay_s=found.rest_delay_s,
        time_s=dict(found.time_s),
        heat=found.heat,
        braking_below=found.braking_below,
        warnings=list(found.warnings),
    )
