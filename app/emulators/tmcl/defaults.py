"""What axis parameters are after power-on, where the register table names no value.

The manual's table is lost and no sister's fits this motor, so these are ours: a motor that turns one revolution a
second at its rated current, with everything optional switched off.
"""

from __future__ import annotations

from ...registers.model import Space, to_signed
from ...registers.tmcl.pd42 import PD42

_OURS = {
    4: 51_200,
    5: 51_200,
    6: 128,  # 2.1 A peak, 1.5 A RMS: the rating of the default motor
    7: 8,
    15: 51_200,
    17: 51_200,
    18: 51_200,
    19: 0,
    20: 10,
    21: 0,
    23: 0,
    31: 7,
    32: 0,
    33: 0,
    160: 0,
    162: 2,
    163: 0,
    164: 0,
    165: 3,
    166: 5,
    167: 5,
    168: 0,
    169: 0,
    170: 0,
    171: 0,
    173: 0,
    174: 0,
    178: 0,
    182: 0,
    185: 0,
    186: 0,
    188: 128,
    191: 0,
    193: 1,
    194: 51_200,
    195: 5_120,
    214: 200,
    217: 4_000,
}

DEFAULTS: dict[int, int] = {
    row.address: to_signed(row.reset, 32) if row.reset is not None else _OURS.get(row.address, 0)
    for row in PD42
    if row.space is Space.AXIS
}
"""By number, in pps where the parameter is a speed."""
