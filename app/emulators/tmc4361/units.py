"""From register words to pulses and seconds of the second that the chip believes in: DS-TMC4361 8.2.3.

Unsigned words of 22+2, 23+8 and 24+0 bits, or with `direct_acc_val_en` and `direct_bow_val_en` changes a clock. How
many of their 24 bits may be used there the documents tell differently (65 535, 2^20); the 24 of DS-TMC4361 are taken.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from . import layout as c
from .compiled import compiled, inlined
from .layout import Cells, Floats


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
    general = r[c.GENERAL_CONF]
    clock = max(float(r[c.CLK_FREQ] & 0x1FFFFFF), 1.0)
    f[c.DT] = c.TICK_CLOCKS / clock
    positioning = s[c.ACT_RAMPMODE] & 4 != 0
    vmax = signed(s[c.ACT_VMAX]) / 256.0
    f[c.VMAX] = abs(vmax) if positioning else vmax
    f[c.VSTART] = (r[c.R_VSTART] & 0x7FFFFFFF) / 256.0
    f[c.VSTOP] = (r[c.R_VSTOP] & 0x7FFFFFFF) / 256.0
    if positioning and vmax != 0.0:
        f[c.VSTOP] = min(f[c.VSTOP], f[c.VMAX])
    f[c.VBREAK] = (r[c.R_VBREAK] & 0x7FFFFFFF) / 256.0
    acceleration = clock * clock / 2.0**37 if general & 2 else 0.25
    for n in range(4):  # AMAX, DMAX, ASTART, DFINAL
        f[c.AMAX + n] = max(r[c.R_AMAX + n] & 0xFFFFFF, 1) * acceleration
    f[c.AMAX + 2] = (r[c.R_AMAX + 2] & 0xFFFFFF) * acceleration  # an S-ramp may begin with 0,
    if f[c.VBREAK] > 0.0 and s[c.ACT_RAMPMODE] & 3 == 1:
        f[c.AMAX + 2] = max(f[c.AMAX + 2], acceleration)
    elif s[c.ACT_RAMPMODE] & 3 == 2:
        f[c.AMAX + 3] = (r[c.R_AMAX + 3] & 0xFFFFFF) * acceleration  # and end with it
    f[c.DSTOP] = (r[c.R_DSTOP] & 0xFFFFFF) * acceleration
    bow = (clock / 2.0**17) ** 3 / 4.0 if general & 4 else 1.0
    for n in range(4):
        f[c.BOW1 + n] = max(r[c.R_BOW1 + n] & 0xFFFFFF, 1) * bow
    f[c.DFREEZE] = (r[c.FREEZE] & 0xFFFFFF) * clock * clock / 2.0**37
    f[c.GEAR] = signed(s[c.ACT_GEAR]) / 2.0**24
    f[c.REV_SURPLUS] = r[c.CIRCULAR_DEC] / 2.0**31
