"""Which registers are configuration, and in which order they are safe to write."""

from __future__ import annotations

from ..rules import ProfileRules
from .expected import expected
from .physical import physical

RULES = ProfileRules(
    # RAMPMODE is the last command: every move and every stop writes it. NODECONF and SLAVECONF are by which address a
    # UART reaches the chip.
    state=frozenset(
        {"XACTUAL", "XTARGET", "X_ENC", "RAMPMODE", "OTP_PROG", "FACTORY_CONF", "TEST_SEL", "NODECONF", "SLAVECONF"}
        | {"OUTPUT"}
    ),
    # A lock cannot be taken back but by a reset.
    state_fields=frozenset({"clr_once", "lock_gconf", "test_mode"}),
    # Currents before the chopper that lets them flow (CHOPCONF.toff).
    order=("current", "microsteps", "general", "ramp", "thresholds", "stealthchop", "driver", "encoder", "switches"),
    target="XTARGET",
    # In velocity mode VMAX is the speed that it turns at.
    positioning=("RAMPMODE", "", 0),
    physical=physical,
    expected=expected,
)
