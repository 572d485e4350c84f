"""Axes drawn from a seed with one fault each, or none. A study gets the link and nothing else."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field
from typing import Any, get_args

from app.studies.record import Fault
from tests.plants.axes import drawn_motor

FAULTS: tuple[Fault, ...] = get_args(Fault)


@dataclass(frozen=True)
class Broken:
    """Options of an emulated TMC5160, and how its encoder slips: every so often [s], by so much on either side.

    fault : None of a healthy one
    """

    fault: Fault | None
    options: dict[str, Any]
    slips_every_s: float = 1.0
    slips_fullsteps: tuple[float, ...] = field(default=(0.0,))


def drawn(seed: int) -> Broken:
    """One fault after the other, every fifth axis has none.

    Motors, loads and supplies as those of other plants: friction up to 15 % of the holding torque, up to 10 rotor
    inertias. Switches lie 250 to 400 full steps to either side, with a backlash of up to half a full step. What is
    broken: one coil of both open; a friction of 0.9 to 2 or a weight of 0.8 to 2 times the holding torque (the motor
    can hold 0.71 of it with a sine in both coils); an encoder that slips by 0.6 to 3.4 full steps every 0.2 to 0.9 s;
    switches with 2 to 15 full steps of backlash.
    """
    rng = random.Random(seed)
    fault = (*FAULTS, None)[seed % (len(FAULTS) + 1)]
    motor: dict[str, Any] = drawn_motor(rng)
    torque, current, inertia = (motor[name] for name in ("holding_torque_nm", "rated_current_a", "rotor_inertia_kgm2"))
    motor["load_value"] = {"noise": 10 ** rng.uniform(0.7, 1.7)}
    load = {
        "inertia_kgm2": inertia * 10 ** rng.uniform(math.log10(0.5), 1),
        "friction_nm": torque * rng.uniform(0, 0.15),
    }
    stage = {
        "left_at_fullsteps": -rng.uniform(250, 400),
        "right_at_fullsteps": rng.uniform(250, 400),
        "backlash_fullsteps": rng.uniform(0, 0.5),
    }
    slips: tuple[float, ...] = (0.0,)
    if fault == "open phase":
        motor["open_phase"] = rng.choice("ab")
    elif fault == "overload" and rng.random() < 0.5:
        load["friction_nm"] = torque * rng.uniform(0.9, 2)
    elif fault == "overload":
        load["torque_nm"] = rng.choice((-1, 1)) * torque * rng.uniform(0.8, 2)
    elif fault == "encoder slips":
        slips = tuple(rng.choice((-1, 1)) * rng.uniform(0.6, 3.4) for _ in range(40))
    elif fault == "switch backlash":
        stage["backlash_fullsteps"] = rng.uniform(2, 15)
    options = {
        "motor": motor,
        "load": load,
        "stage": stage,
        "supply_v": rng.uniform(24, 48),
        "full_scale_a": current,
        "seed": rng.randrange(1 << 16),
        "start_fullsteps": rng.uniform(-2, 2),
    }
    return Broken(fault, options, rng.uniform(0.2, 0.9), slips)
