"""What happens behind the ramp generator of a TMC4361: currents, motor with load, encoder, PID and closed loop.

The compiled functions for the chip's clockwork are in `kernel`; `FeedbackUnit` is the front door for Python.
"""

from __future__ import annotations

from app.emulators.tmc4361.feedback.options import FeedbackOptions, ShaftEncoder
from app.emulators.tmc4361.feedback.state import EncoderPatch, FeedbackPatch, FeedbackState
from app.emulators.tmc4361.feedback.unit import FeedbackUnit

__all__ = ["EncoderPatch", "FeedbackOptions", "FeedbackPatch", "FeedbackState", "FeedbackUnit", "ShaftEncoder"]
