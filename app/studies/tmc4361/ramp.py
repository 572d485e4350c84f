"""The registers of a TMC4361 that make a ramp of one speed and one acceleration (DS-TMC4361 6.3).

With S-ramps of one jerk too: all four bows alike. Or of two: BOW1 and BOW4 begin and end a move, at rest; BOW2 and BOW3
are next to the greatest speed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ...calc.ramps.sramp import position_plan
from ...devices.tmc4361 import roles
from ...devices.tmc4361.ramp_parameters import RampParameters
from ...profiles.items import key_of
from ...profiles.physical import UnitContext
from ..ramp_settings import ACCELERATION, JERK, REST_JERK, SPEED, TOP_JERK, RampRegisters

S_SHAPED = 2
_MOVING = {SPEED: ("VMAX",), ACCELERATION: ("AMAX", "DMAX")}
_SHAPED = ("RAMP_PROFILE", S_SHAPED)


def _time_s(units: UnitContext, axis: int, distance: float, setting: Mapping[str, float]) -> float:
    del axis  # it has one
    words = {row.address: units.words.get(key_of(row)) or 0 for row in roles.RAMP}
    acceleration, rest, top = setting[ACCELERATION], setting[REST_JERK], setting[TOP_JERK]
    held = RampParameters(words).s_ramp(setting[SPEED])
    ramp = replace(held, amax=acceleration, dmax=acceleration, bow1=rest, bow2=top, bow3=top, bow4=rest)
    return position_plan(ramp, distance).duration_s


RAMP = RampRegisters({**_MOVING, JERK: ("BOW1", "BOW2", "BOW3", "BOW4")}, only={JERK: _SHAPED})
BOWS = RampRegisters(
    {**_MOVING, REST_JERK: ("BOW1", "BOW4"), TOP_JERK: ("BOW2", "BOW3")},
    only={REST_JERK: _SHAPED, TOP_JERK: _SHAPED},
    time_s=_time_s,
)
