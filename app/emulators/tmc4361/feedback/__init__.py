"""What happens behind the ramp generator of a TMC4361: currents, motor with load, encoder, PID and closed loop.

The compiled functions for the chip's simulation kernel are in `kernel`; `FeedbackUnit` is the front door for Python.
"""

from __future__ import annotations

from .options import DriverBehind, FeedbackOptions, ShaftEncoder
from .state import EncoderPatch, FeedbackPatch, FeedbackState
from .unit import FeedbackUnit

__all__ = [
    "DriverBehind",
    "EncoderPatch",
    "FeedbackOptions",
    "FeedbackPatch",
    "FeedbackState",
    "FeedbackUnit",
    "ShaftEncoder",
]
