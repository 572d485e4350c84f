"""Axes drawn from a seed with a machine on them: load, damping, friction, and play before a usual encoder."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import Any

from tests.plants.axes import drawn_motor

LINES = (500, 1000, 1024, 2000, 2500, 4000, 5000, 10_000)
TEETH, MICROSTEPS = 50, 51_200
TOLERANCE = 0.1


@dataclass(frozen=True)
class Machine:
    """A plant, and what is true of it. torque_nm is told to the study: the motor's own is within 10 % of it."""

    options: dict[str, Any]
    torque_nm: float
    inertia_kgm2: float
    resonance_hz: float
    damping: float
    lines: int
    backlash_microsteps: float


def drawn(seed: int) -> Machine:
    """Options of an emulated TMC5160.

    A load of 0.5 to 10 rotor inertias and up to a tenth of the holding torque of friction, damping 0.02 to 0.2,
    backlash 0 to 8 microsteps, an encoder of 500 to 10,000 lines that is eccentric by up to half a degree; the motor's
    tolerances as those of `axes`.
    """
    rng = random.Random(seed)
    motor = drawn_motor(rng)
    torque, rotor = motor["holding_torque_nm"], motor["rotor_inertia_kgm2"]
    inertia = rotor * (1 + 10 ** rng.uniform(math.log10(0.5), 1))
    damping = 10 ** rng.uniform(math.log10(0.02), math.log10(0.2))
    w = math.sqrt(TEETH * torque / inertia)
    lines, backlash = rng.choice(LINES), rng.uniform(0, 8)
    options = {
        "motor": {**motor, "viscous_nms": 2 * damping * inertia * w},
        "load": {"inertia_kgm2": inertia - rotor, "friction_nm": torque * rng.uniform(0.0, 0.1)},
        "encoder": {
            "lines": lines,
            "errors": {
                "eccentricity_deg": rng.uniform(0, 0.5),
                "eccentricity_phase_deg": rng.uniform(0, 360),
                "line_error": rng.uniform(0, 0.05),
                "backlash_deg": backlash * 360 / MICROSTEPS,
            },
        },
        "supply_v": rng.uniform(24, 48),
        "full_scale_a": motor["rated_current_a"] * math.sqrt(2),
        "seed": rng.randrange(1 << 16),
        "start_fullsteps": rng.uniform(-2, 2),
    }
    told = torque / rng.uniform(1 - TOLERANCE, 1 + TOLERANCE)
    return Machine(options, told, inertia, w / (2 * math.pi), damping, lines, backlash)
