"""Electrical figures of stepper motors by name: a public list, to which the user's own are put beside.

`motors.csv` has the figures of KLIPPER-MOTORS. Nobody here has checked them against the makers' sheets; a holding
torque that no motor of that size has is left out.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

SOURCE = "KLIPPER-MOTORS"
OWN = "own"


@dataclass(frozen=True, slots=True)
class Motor:
    """A motor as its sheet or plate names it; None for what nobody tells.

    rated_current_a : of a coil [A]; two coils that carry it at standstill become as hot as with this RMS in motion
    rotor_inertia_kgm2 : of no motor of the public list, which has none
    source : key of docs/sources.md, or "own"
    """

    name: str
    rated_current_a: float
    full_steps_per_rev: int = 200
    resistance_ohm: float | None = None
    inductance_h: float | None = None
    holding_torque_nm: float | None = None
    rotor_inertia_kgm2: float | None = None
    source: str = OWN


@cache
def listed() -> tuple[Motor, ...]:
    """The motors of the public list, in its order."""
    with (Path(__file__).parent / "motors.csv").open(encoding="utf-8", newline="") as file:
        return tuple(_motor(row) for row in csv.DictReader(file))


def _motor(row: dict[str, str]) -> Motor:
    return Motor(
        name=row["name"],
        rated_current_a=float(row["rated_current_a"]),
        full_steps_per_rev=int(row["full_steps_per_turn"]),
        resistance_ohm=float(row["resistance_ohm"]),
        inductance_h=float(row["inductance_h"]),
        holding_torque_nm=float(row["holding_torque_nm"]) if row["holding_torque_nm"] else None,
        source=SOURCE,
    )


def found(motors: Iterable[Motor], words: str) -> Sequence[Motor]:
    """Those whose names have every word, without regard to case and to what stands between letters and digits."""
    wanted = [_letters(word) for word in words.split()]
    return [motor for motor in motors if all(word in _letters(motor.name) for word in wanted)]


def _letters(text: str) -> str:
    return re.sub(r"[^a-z0-9]", "", text.casefold())
