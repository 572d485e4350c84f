"""Where emulators come from: the composition root hands this factory to the device manager."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import BaseModel

from ..clock import Clock
from ..errors import UnknownThing
from ..registers.catalog import find_model, is_model
from .core.family import Emulator, EmulatorFamily
from .families import FAMILIES

_FAMILIES = {family.name: family for family in FAMILIES}
EMULATED = tuple(model for family in FAMILIES for model in family.models)
"""Models that there is an emulator of, but for those that only an installed package lists."""


def family_of(model: str) -> EmulatorFamily[Any, Any]:
    """The family that has an emulator of `model`. Raises UnknownThing."""
    if not is_model(model):
        raise UnknownThing("emulator", model, sorted(EMULATED))
    return _FAMILIES[find_model(model).family]


def options_of(model: str) -> type[BaseModel]:
    """What an emulated `model` can be asked for: its options as a pydantic model. Raises UnknownThing."""
    options: type[BaseModel] = family_of(model).options
    return options


def build_emulator(model: str, clock: Clock, options: BaseModel | None = None, eeprom: Path | None = None) -> Emulator:
    """An emulated `model` that has just been switched on and lives by `clock`.

    `options` are those of the model (`options_of`), `eeprom` is the file that a module keeps its memory in; None
    keeps it no longer than the object.

    Raises UnknownThing for a model that the catalog does not have, OutOfRange for a clock that is too fast for it,
    and TypeError for another model's options.
    """
    emulator: Emulator = family_of(model).make(model, clock, options, eeprom)
    return emulator


def warm_up() -> None:
    """Compile the kernels, or load them from numba's disk cache: seconds once, milliseconds after that.

    For a thread at start-up, so that the first request does not wait for it.
    """
    for family in FAMILIES:
        family.warm_up()
