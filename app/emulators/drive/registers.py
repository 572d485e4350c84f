"""The TMC5160's registers as far as the drive goes: widths, signs, what they are after a reset."""

from __future__ import annotations

from typing import NamedTuple


class Row(NamedTuple):
    """A register that can be written."""

    bits: int
    signed: bool = False
    reset: int = 0


WRITABLE: dict[str, Row] = {
    "GCONF": Row(18, reset=0x8),
    "GLOBALSCALER": Row(8),
    "IHOLD_IRUN": Row(28),
    "TPOWERDOWN": Row(8, reset=0xA),
    "TPWMTHRS": Row(20),
    "TCOOLTHRS": Row(20),
    "THIGH": Row(20),
    "RAMPMODE": Row(2),
    "XACTUAL": Row(32, signed=True),
    "VSTART": Row(18),
    "A1": Row(18),
    "V1": Row(20),
    "AMAX": Row(18),
    "VMAX": Row(23),
    "DMAX": Row(18),
    "D1": Row(18),
    "VSTOP": Row(18, reset=1),
    "TZEROWAIT": Row(16),
    "XTARGET": Row(32, signed=True),
    "VDCMIN": Row(23),
    "V2": Row(20),
    "A2": Row(18),
    "D2": Row(18),
    "TVMAX": Row(16),
    "SW_MODE": Row(15),
    "VIRTUAL_STOP_L": Row(32, signed=True),
    "VIRTUAL_STOP_R": Row(32, signed=True),
    "X_COMPARE_REPEAT": Row(24),
    "SG4_THRS": Row(10),
    "ENCMODE": Row(11),
    "X_ENC": Row(32, signed=True),
    "ENC_CONST": Row(32, reset=0x10000),
    "ENC_DEVIATION": Row(20),
    "MSLUT[0]": Row(32, reset=0xAAAAB554),
    "MSLUT[1]": Row(32, reset=0x4A9554AA),
    "MSLUT[2]": Row(32, reset=0x24492929),
    "MSLUT[3]": Row(32, reset=0x10104222),
    "MSLUT[4]": Row(32, reset=0xFBFFFFFF),
    "MSLUT[5]": Row(32, reset=0xB5BB777D),
    "MSLUT[6]": Row(32, reset=0x49295556),
    "MSLUT[7]": Row(32, reset=0x00404222),
    "MSLUTSEL": Row(32, reset=0xFFFF8056),
    "MSLUTSTART": Row(24, reset=0x00F70000),
    "CHOPCONF": Row(32, reset=0x10410150),
    "COOLCONF": Row(25),
    "DCCTRL": Row(24),
    "PWMCONF": Row(32, reset=0xC40C001E),
}
"""What holds what was written. The module's DS-TMC5160 p. 32-56; MSLUT's resets from the vendor's API. V2, A2, D2,
TVMAX, virtual stops, X_COMPARE_REPEAT, StallGuard4, IRUNDELAY and the upper bits of accelerations are the TMC5240's
(API): a chip that has none of them never writes there."""

CLEARED_BY_ONES = {"GSTAT": 0x7, "RAMP_STAT": 0x10CC, "ENC_STATUS": 0x3}
"""Registers whose latching bits go when a 1 is written to them."""

READ_ONLY = frozenset(
    {
        "VACTUAL",
        "AACTUAL",
        "SG4_RESULT",
        "SG4_IND",
        "TSTEP",
        "XLATCH",
        "ENC_LATCH",
        "MSCNT",
        "MSCURACT",
        "DRV_STATUS",
        "PWM_SCALE",
        "PWM_AUTO",
        "LOST_STEPS",
    }
)

ALIASES = {"GLOBAL_SCALER": "GLOBALSCALER"}
"""Other names for the same."""

MAX_VMAX = (1 << 23) - 512
"""VMAX above is taken for this."""
