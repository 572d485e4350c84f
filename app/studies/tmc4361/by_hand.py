"""What of a TMC4361 is tuned by hand beside speed, acceleration and jerk: its ends, and the gains of its loop."""

from __future__ import annotations

from ..field_settings import Place
from ..scored_move.places import HandPlace

BY_HAND = tuple(
    HandPlace(name, Place(name))
    for name in ("VSTART", "VSTOP", "DMAX", "BOW2", "BOW3", "BOW4", "PID_P", "PID_I", "PID_D", "PID_TOLERANCE")
)
