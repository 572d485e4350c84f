"""Which registers are configuration, and in which order they are safe to write."""

from __future__ import annotations

from ..rules import ProfileRules
from .expected import expected
from .physical import physical

RULES = ProfileRules(
    state=frozenset(
        {"x_target", "x_actual", "v_target", "v_actual", "cover_datagram"}
        | {"X_TARGET", "X_ACTUAL", "V_TARGET", "V_ACTUAL", "USTEP_COUNT_4210", "ustep_count_429"}
    ),
    # RAM first: while it is noise, a datagram to the driver chain may never end (DS-TMC428 chapter 11). The mode
    # before the dividers: a new pulse_div in another than RAMP_MODE may force a microstep (DS-TMC428 8.14).
    order=(
        *("driver chain RAM", "microstep table RAM", "step/dir", "global", "driver chain", "current", "motion"),
        *("switches", "position compare"),
    ),
    target="x_target",
    physical=physical,
    expected=expected,
)
