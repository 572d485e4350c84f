"""The ramp expected of a module: SixPoint to a target, a trapezoid to a speed.

A module on a wire has no clock that anybody could read. A motion is taken to start half a round trip
before the answer to its command was there, which on a quiet line is some 0.1 ms beside the truth.
"""

from __future__ import annotations

from collections.abc import Mapping

from ...calc.ramps.sixpoint import SixPoint
from . import rows

RAMP_WAIT_S = 512 / 16e6
"""Unit of the ramp wait time, AP 21 (5160: TZEROWAIT) [s]."""


def sixpoint(known: Mapping[int, int], speed_unit: float, acceleration_unit: float) -> SixPoint | None:
    """The ramp of axis parameters as last seen, by number; None where some were never seen, or nothing would move."""
    if any(row.address not in known for row in rows.RAMP):
        return None
    speed = {row.address: known[row.address] * speed_unit for row in rows.RAMP}
    rate = {row.address: known[row.address] * acceleration_unit for row in rows.RAMP}
    try:
        return SixPoint(
            v_max=speed[rows.MAX_SPEED.address],
            a_max=rate[rows.MAX_ACCELERATION.address],
            d_max=rate[rows.MAX_DECELERATION.address],
            v_start=speed[rows.VSTART.address],
            a1=rate[rows.A1.address],
            v1=speed[rows.V1.address],
            d1=rate[rows.D1.address],
            v_stop=speed[rows.VSTOP.address],
            t_zero_wait_s=known.get(rows.RAMP_WAIT.address, 0) * RAMP_WAIT_S,
        )
    except ValueError:
        return None
