"""The drivers alone, in what their calculations differ."""

from __future__ import annotations

from ..tmc5xxx.chips import Chip, Sensing, Sheet

CHIPS = {
    # of the smaller package 1.2 A; its chopper is a TMC5130's: fields are the same
    "tmc2130": Chip(
        Sensing((0.32, 0.18), 0.02, 1.4, "KLIPPER-TMC2130; DS-TMC2130"),
        Sheet("gradient", 8, "DS-TMC5130 8", "DS-TMC5130 7"),
        one_axis=True,
        dcstep=False,
        reference=True,
    ),
    "tmc2209": Chip(
        Sensing((0.325, 0.18), 0.02, 2.0, "DS-TMC2209 8"),
        Sheet("tuned", 8, "DS-TMC2209 7", "DS-TMC2209 6"),
        one_axis=True,
        dcstep=False,
        reference=True,
    ),
    "tmc2240": Chip(
        Sensing((), 0.0, 2.1, "KLIPPER; DS-TMC2240", (11_750.0, 24_000.0, 36_000.0, 36_000.0)),
        Sheet("tuned", 8, "DS-TMC5160 8", "DS-TMC5160 7"),
        one_axis=True,
        dcstep=False,
    ),
    # no StealthChop; of the chopper the fields are a TMC5130's (inferred)
    "tmc2660": Chip(
        Sensing((0.310, 0.165), 0.0, 2.2, "KLIPPER-TMC2660; DS-TMC2660"),
        Sheet("none", 0, "DS-TMC5130 8", ""),
        dcstep=False,
    ),
}
