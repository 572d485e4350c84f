"""The motion that a command makes of ramp registers: the exact ramp, tick by tick."""

from __future__ import annotations

from ...calc.ramps.ticked import RampParameters
from ...calc.units.tmc428 import MAX_DIVIDER, pulse_rate_hz
from ...devices.tmc428.axis_roles import SOFT_MODE
from ...devices.tmc428.prediction import Origin, TickedPrediction
from ...devices.tmc428.ramp_parameters import P_MUL_FIRST, distance
from ..rules import MotionStart, Settings, known

RAMP = ("v_min", "v_max", "a_max", "pmul", "pdiv", "pulse_div", "ramp_div")
MODES = ("rm", "RAMP_MODE")
"""The ramp mode as one data sheet calls it, and the other."""


def expected(held: Settings, start: MotionStart, target: int | None, velocity: int) -> TickedPrediction:
    """The motion from `start` to `target` [microsteps], or to `velocity`. Raises ValueError."""
    found = known(held, start.axis, RAMP)
    pulse_div, ramp_div, pdiv = (min(found[name], MAX_DIVIDER) for name in ("pulse_div", "ramp_div", "pdiv"))
    soft = any(held.field(name, start.axis) == SOFT_MODE for name in MODES)
    if found["a_max"] == 0 or (target is not None and found["v_max"] == 0):
        raise ValueError("a_max or v_max was 0, with which nothing moves")
    parameters = RampParameters(
        v_min=found["v_min"],
        v_max=found["v_max"],
        a_max=found["a_max"],
        ramp_div=ramp_div,
        pulse_div=pulse_div,
        pmul=found["pmul"] % P_MUL_FIRST,
        pdiv=pdiv,
        ramp_mode="velocity" if target is None else "soft" if soft else "ramp",
        clock_hz=held.clock_hz,
        v_target=velocity if target is None else None,
    )
    return TickedPrediction(
        Origin(
            axis=start.axis,
            started_at_s=start.at_s,
            position=start.position,
            distance=0 if target is None else distance(target, start.position),
            velocity=round(start.velocity_pps / pulse_rate_hz(1, pulse_div, held.clock_hz)),
            parameters=parameters,
        )
    )
