"""The family as the rest of the program sees it."""

from __future__ import annotations

from pathlib import Path
from typing import cast

from ...clock import Clock, VirtualClock
from ..core.family import AxisLoad, EmulatorFamily
from ..drive import DRIVE_JOB
from ..drive import warm_up as warm_up_drive
from .chip import EmulatedTmc5xxx
from .options import MODELS, AxisChange, Tmc5xxxModel, Tmc5xxxOptions, Tmc5xxxPatch
from .state import Tmc5xxxState


def build(model: str, clock: Clock, options: Tmc5xxxOptions, eeprom: Path | None = None) -> EmulatedTmc5xxx:
    """A chip with its motors and encoders."""
    del eeprom  # none of these has one
    return EmulatedTmc5xxx(cast("Tmc5xxxModel", model), clock, options)


def warm_up() -> None:
    """All have the same drive; reading a state compiles what only that needs."""
    warm_up_drive()
    chip = EmulatedTmc5xxx(MODELS[-1], VirtualClock())
    chip.exchange(bytes(5), 1e-3)
    chip.state(1e-3)


def _load_nm(state: Tmc5xxxState, axis: int) -> float:
    return state.axes[axis].load_torque_nm


def _loaded(axis: int, load_nm: float) -> Tmc5xxxPatch:
    return Tmc5xxxPatch(axes=[AxisChange(axis=axis, load_torque_nm=load_nm)])


FAMILY = EmulatorFamily(
    "tmc5xxx",
    MODELS,
    Tmc5xxxOptions,
    Tmc5xxxPatch,
    Tmc5xxxState,
    build,
    warm_up,
    load=AxisLoad(_load_nm, _loaded),
    needs=(DRIVE_JOB,),
)
