"""Axes drawn from a seed whose load is so heavy that the chip's accelerations reach the edge of the torque."""

from __future__ import annotations

import random
from typing import Any

from tests.plants.axes import drawn_motor


def drawn(seed: int) -> tuple[dict[str, Any], float]:
    """Options of an emulated TMC5160, and the inertia as whoever built it believes it to be [kg m^2].

    A motor with its tolerances, 40 to 250 rotor inertias of load, friction up to 15 % of the torque, 24 to 48 V. The
    belief is off by 1 %, as a standard deviation. There is room: nothing is at either end.
    """
    rng = random.Random(seed)
    motor = drawn_motor(rng)
    load = motor["rotor_inertia_kgm2"] * 10 ** rng.uniform(1.6, 2.4)
    options = {
        "motor": motor,
        "load": {"inertia_kgm2": load, "friction_nm": motor["holding_torque_nm"] * rng.uniform(0.02, 0.15)},
        "stage": {"left_at_fullsteps": -1e6, "right_at_fullsteps": 1e6},
        "supply_v": rng.uniform(24, 48),
        "full_scale_a": motor["rated_current_a"],
        "seed": rng.randrange(1 << 16),
        "start_fullsteps": rng.uniform(-2, 2),
    }
    return options, (load + motor["rotor_inertia_kgm2"]) * rng.gauss(1.0, 0.01)
