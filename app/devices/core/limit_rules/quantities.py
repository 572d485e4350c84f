"""What a register or parameter means physically, as rows: the tables of the families are made of these."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from ....registers.model import Register
from ..axis_limits import AxisLimits

COORDINATES = 0x1000
"""Of a TMCL module: from here on addresses are numbers of coordinates."""
QuantityKind = Literal["velocity", "acceleration", "current"]
UNITS = {"position": "microsteps", "velocity": "pps", "acceleration": "pps^2", "current": "A"}
View: TypeAlias = Callable[[int], int | None]
"""The word that a register holds, by address, as far as is known."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A velocity, acceleration or current that one register sets. Value: |counts(word)| * unit(view).

    others : addresses of what the unit depends on: writing there changes what this register means
    most : the greatest count that the register can hold: what is taken for a word that nobody knows
    at_start : a motion of any kind goes by it, so that none begins while it is beyond a limit
    advice : what to write, given the greatest count that is allowed
    """

    kind: QuantityKind
    name: str
    address: int
    counts: Callable[[int], float]
    unit: Callable[[View], float]
    most: float
    others: frozenset[int] = frozenset()
    at_start: bool = True
    advice: Callable[[float], str] | None = None

    def value(self, view: View) -> float | None:
        """[unit of its kind]; None where the word is not known."""
        word = view(self.address)
        return None if word is None else abs(self.counts(word)) * self.unit(view)

    def worst(self, view: View) -> float:
        """As `value`; what the register can hold at most where its word is not known."""
        word = view(self.address)
        return (self.most if word is None else abs(self.counts(word))) * self.unit(view)

    def said(self, view: View, limit: float) -> str:
        """What to write for `limit` to be kept."""
        unit = self.unit(view)
        count = limit / unit if unit else self.most
        return self.advice(count) if self.advice is not None else f"write {self.name} {int(count)} or less"


@dataclass(frozen=True, slots=True)
class PositionRegister:
    """A register that holds a position: a target, or the counter."""

    name: str
    address: int
    position: Callable[[int, View], int | None]
    """The position that a word stands for; None where it is none, as the chip is set."""


@dataclass(frozen=True, slots=True)
class Motion:
    """A motion under way or about to begin: by which registers, and whereto.

    target : of positioning; None where it turns, or nobody knows
    way : of turning, +1 or -1; 0 where nobody knows
    jumps : its velocity jumps, by no acceleration
    """

    quantities: tuple[Quantity, ...] = field(compare=False)
    positioning: bool
    target: int | None = None
    way: int = 0
    jumps: bool = False
    counter: int | None = None
    """What the position counter was last written with: positioning goes on from there."""


def position_of(row: Register) -> Callable[[int, View], int]:
    """The position that a word of a register stands for, whatever else is set."""
    return lambda word, _: row.decode(word)


def sign(number: float) -> int:
    """-1, 0 or 1."""
    return (number > 0) - (number < 0)


def limit_of(limits: AxisLimits, kind: QuantityKind) -> float | None:
    """The limit of a kind of quantity, in its unit."""
    if kind == "velocity":
        return limits.velocity_max_pps
    return limits.acceleration_max_pps2 if kind == "acceleration" else limits.current_max_a
