"""A coil's resistance, inductance and back-EMF from the amplitude of the PWM that drives a regulated current.

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
ROUNDS = 12
"""Of the solution: what the load angle takes away shrinks at least tenfold in each."""


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
    """A motor that turns without load but its own, with its current and with less of it at the same speed.

    counts, less_counts : amplitudes; less : the smaller current over the other; omega : [rad/s]; teeth : of the rotor;
    load_sine : friction over the torque of the whole current, the sine of the load angle, and how far it may be off.
    """

    counts: float
    less_counts: float
    less: float
    omega: float
    teeth: float
    load_sine: Fitted


@dataclass(frozen=True, slots=True)
class CoilConstants:
    """Of one coil. inductance_h : [H]; back_emf : peak [V s/rad]"""

    inductance_h: Fitted
    back_emf: Fitted


def coil_constants(turning: Turning, resistance: Fitted, scale: PwmScale) -> CoilConstants:
    """Inductance and back-EMF, within what counts, resistance and load leave open.

    One speed is enough, and one current is not: across the current stands w_e L I + k w, in which only the current
    tells both parts apart. Raises ValueError where the voltage at speed is not clearly more than at rest, or the
    back-EMF is lost in what is open.
    """
    value = _constants(turning, resistance.value, scale)
    load = turning.load_sine
    others = (
        _constants(replace(turning, counts=turning.counts + OFF_COUNTS), resistance.value, scale),
        _constants(replace(turning, less_counts=turning.less_counts + OFF_COUNTS), resistance.value, scale),
        _constants(turning, resistance.value + resistance.half, scale),
        _constants(replace(turning, load_sine=Fitted(load.value + load.half, 0.0)), resistance.value, scale),
    )
    inductance, back_emf = (
        Fitted(each, math.hypot(OFF_TOLD * each, OFF_TOLD * each, *(other[part] - each for other in others)))
        for part, each in enumerate(value)
    )
    if back_emf.half > back_emf.value:
        raise ValueError(
            f"it is {back_emf.value:.3g} V s/rad within {back_emf.half:.3g}: the coil's inductance takes nearly all"
        )
    return CoilConstants(inductance, back_emf)


def _constants(turning: Turning, resistance: float, scale: PwmScale) -> tuple[float, float]:
    """Inductance [H] and back-EMF [V s/rad]: both equations, solved for them with the part along the current known
    from the round before."""
    sine = max(turning.load_sine.value, 0.0)
    drop, reactive, emf = resistance * scale.current_a, 0.0, 0.0
    pairs = [(turning.counts, 1.0), (turning.less_counts, turning.less)]
    angles = [math.asin(min(sine / share, 1.0)) for _, share in pairs]
    for _ in range(ROUNDS):
        across = []
        for (counts, share), angle in zip(pairs, angles, strict=True):
            along = share * (drop * math.cos(angle) - reactive * math.sin(angle))
            square = (counts * scale.counts_v) ** 2 - along**2
            if square <= 0:
                raise ValueError("the voltage at speed is no more than at rest: no back-EMF can be told")
            across.append(math.sqrt(square) - share * drop * math.sin(angle))
        reactive = (across[0] - across[1]) / (math.cos(angles[0]) - turning.less * math.cos(angles[1]))
        emf = across[0] - reactive * math.cos(angles[0])
    return reactive / (turning.teeth * turning.omega * scale.current_a), emf / turning.omega
