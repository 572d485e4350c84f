"""What the emulated drivers keep without acting on it, and why."""

from __future__ import annotations

from dataclasses import replace

from ..model import Register
from ..tmc5xxx import behaviour as inside

NO_REFERENCE = "the bench sets the emulated full scale, as with resistors"
ONE_FILTER = "the emulated steps need no filter"
ALWAYS_ITS = "the emulated PDN_UART is the UART's alone"

DIAGNOSTICS = ("diag0_error", "diag0_otpw", "diag0_stall", "diag1_stall")
"""What the emulated pins DIAG0 and DIAG1 show."""
FIELDS = {
    "GCONF": {
        **dict.fromkeys(DIAGNOSTICS, ""),
        "I_scale_analog": "",
        "internal_Rsense": NO_REFERENCE,
        "pdn_disable": ALWAYS_ITS,
        **dict.fromkeys(("multistep_filt", "small_hysteresis"), ONE_FILTER),
        "direct_mode": "",
        "test_mode": inside.FACTORY,
    },
    "OTP_PROG": {"OTPMAGIC": ""},
    "CHOPCONF": {"dedge": "the bench tells how many steps come in, whatever their edges"},
    "XDIRECT": dict.fromkeys(("COIL_A", "COIL_B"), ""),
    "DIRECT_MODE": dict.fromkeys(("DIRECT_COIL_A", "DIRECT_COIL_B"), ""),
    "FACTORY_CONF": {"FCLKTRIM": inside.OWN_CLOCK, "OTTRIM": "the emulated limits of temperature do not move"},
}


def with_behaviour(row: Register) -> Register:
    """`row`, told of what the emulated driver does not do; what the TMC5xxx's driver does not, this one does not."""
    row = inside.with_behaviour(row)
    reasons = FIELDS.get(row.name, {})
    return replace(
        row,
        behaviour="" if reasons else row.behaviour,
        fields=tuple(
            replace(part, behaviour=reasons[part.name]) if part.name in reasons else part for part in row.fields
        ),
    )
