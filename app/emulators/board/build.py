"""Where emulated boards come from."""

from __future__ import annotations

from collections.abc import Mapping

from ...clock import Clock
from ...errors import UnknownThing
from ..tmc5xxx import MODELS, EmulatedTmc5xxx, Tmc5xxxOptions
from ..tmc4361 import EmulatedTmc4361, Tmc4361Options
from .board import EmulatedBoard

CHIPS = ("tmc4361", *MODELS)
"""Chips that an emulated board may have in its slot."""


def build_board(chip: str, clock: Clock, options: Mapping[str, object]) -> EmulatedBoard:
    """A board with an emulated `chip` that lives by `clock`; `options` are those of the chip.

    Raises UnknownThing for a chip that has no board here, ValueError for options that cannot be.
    """
    if chip not in CHIPS:
        raise UnknownThing("chip on a landungsbruecke", chip, list(CHIPS))
    for model in MODELS:
        if chip == model:
            return EmulatedBoard(EmulatedTmc5xxx(model, clock, Tmc5xxxOptions.model_validate(options)))
    return EmulatedBoard(EmulatedTmc4361(clock, Tmc4361Options.model_validate(options)))
