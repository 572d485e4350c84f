"""The drivers alone, in what their calculations differ."""

from __future__ import annotations

from ..tmc5xxx.chips import Chip, Sensing, Sheet

CHIPS = {
    "tmc2209": Chip(
        Sensing((0.325, 0.18), 0.02, 2.0, "DS-TMC2209 8"),
        Sheet("tuned", 8, "DS-TMC2209 7", "DS-TMC2209 6"),
        one_axis=True,
        dcstep=False,
        reference=True,
    ),
}
