"""Where emulators come from: the composition root hands this factory to the device manager."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, cast, overload

from ..clock import Clock
from ..errors import OutOfRange, UnknownThing
from ..registers.catalog import MODELS
from .tmc5xxx import MODELS as TMC5XXX_MODELS
from .tmc5xxx import EmulatedTmc5xxx, Tmc5xxxModel, Tmc5xxxOptions
from .tmc428.device import EmulatedDevice
from .tmc428.options import EmulatorOptions
from .tmc4361 import MODEL as TMC4361_MODEL
from .tmc4361 import EmulatedTmc4361, Tmc4361Options
from .tmcl.module import MODEL as PD42_MODEL
from .tmcl.module import EmulatedModule
from .tmcl.options import Pd42Options

AnyOptions = EmulatorOptions | Pd42Options | Tmc4361Options | Tmc5xxxOptions
AnyEmulator = EmulatedDevice | EmulatedModule | EmulatedTmc4361 | EmulatedTmc5xxx
_OPTIONS: dict[str, type[AnyOptions]] = {
    "tmc428": EmulatorOptions,
    "tmc4210": EmulatorOptions,
    TMC4361_MODEL: Tmc4361Options,
    PD42_MODEL: Pd42Options,
    **dict.fromkeys(TMC5XXX_MODELS, Tmc5xxxOptions),
}
EMULATED = tuple(_OPTIONS)
"""Models that there is an emulator of."""


def options_of(model: str) -> type[AnyOptions]:
    """What an emulated `model` can be asked for: its options as a pydantic model."""
    return _OPTIONS.get(model, EmulatorOptions)


@overload
def build_emulator(
    model: Literal["pd42-1241"], clock: Clock, options: Pd42Options | None = None, eeprom: Path | None = None
) -> EmulatedModule: ...
@overload
def build_emulator(
    model: Literal["tmc428", "tmc4210"], clock: Clock, options: EmulatorOptions | None = None
) -> EmulatedDevice: ...
@overload
def build_emulator(
    model: Literal["tmc4361"], clock: Clock, options: Tmc4361Options | None = None
) -> EmulatedTmc4361: ...
@overload
def build_emulator(model: Tmc5xxxModel, clock: Clock, options: Tmc5xxxOptions | None = None) -> EmulatedTmc5xxx: ...
@overload
def build_emulator(model: str, clock: Clock, options: EmulatorOptions) -> EmulatedDevice: ...
@overload
def build_emulator(model: str, clock: Clock, options: Tmc4361Options) -> EmulatedTmc4361: ...
@overload
def build_emulator(model: str, clock: Clock, options: Tmc5xxxOptions) -> EmulatedTmc5xxx: ...
@overload
def build_emulator(model: str, clock: Clock, options: Pd42Options, eeprom: Path | None = None) -> EmulatedModule: ...
@overload
def build_emulator(
    model: str, clock: Clock, options: AnyOptions | None = None, eeprom: Path | None = None
) -> AnyEmulator: ...
def build_emulator(
    model: str, clock: Clock, options: AnyOptions | None = None, eeprom: Path | None = None
) -> AnyEmulator:
    """An emulated `model` that has just been switched on and lives by `clock`.

    `options` are those of the model (`options_of`), `eeprom` is the file that a module keeps its memory in; None
    keeps it no longer than the object.

    Raises UnknownThing for a model that the catalog does not have, OutOfRange for a clock that is too fast for it,
    and TypeError for another model's options.
    """
    if model not in EMULATED:
        raise UnknownThing("emulator", model, sorted(EMULATED))
    options = options or options_of(model)()
    if not isinstance(options, options_of(model)):
        raise TypeError(f"{type(options).__name__} are no options of a {model}")
    if isinstance(options, Pd42Options):
        return EmulatedModule(clock, options, eeprom)
    if isinstance(options, Tmc4361Options):
        return EmulatedTmc4361(clock, options)
    if isinstance(options, Tmc5xxxOptions):
        return EmulatedTmc5xxx(cast("Tmc5xxxModel", model), clock, options)
    known = MODELS[model]
    if options.clock_hz > known.clock_hz_max:
        raise OutOfRange("clock_hz", options.clock_hz, 1, known.clock_hz_max, f"the limit of a {known.title}")
    return EmulatedDevice(model, clock, options)


def warm_up() -> None:
    """Compile the kernels, or load them from numba's disk cache: seconds once, milliseconds after that.

    For a thread at start-up, so that the first request does not wait for it.
    """
    from ..clock import VirtualClock
    from .drive import warm_up as warm_up_drive

    for chip in ("tmc428", "tmc4210"):
        build_emulator(chip, VirtualClock()).exchange(bytes(4))
    warm_up_drive()
    build_emulator("tmc4361", VirtualClock()).exchange(bytes(5), 1e-3)
    tmc5160 = build_emulator("tmc5160", VirtualClock())
    tmc5160.exchange(bytes(5), 1e-3)
    tmc5160.state(1e-3)
