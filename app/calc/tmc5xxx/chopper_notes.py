"""What hints for a chopper are made of: settings and figures with reasons, what is wished, and what a chip has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from ..families import CHIPS
from .chips import Sheet

__all__ = ["OWN", "SHEETS", "ChopperChoices", "Figure", "Hints", "Setting", "Sheet", "picked"]

SHEETS = {model: chip.sheet for model, chip in CHIPS.items()}
OWN = "own estimate"


@dataclass(frozen=True)
class Setting:
    """A field of the register `name`, and its value.

    exact : before rounding and limits; None where there is no such number
    chosen : False for what was asked for
    """

    name: str
    field: str
    value: int
    exact: float | None
    meaning: str
    reason: str
    source: str
    chosen: bool = True


@dataclass(frozen=True)
class Figure:
    """A number that follows from the settings. name : stable, for programs."""

    name: str
    label: str
    value: float
    unit: str
    reason: str
    source: str


@dataclass(frozen=True)
class ChopperChoices:
    """What is not to be chosen; None leaves it to the hints. automatic : with pwm_autoscale."""

    chopper_hz: float = 25e3
    tbl: int | None = None
    toff: int | None = None
    hysteresis: int | None = None
    pwm_freq: int | None = None
    automatic: bool = True
    microsteps: int = 256


@dataclass
class Hints:
    settings: list[Setting] = field(default_factory=list)
    figures: list[Figure] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def value(self, name: str) -> int:
        """Of a field that has been set."""
        return next(setting.value for setting in self.settings if setting.field == name)


def picked(asked: int | None, choose: Callable[[], int]) -> tuple[int, bool]:
    """What was asked for, or what `choose` finds, and whether it was found."""
    return (choose(), True) if asked is None else (asked, False)
