"""The family as the rest of the program sees it."""

from __future__ import annotations

from pathlib import Path

from ...clock import Clock, VirtualClock
from ..core.family import AxisLoad, EmulatorFamily
from .chip import MODEL, EmulatedTmc4361
from .options import Tmc4361Options, Tmc4361Patch
from .state import Tmc4361State


def build(model: str, clock: Clock, options: Tmc4361Options, eeprom: Path | None = None) -> EmulatedTmc4361:
    """A chip with its motor and encoder."""
    del model, eeprom  # there is one, without a memory
    return EmulatedTmc4361(clock, options)


def warm_up() -> None:
    EmulatedTmc4361(VirtualClock()).exchange(bytes(5), 1e-3)


FAMILY = EmulatorFamily(
    "tmc4361",
    (MODEL,),
    Tmc4361Options,
    Tmc4361Patch,
    Tmc4361State,
    build,
    warm_up,
    load=AxisLoad(lambda state, axis: state.load_torque_nm, lambda axis, load_nm: Tmc4361Patch(load_torque_nm=load_nm)),
)
