"""Axes of a TMC4361 drawn from a seed, whose position loop has to be found."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import Any

TEETH = 50


@dataclass(frozen=True)
class LoopPlant:
    """Options of an emulated TMC4361, and what is true of its resonance, w [rad/s]."""

    options: dict[str, Any]
    w: float
    damping: float


def drawn(seed: int) -> LoopPlant:
    """Drawn from a seed: a motor of 0.3 to 0.6 N m at the chip's full scale, with friction of 0.5 to 4 % and a detent
    torque of 2 to 5 % of that; a resonance of 60 to 200 Hz, damping 0.03 to 0.2, an encoder of 2500 to 10,000 lines."""
    rng = random.Random(seed)
    torque, hz = rng.uniform(0.3, 0.6), math.exp(rng.uniform(math.log(60), math.log(200)))
    damping = math.exp(rng.uniform(math.log(0.03), math.log(0.2)))
    w = 2 * math.pi * hz
    inertia = TEETH * torque / w**2
    motor = {
        "rotor_teeth": TEETH,
        "holding_torque_nm": torque,
        "rated_current_a": 2.1 / math.sqrt(2),
        "rotor_inertia_kgm2": inertia,
        "viscous_nms": 2 * damping * inertia * w,
        "friction_nm": torque * rng.uniform(0.005, 0.04),
        "detent_torque_nm": torque * rng.uniform(0.02, 0.05),
    }
    options = {
        "motor": motor,
        "encoder": {"lines": rng.choice((2500, 5000, 10_000))},
        "full_scale_a": 2.1,
        "supply_v": rng.uniform(24, 48),
        "seed": rng.randrange(1 << 16),
        "start_fullsteps": rng.uniform(-2, 2),
    }
    return LoopPlant(options, w, damping)
