"""What of a TMC4361 no search tries: how steps are counted, and the ramp's mode (DS-TMC4361 6)."""

from __future__ import annotations

UNSEARCHED = frozenset({"STEP_CONF", "RAMPMODE", "SIGN_AACT"})
