"""An emulated TMC4361: SPI on one side, motor, encoder and switches on the other."""

from __future__ import annotations

from app.emulators.tmc4361.chip import MODEL, EmulatedTmc4361
from app.emulators.tmc4361.options import Tmc4361Options, Tmc4361Patch
from app.emulators.tmc4361.state import Tmc4361State

__all__ = ["MODEL", "EmulatedTmc4361", "Tmc4361Options", "Tmc4361Patch", "Tmc4361State"]
