"""What a family of emulators tells the rest of the program: its models, its options, and how one of it is made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from pydantic import BaseModel

from ...clock import Clock
from ...links.port import Wire
from .ground_truth import GroundTruth
from .pace import Pace


class Emulator(Wire, Protocol):
    """What emulators of chips and of modules have in common."""

    pace: Pace | None
    """Bounds the work of a catch-up; None where time waits for whoever works it out."""

    def catch_up(self, slice_s: float) -> bool:
        """Live on by at most `slice_s` [s] of its time; True once it is up to date."""
        ...

    def state(self, at_s: float | None = None) -> BaseModel:
        """Everything that GET .../emulator answers, at chip time `at_s` [s], by default now."""
        ...

    # Each takes the patch of its own family, and is only given one that `EmulatorFamily.patch` has made.
    def patch(self, change: Any, at_s: float | None = None) -> BaseModel:
        """Change what is outside it at chip time `at_s` [s], by default now. Raises BenchError."""
        ...

    def ground_truth(self, axis: int, at_s: float | None = None) -> GroundTruth:
        """How it really is with an axis at chip time `at_s` [s], by default now."""
        ...


OptionsT = TypeVar("OptionsT", bound=BaseModel)
EmulatorT = TypeVar("EmulatorT", bound=Emulator)
StateT = TypeVar("StateT", bound=BaseModel)
PatchT = TypeVar("PatchT", bound=BaseModel)


@dataclass(frozen=True)
class AxisLoad(Generic[StateT, PatchT]):
    """How the load torque of an emulated axis [N m] is read from a state, and said in a patch."""

    read_nm: Callable[[StateT, int], float]
    patch_of: Callable[[int, float], PatchT]


@dataclass(frozen=True)
class EmulatorFamily(Generic[OptionsT, EmulatorT]):
    """One family. `build` makes an emulator of a model that has just been switched on.

    patch, state : what changes a running one, and what it tells
    warm_up : compiles what it takes, or loads it from numba's cache
    load : None where there is no motor that a load could be put on
    needs : what is compiled before `warm_up`, by the name of its job: what several families share
    build's last argument is the file that a module keeps its memory in; chips have none
    """

    name: str
    models: tuple[str, ...]
    options: type[OptionsT]
    patch: type[BaseModel]
    state: type[BaseModel]
    build: Callable[[str, Clock, OptionsT, Path | None], EmulatorT]
    warm_up: Callable[[], None]
    load: AxisLoad[Any, Any] | None = None
    needs: tuple[str, ...] = ()

    def make(self, model: str, clock: Clock, options: OptionsT | None = None, eeprom: Path | None = None) -> EmulatorT:
        """An emulated `model` that lives by `clock`. Raises TypeError for the options of another family."""
        options = options or self.options()
        if not isinstance(options, self.options):
            raise TypeError(f"{type(options).__name__} are no options of a {model}")
        return self.build(model, clock, options, eeprom)
