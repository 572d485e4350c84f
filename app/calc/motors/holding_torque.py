"""The holding torque of a motor: what its data sheet says, and what its back-EMF says, as one figure.

Both coils carry sine and cosine of a current whose peak is sqrt(2) I, and the torque an ampere of a coil is its
back-EMF constant k (energy that goes in comes out): the torque at a load angle of a full step is sqrt(2) I k (own
formula). Saturation and reluctance are left out.
"""

from __future__ import annotations

import math

from .ring_down import Fitted


def torque_by_back_emf(back_emf_v_s_rad: Fitted, current_a: float) -> Fitted:
    """Holding torque [N m] of that current of each coil (RMS); the constant is the peak of one coil."""
    return back_emf_v_s_rad.scaled(math.sqrt(2) * current_a)


def agreed(told: Fitted, measured: Fitted) -> Fitted | None:
    """Mean of two figures of the same thing, each with the weight of its interval; None where those have nothing in
    common: then one of them is not of this motor, or of another current. Neither may be exact."""
    if abs(told.value - measured.value) > told.half + measured.half:
        return None
    first, second = 1 / told.half**2, 1 / measured.half**2
    return Fitted((first * told.value + second * measured.value) / (first + second), 1 / math.sqrt(first + second))
