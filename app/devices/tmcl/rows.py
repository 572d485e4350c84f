"""Rows of the parameter table that the driver itself needs, by what they are."""

from __future__ import annotations

from ...registers.model import Register, Space
from ...registers.tmcl.commands import EXTENDED_ERRORS
from ...registers.tmcl.pd42 import PD42


def axis_parameter(number: int) -> Register:
    """The row of an axis parameter. Raises KeyError."""
    row = PD42.at(number, Space.AXIS)
    if row is None:
        raise KeyError(f"AP {number}")
    return row


def coordinate(number: int) -> Register | None:
    """The row of a coordinate; None where there is none of that number."""
    return PD42.at(number, Space.COORDINATE)


TARGET_POSITION = axis_parameter(0)
ACTUAL_POSITION = axis_parameter(1)
TARGET_SPEED = axis_parameter(2)
ACTUAL_SPEED = axis_parameter(3)
MAX_SPEED = axis_parameter(4)
MAX_ACCELERATION = axis_parameter(5)
MAX_CURRENT = axis_parameter(6)
POSITION_REACHED = axis_parameter(8)
HOME_SWITCH = axis_parameter(9)
RIGHT_SWITCH = axis_parameter(10)
LEFT_SWITCH = axis_parameter(11)
RIGHT_DISABLED = axis_parameter(12)
LEFT_DISABLED = axis_parameter(13)
A1 = axis_parameter(15)
V1 = axis_parameter(16)
MAX_DECELERATION = axis_parameter(17)
D1 = axis_parameter(18)
VSTART = axis_parameter(19)
VSTOP = axis_parameter(20)
RAMP_WAIT = axis_parameter(21)
RIGHT_INVERTED = axis_parameter(24)
LEFT_INVERTED = axis_parameter(25)
MEASURED_SPEED = axis_parameter(29)
MICROSTEPS = axis_parameter(140)
OFF_TIME = axis_parameter(167)
CURRENT_SCALE = axis_parameter(180)
PWM_SCALE = axis_parameter(189)
SEARCH_MODE = axis_parameter(193)
SEARCH_SPEED = axis_parameter(194)
SWITCH_SPEED = axis_parameter(195)
SWITCH_DISTANCE = axis_parameter(196)
LAST_REFERENCE = axis_parameter(197)
FULL_STEPS = axis_parameter(202)
LOAD = axis_parameter(206)
EXTENDED_ERROR_FLAGS = axis_parameter(EXTENDED_ERRORS)
DRIVER_FLAGS = axis_parameter(208)
ENCODER = axis_parameter(209)
MAX_DEVIATION = axis_parameter(212)
ABSOLUTE_ENCODER = axis_parameter(215)
EXTERNAL_ENCODER = axis_parameter(216)
EXTERNAL_RESOLUTION = axis_parameter(217)
EXTERNAL_MAX_DEVIATION = axis_parameter(218)
REVERSE_SHAFT = axis_parameter(251)
STEP_DIRECTION = axis_parameter(254)
UNIT_MODE = axis_parameter(255)

INSTEAD = {(ACTUAL_SPEED.space, ACTUAL_SPEED.address): MEASURED_SPEED}
"""What to read in place of a row that a module's firmware has not: the speed by its encoder."""
RAMP = (MAX_SPEED, MAX_ACCELERATION, A1, V1, MAX_DECELERATION, D1, VSTART, VSTOP)
"""What decides the shape of a ramp."""
ALWAYS_FRESH = (UNIT_MODE, MICROSTEPS, ACTUAL_SPEED)
"""What the driver looks at each time that it looks in: how numbers count, and motions that somebody else began."""
REMEMBERED = (
    FULL_STEPS,
    EXTERNAL_RESOLUTION,
    *RAMP,
    RAMP_WAIT,
    STEP_DIRECTION,
    MAX_CURRENT,
    OFF_TIME,
    LEFT_DISABLED,
    RIGHT_DISABLED,
)
"""What the driver keeps in mind, and looks at again a few at a time: on a slow line each look costs others theirs."""
COUNTER = (ACTUAL_POSITION, MICROSTEPS)
"""Parameters whose write makes the position counter show another number for the same place, or count other steps."""
MOVING = (TARGET_POSITION, ACTUAL_POSITION, TARGET_SPEED, MICROSTEPS, REVERSE_SHAFT, STEP_DIRECTION)
"""Parameters whose write may set the motor in motion or stop it. The position counter is among them: in
positioning the module drives on to its target from wherever the counter says it is."""
