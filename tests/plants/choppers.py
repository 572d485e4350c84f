"""Axes drawn from a seed whose SpreadCycle bends its currents, and what a data sheet says of their motors."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import Any

from tests.plants.axes import drawn_motor, nominal_of


@dataclass(frozen=True)
class ChopperPlant:
    """Options of an emulated TMC5160, and what is told of it: `told` of the motor by its data sheet, at `irun`."""

    options: dict[str, Any]
    told: dict[str, float]
    irun: int


def drawn(seed: int) -> ChopperPlant:
    """Drawn from a seed: a motor with its tolerances (R 10 %, L 20 %: the data sheet's are told), a load of 0.5 to 10
    rotor inertias, 24 to 48 V, 60 to 100 % of the rated current, an encoder of 4000 to 10,000 lines."""
    rng = random.Random(seed)
    motor = drawn_motor(rng)
    nominal = nominal_of(motor)
    irun, supply = rng.randint(19, 31), rng.uniform(24, 48)
    options = {
        "motor": motor,
        "load": {
            "inertia_kgm2": motor["rotor_inertia_kgm2"] * 10 ** rng.uniform(math.log10(0.5), 1),
            "friction_nm": motor["holding_torque_nm"] * rng.uniform(0.0, 0.1),
        },
        "encoder": {"lines": rng.choice((4000, 5000, 10_000))},
        "ripple": True,
        "supply_v": supply,
        "full_scale_a": motor["rated_current_a"] * math.sqrt(2),
        "seed": rng.randrange(1 << 16),
        "start_fullsteps": rng.uniform(-2, 2),
    }
    told = {
        "resistance_ohm": nominal[0],
        "inductance_h": nominal[1],
        "run_current_a": motor["rated_current_a"] * (irun + 1) / 32,
        "supply_v": supply,
    }
    return ChopperPlant(options, told, irun)
