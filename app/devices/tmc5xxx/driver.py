"""The TMC5031, 5062, 5072, 5130 and 5160: one or two axes with SixPoint ramps and the driver inside."""

from __future__ import annotations

from .tables import Tables


class Tmc5xxx(Tables):
    """Driver of one chip."""
