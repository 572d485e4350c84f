"""Axes drawn from a seed: a motor with its tolerances, a load, a supply. A study gets the link and nothing else."""

from __future__ import annotations

import random
from collections.abc import Mapping
from typing import Any

MOTORS = (
    # R [ohm], L [H], holding torque [N m], rated current [A], rotor inertia [kg m2]
    (3.7, 4.5e-3, 0.16, 1.0, 38e-7),
    (1.5, 2.8e-3, 0.40, 1.7, 58e-7),
    (2.3, 4.4e-3, 0.45, 1.5, 58e-7),
    (1.65, 2.8e-3, 0.50, 1.68, 79e-7),
    (1.2, 1.5e-3, 0.55, 2.5, 82e-7),
    (1.6, 3.0e-3, 0.59, 2.0, 82e-7),
)
"""NEMA 17 motors: the first four figures of klipper_tmc_autotune's public list (motor_database.cfg: 17HS08-1004S,
17HS4401, 17HS15-1504S, LDO-42STH47-1684A, LDO-42STH48-2504AC, LDO-42STH48-2004AC); inertia by body length of the 42HS
series."""


def drawn_motor(rng: random.Random) -> dict[str, float]:
    """One of them with its tolerances."""
    resistance, inductance, torque, current, inertia = rng.choice(MOTORS)
    torque *= rng.uniform(0.9, 1.1)
    return {
        "resistance_ohm": resistance * rng.uniform(0.9, 1.1),
        "inductance_h": inductance * rng.uniform(0.8, 1.2),
        "holding_torque_nm": torque,
        "rated_current_a": current,
        "rotor_inertia_kgm2": inertia,
        "detent_torque_nm": torque * rng.uniform(0.02, 0.08),
        "viscous_nms": 10 ** rng.uniform(-3.5, -2.7),
        "friction_nm": torque * rng.uniform(0.005, 0.03),
    }


def nominal_of(motor: Mapping[str, float]) -> tuple[float, float, float, float, float]:
    """What the data sheet of a drawn motor says: the nearest of all."""
    return min(
        MOTORS,
        key=lambda each: abs(each[0] / motor["resistance_ohm"] - 1) + abs(each[3] / motor["rated_current_a"] - 1),
    )


def drawn(seed: int) -> dict[str, Any]:
    """Options of an emulated TMC5160.

    R within 10 %, L 20 %, torque 10 % of the motor's, detent 2 to 8 % of it, viscous and Coulomb friction, 24 to 48 V,
    rated current at the greatest scale. The load has 10 to 200 rotor inertias: with less, at 256 microsteps a full step
    the greatest acceleration of the chip is too little to lose one.
    """
    rng = random.Random(seed)
    motor = drawn_motor(rng)
    torque, current, inertia = (motor[name] for name in ("holding_torque_nm", "rated_current_a", "rotor_inertia_kgm2"))
    return {
        "motor": motor,
        "load": {
            "inertia_kgm2": inertia * 10 ** rng.uniform(1.0, 2.3),
            "friction_nm": torque * rng.uniform(0.0, 0.15),
        },
        "supply_v": rng.uniform(24, 48),
        "full_scale_a": current,
        "seed": rng.randrange(1 << 16),
        "start_fullsteps": rng.uniform(-2, 2),
    }
