"""The TMC4361: one axis with S-ramps, an encoder and closed loop."""

from __future__ import annotations

from app.devices.tmc4361.tables import Tables


class Tmc4361(Tables):
    """Driver of one TMC4361."""
