"""From register words to pulses and seconds of the second that the chip believes in: DS-TMC4361 8.2.3.

Unsigned words of 22+2, 23+8 and 24+0 bits, or with `direct_acc_val_en` and `direct_bow_val_en` changes a clock. How
many of their 24 bits may be used there the documents tell differently (65 535, 2^20); the 24 of DS-TMC4361 are taken.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from .compiled import compiled, inlined
from .layout import (
    ACT_GEAR,
    ACT_RAMPMODE,
    ACT_VMAX,
    AMAX,
    BOW1,
    CIRCULAR_DEC,
    CLK_FREQ,
    DFREEZE,
    DSTOP,
    DT,
    FREEZE,
    GEAR,
    GENERAL_CONF,
    R_AMAX,
    R_BOW1,
    R_DSTOP,
    R_VBREAK,
    R_VSTART,
    R_VSTOP,
    REV_SURPLUS,
    TICK_CLOCKS,
    VBREAK,
    VMAX,
    VSTART,
    VSTOP,
    Cells,
    Floats,
)


@inlined
def signed(word: int) -> int:
    """A 32-bit word as a signed number."""
    return ((word + 0x80000000) & 0xFFFFFFFF) - 0x80000000


@compiled
def take_over(r: Cells, s: Cells, f: Floats) -> None:
    """Work out the ramp registers anew.

    An acceleration or bow of 0 that is needed while the motor turns is taken for the least there is: it would never
    come to an end. From rest a ramp does not begin with one (`kernel`).
    """
    general = r[GENERAL_CONF]
    clock = max(float(r[CLK_FREQ] & 0x1FFFFFF), 1.0)
    f[DT] = TICK_CLOCKS / clock
    positioning = s[ACT_RAMPMODE] & 4 != 0
    vmax = signed(s[ACT_VMAX]) / 256.0
    f[VMAX] = abs(vmax) if positioning else vmax
    f[VSTART] = (r[R_VSTART] & 0x7FFFFFFF) / 256.0
    f[VSTOP] = (r[R_VSTOP] & 0x7FFFFFFF) / 256.0
    if positioning and vmax != 0.0:
        f[VSTOP] = min(f[VSTOP], f[VMAX])
    f[VBREAK] = (r[R_VBREAK] & 0x7FFFFFFF) / 256.0
    acceleration = clock * clock / 2.0**37 if general & 2 else 0.25
    for n in range(4):  # AMAX, DMAX, ASTART, DFINAL
        f[AMAX + n] = max(r[R_AMAX + n] & 0xFFFFFF, 1) * acceleration
    f[AMAX + 2] = (r[R_AMAX + 2] & 0xFFFFFF) * acceleration  # an S-ramp may begin with 0,
    if f[VBREAK] > 0.0 and s[ACT_RAMPMODE] & 3 == 1:
        f[AMAX + 2] = max(f[AMAX + 2], acceleration)
    elif s[ACT_RAMPMODE] & 3 == 2:
        f[AMAX + 3] = (r[R_AMAX + 3] & 0xFFFFFF) * acceleration  # and end with it
    f[DSTOP] = (r[R_DSTOP] & 0xFFFFFF) * acceleration
    bow = (clock / 2.0**17) ** 3 / 4.0 if general & 4 else 1.0
    for n in range(4):
        f[BOW1 + n] = max(r[R_BOW1 + n] & 0xFFFFFF, 1) * bow
    f[DFREEZE] = (r[FREEZE] & 0xFFFFFF) * clock * clock / 2.0**37
    f[GEAR] = signed(s[ACT_GEAR]) / 2.0**24
    f[REV_SURPLUS] = r[CIRCULAR_DEC] / 2.0**31
