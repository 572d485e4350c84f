"""The family as the rest of the program sees it."""

from __future__ import annotations

from pathlib import Path

from ...clock import Clock, VirtualClock
from ...errors import OutOfRange
from ...registers import catalog
from ...registers.tmc428.models import MODELS
from ..core.family import EmulatorFamily
from .device import EmulatedDevice
from .options import EmulatorOptions, EmulatorPatch
from .state import EmulatorState

CHIPS = tuple(model.name for model in MODELS)


def build(model: str, clock: Clock, options: EmulatorOptions, eeprom: Path | None = None) -> EmulatedDevice:
    """A chip with its stages. Raises OutOfRange for a clock that is too fast for it."""
    del eeprom  # none of these has one
    known = catalog.MODELS[model]
    if options.clock_hz > known.clock_hz_max:
        raise OutOfRange("clock_hz", options.clock_hz, 1, known.clock_hz_max, f"the limit of a {known.title}")
    return EmulatedDevice(model, clock, options)


def warm_up() -> None:
    """Each kind of chip takes its own way through the kernel."""
    for chip in CHIPS:
        build(chip, VirtualClock(), EmulatorOptions()).exchange(bytes(4))


FAMILY = EmulatorFamily("tmc428", CHIPS, EmulatorOptions, EmulatorPatch, EmulatorState, build, warm_up)
