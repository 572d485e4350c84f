"""Emulated stepper drivers without a ramp generator: a UART or SPI on one side, a motor on the other."""

from __future__ import annotations

from .chip import EmulatedDriver
from .options import MODELS, DriverModel, TmcDriverOptions, TmcDriverPatch
from .state import TmcDriverState

__all__ = ["MODELS", "DriverModel", "EmulatedDriver", "TmcDriverOptions", "TmcDriverPatch", "TmcDriverState"]
