"""Emulated TMC5031 to TMC5240: SPI and UART on one side, motors, encoders and switches on the other."""

from __future__ import annotations

from .chip import EmulatedTmc5xxx
from .options import MODELS, Tmc5xxxModel, Tmc5xxxOptions, Tmc5xxxPatch
from .state import Tmc5xxxState

__all__ = ["MODELS", "EmulatedTmc5xxx", "Tmc5xxxModel", "Tmc5xxxOptions", "Tmc5xxxPatch", "Tmc5xxxState"]
