"""The family as the rest of the program sees it."""

from __future__ import annotations

from pathlib import Path

from ...clock import Clock
from ...registers.catalog import find_model
from ..core.family import EmulatorFamily
from .chip import PlainChip
from .module import ListedModule
from .options import ListedOptions, ListedPatch, ListedState


def build(model: str, clock: Clock, options: ListedOptions, eeprom: Path | None = None) -> ListedModule | PlainChip:
    """One that has just been switched on; what it stores it forgets with the process."""
    del eeprom
    known = find_model(model)
    return (PlainChip if known.kind == "chip" else ListedModule)(known, clock, options)


def warm_up() -> None:
    """Nothing of it is compiled."""


FAMILY = EmulatorFamily("listed", (), ListedOptions, ListedPatch, ListedState, build, warm_up)
"""It has no models of its own: whichever the installed package lists."""
