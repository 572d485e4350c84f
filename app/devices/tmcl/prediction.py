"""The ramp expected of a module: SixPoint to a target where it has that, else a trapezoid; a trapezoid to a speed.

A module on a wire has no clock that anybody could read. A motion is taken to start half a round trip
before the answer to its command was there, which on a quiet line is some 0.1 ms beside the truth.
"""

from __future__ import annotations

from collections.abc import Mapping

from ...calc.ramps.sixpoint import SixPoint
from .roles import RegisterRoles

RAMP_WAIT_S = 512 / 16e6
"""Unit of the ramp wait time, AP 21 (5160: TZEROWAIT) [s]."""


def ramp_of(
    roles: RegisterRoles, known: Mapping[int, int], speed_unit: float, acceleration_unit: float
) -> SixPoint | None:
    """The ramp of axis parameters as last seen, by number; None where some were never seen, or nothing would move."""
    if any(row.address not in known for row in roles.ramp):
        return None
    v_max = known[roles.max_speed.address] * speed_unit
    a_max = known[roles.max_acceleration.address] * acceleration_unit
    try:
        if roles.v1 in roles.absent:
            v_min = known[roles.min_speed.address] * speed_unit
            return SixPoint(v_max, a_max, d_max=a_max, v_start=v_min, v_stop=v_min)
        speed = {row.address: known[row.address] * speed_unit for row in roles.ramp}
        rate = {row.address: known[row.address] * acceleration_unit for row in roles.ramp}
        return SixPoint(
            v_max,
            a_max,
            d_max=rate[roles.max_deceleration.address],
            v_start=speed[roles.vstart.address],
            a1=rate[roles.a1.address],
            v1=speed[roles.v1.address],
            d1=rate[roles.d1.address],
            v_stop=speed[roles.vstop.address],
            t_zero_wait_s=known.get(roles.ramp_wait.address, 0) * RAMP_WAIT_S,
        )
    except ValueError:
        return None
