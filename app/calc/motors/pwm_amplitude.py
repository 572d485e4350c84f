"""A coil's resistance and a motor's back-EMF from the amplitude of the PWM that drives a regulated current.

At rest the voltage is R I. In motion it stands against the back-EMF too: with d the load angle, from the rotor's flux
to the current, and w_e the electrical frequency,

    V^2 = (R I cos d - w_e L I sin d)^2 + (R I sin d + w_e L I cos d + k w)^2,

from the motor's voltage equation (own formula; DS-TMC5160 7.4 has the sum R I + k w, that of a motor under full load).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from .ring_down import Fitted

OFF_COUNTS = 0.75
"""By so much may an amplitude be off: half a count of rounding, and what a regulation leaves alone."""
OFF_TOLD = 0.02
"""The same of supply and current as they were told, as shares."""
OFF_INDUCTANCE = 0.2
"""Of the inductance of a data sheet (NEMA motors: 20 %)."""


@dataclass(frozen=True, slots=True)
class PwmScale:
    """What an amplitude is. counts_v : peak voltage of a count [V]; current_a : peak of the regulated current [A]."""

    counts_v: float
    current_a: float


def resistance_of(counts: float, scale: PwmScale) -> Fitted:
    """Of one coil [ohm], from the amplitude at rest. Raises ValueError for one that is too small to tell by."""
    if counts < 4:
        raise ValueError(f"an amplitude of {counts:.3g} of 255 at rest is too small to tell a resistance by")
    value = counts * scale.counts_v / scale.current_a
    return Fitted(value, value * (math.hypot(OFF_COUNTS / counts, math.hypot(OFF_TOLD, OFF_TOLD))))


@dataclass(frozen=True, slots=True)
class Turning:
    """A motor that turns without load but its own. omega : [rad/s]; teeth : of the rotor; load_sine : friction over
    the torque of that current, the sine of the load angle, and how far it may be off."""

    counts: float
    omega: float
    teeth: float
    inductance_h: float
    load_sine: Fitted


def back_emf_of(turning: Turning, resistance: Fitted, scale: PwmScale) -> Fitted:
    """Peak of one coil [V s/rad], within what counts, resistance, inductance and load leave open.

    Raises ValueError where the voltage at speed is not clearly more than at rest.
    """
    value = _back_emf(turning, resistance.value, scale)
    load = turning.load_sine
    others = (
        _back_emf(replace(turning, counts=turning.counts + OFF_COUNTS), resistance.value, scale),
        _back_emf(replace(turning, inductance_h=turning.inductance_h * (1 + OFF_INDUCTANCE)), resistance.value, scale),
        _back_emf(turning, resistance.value + resistance.half, scale),
        _back_emf(replace(turning, load_sine=Fitted(min(load.value + load.half, 1.0), 0.0)), resistance.value, scale),
    )
    half = math.sqrt(sum((each - value) ** 2 for each in others))
    if half > value:
        raise ValueError(f"it is {value:.3g} V s/rad within {half:.3g}: the coil's inductance takes nearly all")
    return Fitted(value, half)


def _back_emf(turning: Turning, resistance: float, scale: PwmScale) -> float:
    sine = min(max(turning.load_sine.value, 0.0), 1.0)
    cosine = math.sqrt(1 - sine * sine)
    drop = resistance * scale.current_a
    reactive = turning.teeth * turning.omega * turning.inductance_h * scale.current_a
    along = drop * cosine - reactive * sine
    square = (turning.counts * scale.counts_v) ** 2 - along**2
    if square <= 0:
        raise ValueError("the voltage at speed is no more than at rest: no back-EMF can be told")
    return (math.sqrt(square) - drop * sine - reactive * cosine) / turning.omega
