"""The family as the rest of the program sees it."""

from __future__ import annotations

from pathlib import Path
from typing import cast

from ...clock import Clock, VirtualClock
from ..core.family import AxisLoad, EmulatorFamily
from ..drive import DRIVE_JOB
from ..drive import warm_up as warm_up_drive
from .chip import EmulatedDriver
from .options import MODELS, DriverModel, TmcDriverOptions, TmcDriverPatch
from .state import TmcDriverState
from .tagged import MODEL as TAGGED
from .tagged import EmulatedTagged


def build(
    model: str, clock: Clock, options: TmcDriverOptions, eeprom: Path | None = None
) -> EmulatedDriver | EmulatedTagged:
    """A driver with its motor."""
    del eeprom  # none of these has one
    if model == TAGGED:
        return EmulatedTagged(clock, options)
    return EmulatedDriver(cast("DriverModel", model), clock, options)


def warm_up() -> None:
    """They have the drive of the others; reading a state compiles what only that needs."""
    warm_up_drive()
    EmulatedDriver(MODELS[0], VirtualClock()).state(1e-3)


FAMILY = EmulatorFamily(
    "tmcdrivers",
    MODELS,
    TmcDriverOptions,
    TmcDriverPatch,
    TmcDriverState,
    build,
    warm_up,
    load=AxisLoad(
        lambda state, axis: state.load_torque_nm, lambda axis, load_nm: TmcDriverPatch(load_torque_nm=load_nm)
    ),
    needs=(DRIVE_JOB,),
)
