"""Axes drawn from a seed whose motors and encoders are uneven, as those of one batch are."""

from __future__ import annotations

import math
import random
from typing import Any

from tests.plants.axes import drawn_motor

SMOOTH = {"fourth_harmonic_deg": 0.0, "detent_torque_nm": 0.0}
"""A motor of which a table of a quarter wave can take nothing away."""


def drawn(seed: int, *, nothing_to_gain: bool = False) -> dict[str, Any]:
    """Options of an emulated TMC5160.

    Phases unequal by up to 5 % and 3 degrees, an error once a full step of up to 4 degrees and a detent torque of 2 to
    8 % (none of both with `nothing_to_gain`), the other tolerances as those of `axes`; a load of 0.5 to 10 rotor
    inertias. The encoder has 10,000 lines, is eccentric by up to half a degree, and unequal within a line.
    """
    rng = random.Random(seed)
    motor = drawn_motor(rng)
    torque, current, inertia = (motor[name] for name in ("holding_torque_nm", "rated_current_a", "rotor_inertia_kgm2"))
    motor["phase_unbalance"] = rng.uniform(-0.05, 0.05)
    motor["quadrature_error_deg"] = rng.uniform(-3, 3)
    motor["fourth_harmonic_deg"] = rng.uniform(-4, 4)
    return {
        "motor": {**motor, **(SMOOTH if nothing_to_gain else {})},
        "load": {
            "inertia_kgm2": inertia * 10 ** rng.uniform(math.log10(0.5), 1),
            "friction_nm": torque * rng.uniform(0.0, 0.05),
        },
        "encoder": {
            "lines": 10_000,
            "errors": {
                "eccentricity_deg": rng.uniform(0, 0.5),
                "eccentricity_phase_deg": rng.uniform(0, 360),
                "second_harmonic_deg": rng.uniform(0, 0.1),
                "line_error": rng.uniform(0, 0.05),
                "line_error_phase_deg": rng.uniform(0, 360),
            },
        },
        "supply_v": rng.uniform(24, 48),
        "full_scale_a": current * math.sqrt(2),
        "seed": rng.randrange(1 << 16),
        "start_fullsteps": rng.uniform(-2, 2),
    }
