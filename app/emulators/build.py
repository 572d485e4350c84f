"""Where emulators come from: the composition root hands this factory to the device manager."""

from __future__ import annotations

from app.clock import Clock
from app.emulators.device import EmulatedDevice
from app.emulators.options import EmulatorOptions
from app.links.errors import OutOfRange, UnknownThing
from app.registers.catalog import MODELS


def build_emulator(model: str, clock: Clock, options: EmulatorOptions | None = None) -> EmulatedDevice:
    """An emulated `model` that has just been switched on and lives by `clock`.

    Raises UnknownThing for a model that the catalog does not have and OutOfRange for a clock that is too
    fast for it.
    """
    options = options or EmulatorOptions()
    known = MODELS.get(model)
    if known is None:
        raise UnknownThing("emulator", model, sorted(MODELS))
    if options.clock_hz > known.clock_hz_max:
        raise OutOfRange("clock_hz", options.clock_hz, 1, known.clock_hz_max, f"the limit of a {known.title}")
    return EmulatedDevice(model, clock, options)


def warm_up() -> None:
    """Compile the kernel, or load it from numba's disk cache: seconds once, milliseconds after that.

    For a thread at start-up, so that the first request does not wait for it.
    """
    from app.clock import VirtualClock

    for model in MODELS:
        build_emulator(model, VirtualClock()).exchange(bytes(4))
