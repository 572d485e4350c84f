"""The family as the rest of the program sees it."""

from __future__ import annotations

from pathlib import Path

from ...clock import Clock
from ..core.family import EmulatorFamily
from ..drive import DRIVE_JOB
from ..drive import warm_up as warm_up_drive
from . import beside_drive, interpreter_kernel
from .models import PLAYED
from .module import EmulatedModule
from .options import TmclOptions, TmclPatch
from .state import TmclState


def build(model: str, clock: Clock, options: TmclOptions, eeprom: Path | None = None) -> EmulatedModule:
    """A module with its motor and encoders, whose memory is kept in the file `eeprom`."""
    return EmulatedModule(model, clock, options, eeprom)


def warm_up() -> None:
    """Compile the kernels or load them from numba's cache."""
    warm_up_drive()
    interpreter_kernel.warm_up()
    beside_drive.warm_up()


FAMILY = EmulatorFamily("tmcl", tuple(PLAYED), TmclOptions, TmclPatch, TmclState, build, warm_up, needs=(DRIVE_JOB,))
