"""What a family has to say for its configuration to be written in a safe order."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from ..calc.tmcl.instructions import InstructionSet
from ..devices.core.prediction import Prediction
from ..registers.model import Register


class Counted(Protocol):
    """A device, or a profile of one, as far as units depend on how it is set."""

    @property
    def clock_hz(self) -> float: ...

    def field(self, name: str, axis: int) -> int | None:
        """A field or parameter as it is held; None where nobody knows."""
        ...


PhysicalOf: TypeAlias = Callable[[Counted, Register, int], tuple[float, str] | None]
"""What a number in a register means: how much, and in which unit; None where the family has no unit of its own for it.
Raises ValueError, KeyError, ZeroDivisionError where it is set as no formula allows."""


class Settings(Counted, Protocol):
    """What is known of how a device was set."""

    @property
    def model(self) -> str: ...


@dataclass(frozen=True, slots=True)
class MotionStart:
    """How an axis was when a command reached it: device time [s], position [microsteps], velocity, acceleration."""

    axis: int
    at_s: float
    position: int
    velocity_pps: float = 0.0
    acceleration_pps2: float = 0.0


ExpectedOf: TypeAlias = Callable[[Settings, MotionStart, int | None, int], Prediction]
"""The motion from a start to a target [microsteps], or where that is None to a velocity [the device's own unit].
Raises ValueError where the settings do not tell it; its text says what is missing."""


def known(held: Settings, axis: int, names: Iterable[str]) -> dict[str, int]:
    """Fields of an axis by name. Raises ValueError, naming those that nobody knows."""
    found = {name: held.field(name, axis) for name in names}
    unknown = [name for name, value in found.items() if value is None]
    if unknown:
        raise ValueError(f"what {', '.join(unknown)} held is not known")
    return {name: value for name, value in found.items() if value is not None}


@dataclass(frozen=True, slots=True)
class Busy:
    """Something that has to be 0 before anything is written: `field` of it, or all of it."""

    register: str
    axis: int | None
    field: str
    why: str


@dataclass(frozen=True, slots=True)
class Gates:
    """The register, and the bits of it, that make writes wait for a start signal, or a start write over them."""

    register: str
    mask: int


@dataclass(frozen=True, slots=True)
class Language:
    """In what the programs of a family's devices are written.

    include : the text of a file that every program of a model may include; None for another
    """

    instructions: InstructionSet
    include: Callable[[str, str], str | None]


@dataclass(frozen=True, slots=True)
class ProfileRules:
    """One family's.

    state : registers that can be written, but are state, happen once, or belong to the individual
    order : groups of registers in the order in which they are written; those that are not named follow
    state_fields : fields of which the same is true as of `state`
    target : the register that gets the position at which the motor stands; empty for a module, whose motor has to
        stand at its target
    positioning : register, field and value of positioning where a velocity mode makes a speed limit the speed
    busy : what has to be 0 first
    gates : what makes writes wait for a start signal, where there is that
    physical : what numbers in units of its own mean
    is_state : whether a register is state, where names alone do not tell
    language : of programs that its devices store; None where they store none
    expected : the motion that a command makes of settings; None where nobody can work it out
    """

    state: frozenset[str]
    order: tuple[str, ...]
    state_fields: frozenset[str] = frozenset()
    target: str = ""
    positioning: tuple[str, str, int] | None = None
    busy: tuple[Busy, ...] = ()
    gates: Gates | None = None
    physical: PhysicalOf | None = None
    is_state: Callable[[Register], bool] | None = None
    language: Language | None = None
    expected: ExpectedOf | None = None
