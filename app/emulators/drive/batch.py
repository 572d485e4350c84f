"""A motor of a batch: figures drawn around those of a named motor, each within the tolerance of its kind.

Resistance within 10 % and inductance within 20 % are what data sheets tell (SY28STH45). What else they leave open is
INFERRED: torque within 10 %, friction half to twice, viscous friction a third to three times (so damping of the
resonance with it), rotor inertia within 5 %, detent torque half to one and a half times (2 to 7 % of the holding torque
where 4.4 % is named); phases unlike by 5 %, 3 and 4 degrees as `MotorOptions` says; the load value's full scale, half
speed within 40 %, its noise half to three times (FLUIDNC-470: 14 to 74 of one motor), its growth up to 300 for each
1000 full steps a second, poles up to 60. What is drawn of unlike phases and noise is added to what is named.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .options import MotorOptions

SHARES: Mapping[str, tuple[float, float]] = {
    "resistance_ohm": (0.9, 1.1),
    "inductance_h": (0.8, 1.2),
    "holding_torque_nm": (0.9, 1.1),
    "rotor_inertia_kgm2": (0.95, 1.05),
    "detent_torque_nm": (0.5, 1.5),
    "viscous_nms": (1 / 3, 3.0),
    "friction_nm": (0.5, 2.0),
}
"""Of what is named: least and greatest; those that reach further up than down are drawn by their logarithm."""
ADDED: Mapping[str, float] = {"phase_unbalance": 0.05, "quadrature_error_deg": 3.0, "fourth_harmonic_deg": 4.0}
"""Added to what is named, so much either way at most."""
LOAD_SHARES: Mapping[str, tuple[float, float]] = {
    "full_scale": (0.6, 1.4),
    "half_speed_fullsteps_per_s": (0.6, 1.4),
    "noise": (0.5, 3.0),
}
LOAD_ADDED: Mapping[str, float] = {"noise_with_speed": 300.0, "pole_tolerance": 60.0}
"""Of the load value, as above; added ones never lower it."""


def motor_of_batch(named: MotorOptions, seed: int) -> MotorOptions:
    """The motor that `seed` draws around the one that is named: the same seed and motor, the same figures.

    Each figure has a random number of its own, so what is named of one does not change what is drawn of another. None
    leaves the range that its option has.
    """
    load = named.load_value
    told: dict[str, Any] = {"load_value": load.model_copy(update=_drawn(load, seed, LOAD_SHARES, LOAD_ADDED, 0.0))}
    return named.model_copy(update={**_drawn(named, seed, SHARES, ADDED, -1.0), **told, "batch_seed": None})


def _drawn(
    named: Any, seed: int, shares: Mapping[str, tuple[float, float]], added: Mapping[str, float], least: float
) -> dict[str, float]:
    figures: dict[str, float] = {}
    for name, (low, high) in shares.items():
        chance = random.Random(f"{seed} {name}").random()
        even = abs(low + high - 2) < 1e-9
        share = low + chance * (high - low) if even else low * (high / low) ** chance
        figures[name] = getattr(named, name) * share
    for name, most in added.items():
        figures[name] = getattr(named, name) + most * random.Random(f"{seed} {name}").uniform(least, 1.0)
    return {name: _within(named, name, value) for name, value in figures.items()}


def _within(named: Any, name: str, value: float) -> float:
    for bound in type(named).model_fields[name].metadata:
        value = max(value, getattr(bound, "ge", value))
        value = min(value, getattr(bound, "le", value))
    return value
