"""Axes with a hard stop drawn from a seed, whose load values are noisy, more so the faster they turn, each by its own
motor. A study gets the link and nothing else."""

from __future__ import annotations

import random
from typing import Any

from .axes import drawn as axis

SPEEDS_RPS = (0.5, 0.75, 1.0, 1.5, 2.0)
APART_RPS = [0.5, 3.0]
"""Speeds at which plants that are drawn `apart` need thresholds of their own."""
APART_PUSH_FULLSTEPS = 30.0
"""How far into the stop a stall is told there: fewer values of it are too noisy."""


def drawn(seed: int) -> tuple[dict[str, Any], list[float]]:
    """Options of an emulated TMC5160, and two speeds [turns/s] at which a stall is to be told.

    The load value without load is 250 to 700, half of that at 50 to 300 full steps a second; its noise is 5 to 150
    counts, 10 to 600 more at each 1000 full steps a second; poles move it by 0 to 150 counts. The load has up to 10
    rotor inertias, the stop lies 250 to 400 full steps to the left.
    """
    rng = random.Random(seed)
    options = axis(seed)
    rotor = options["motor"]["rotor_inertia_kgm2"]
    load_value = {
        "full_scale": rng.uniform(250, 700),
        "half_speed_fullsteps_per_s": rng.uniform(50, 300),
        "noise": 10 ** rng.uniform(0.7, 2.18),
        "noise_with_speed": 10 ** rng.uniform(1.0, 2.78),
        "pole_tolerance": rng.choice((0.0, rng.uniform(10, 150))),
    }
    options["motor"] = {**options["motor"], "load_value": load_value}
    options["load"] = {**options["load"], "inertia_kgm2": rotor * rng.uniform(0, 10)}
    options["stage"] = {
        "left_at_fullsteps": -5000.0,
        "right_at_fullsteps": 5000.0,
        "left_end_fullsteps": -rng.uniform(250, 400),
    }
    return options, sorted(rng.sample(SPEEDS_RPS, 2))


def apart(seed: int) -> dict[str, Any]:
    """Options of an emulated TMC5160 of which no threshold does it at both of `APART_RPS`, and one of each does.

    The faster the noisier: what a free run falls to at 3 turns a second is below what a stall comes to at 0.5.
    """
    rng = random.Random(seed)
    full_scale = rng.uniform(950, 1250)
    return {
        "motor": {
            "rotor_teeth": 50,
            "load_value": {
                "full_scale": full_scale,
                "half_speed_fullsteps_per_s": rng.uniform(2800, 3500),
                "noise": rng.uniform(0, 5),
                "noise_with_speed": 0.77 * full_scale,
            },
        },
        "stage": {
            "left_at_fullsteps": -5000.0,
            "right_at_fullsteps": 5000.0,
            "left_end_fullsteps": -rng.uniform(280, 350),
        },
    }
