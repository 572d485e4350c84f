"""The chips that ramp by pmul and pdiv, in what their calculations differ."""

from __future__ import annotations

from typing import NamedTuple


class Chip(NamedTuple):
    """reduction : what its data sheet takes off p. usrs : whether it divides full steps itself"""

    reduction: float
    usrs: bool


CHIPS = {
    "tmc428": Chip(0.05, usrs=True),  # DS-TMC428 8.11.1
    "tmc429": Chip(0.01, usrs=True),  # DS-TMC429 8.1.10.2.2
    "tmc4210": Chip(0.01, usrs=False),  # DS-TMC4210 6.1.9.2.2
}
