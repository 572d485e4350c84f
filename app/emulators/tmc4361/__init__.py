"""An emulated TMC4361: SPI on one side, motor, encoder and switches on the other."""

from __future__ import annotations

from .chip import MODEL, EmulatedTmc4361
from .options import Tmc4361Options, Tmc4361Patch
from .state import Tmc4361State

__all__ = ["MODEL", "EmulatedTmc4361", "Tmc4361Options", "Tmc4361Patch", "Tmc4361State"]
