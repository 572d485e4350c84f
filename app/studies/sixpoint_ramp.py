"""Ramps of six points: VSTART, A1 up to V1, AMAX up to VMAX, and down again by DMAX and D1; and how long they take."""

from __future__ import annotations

from collections.abc import Mapping

from ..calc.ramps.sixpoint import SixPoint, position_plan
from ..profiles.items import key_of
from ..profiles.physical import UnitContext
from ..registers.catalog import MODELS
from .ramp_settings import (
    ACCELERATION,
    DECELERATION,
    KNEE,
    KNEE_ACCELERATION,
    KNEE_DECELERATION,
    SPEED,
    LeastTime,
    Share,
)

SHARES = {
    KNEE: Share(SPEED, 0.2, 0.95),
    KNEE_ACCELERATION: Share(ACCELERATION, 1.0, 4.0),
    DECELERATION: Share(ACCELERATION, 1.0, 2.0),
    KNEE_DECELERATION: Share(KNEE_ACCELERATION, 1.0, 2.0, like=DECELERATION),
}
"""Torque falls with speed, so below V1 the acceleration is never less; friction helps to brake, above V1 and below."""


def six_point_time(v_start: str, v_stop: str) -> LeastTime:
    """The prediction for a family whose registers of these names hold the speeds that a move begins and ends with."""

    def time_s(units: UnitContext, axis: int, distance: float, setting: Mapping[str, float]) -> float:
        stop_pps = _speed(units, axis, v_stop)
        ramp = SixPoint(
            v_max=setting[SPEED],
            a_max=setting[ACCELERATION],
            d_max=setting[DECELERATION],
            v_start=min(_speed(units, axis, v_start), stop_pps),
            a1=setting[KNEE_ACCELERATION],
            v1=setting[KNEE],
            d1=setting[KNEE_DECELERATION],
            v_stop=stop_pps,
        )
        return position_plan(ramp, distance).duration_s

    return time_s


def _speed(units: UnitContext, axis: int, name: str) -> float:
    """What a register of the axis holds [pps]; 0 where that is not known."""
    found = MODELS[units.model].table.find(name, axis)
    word = None if found is None else units.words.get(key_of(found[0]))
    if found is None or word is None:
        return 0.0
    physical = units.physical(found[0], found[0].decode(word))
    return 0.0 if physical is None else physical.value
