"""Which registers are configuration, and in which order they are safe to write."""

from __future__ import annotations

from ..rules import Busy, Gates, ProfileRules
from .expected import expected
from .physical import physical

RULES = ProfileRules(
    state=frozenset(
        {"XACTUAL", "XTARGET", "ENC_POS", "RESET_CLK_GATING", "X_HOME", "ADDR_TO_ENC", "DATA_TO_ENC"}
        | {"COVER_LOW", "COVER_HIGH", *(f"X_PIPE{index}" for index in range(8))}
    ),
    # Regulation is switched by the closed loop's own procedure, which calibrates first.
    state_fields=frozenset(
        {"OPERATION_MODE", "start_home_tracking", "clr_latch_once_on_n", "cl_calibration_en", "regulation_modus"}
    ),
    # In which units accelerations count (GENERAL_CONF) and the clock before the ramp; what starts by a signal last.
    order=(
        *("general", "clock", "current", "driver", "spi output", "pwm", "step/dir", "microsteps", "ramp", "filters"),
        *("reference", "serial encoder", "encoder", "pid", "closed loop", "shadow", "events", "start"),
    ),
    target="XTARGET",
    positioning=("RAMPMODE", "OPERATION_MODE", 1),
    busy=(Busy("ENC_IN_CONF", 0, "regulation_modus", "the closed loop is on: switch it off first"),),
    gates=Gates("START_CONF", 0b1111 << 12 | 0b11111),  # pipeline_en, start_en
    physical=physical,
    expected=expected,
)
