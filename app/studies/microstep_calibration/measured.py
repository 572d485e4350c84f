"""What a calibration found, as its record tells it: figures and findings."""

from __future__ import annotations

from ...calc.microsteps.angle_error import AngleError, Harmonic
from ..parts import Interval
from ..record import AngleFigures, AngleHarmonic, Finding

ELECTRICAL, SHAFT = "deg electrical", "deg of the shaft"
CAUSES = {
    1: "once an electrical period: offsets of the phase currents; no table of a quarter wave holds it",
    2: "twice: the phases are unequal, or not a right angle apart; no table of a quarter wave holds it",
    4: "once a full step: detent torque, shape of the flux and of the table; of it the table holds the sine",
}
"""Of harmonics of the electrical angle."""


def figures(found: AngleError) -> AngleFigures:
    """As it is stored."""
    return AngleFigures(
        rms_deg=found.rms,
        harmonics=[_harmonic(each) for each in found.harmonics],
        shaft=[_harmonic(each) for each in found.shaft],
        friction_deg=abs(found.friction),
        friction_half_deg=found.friction_half,
        residual_deg=found.residual,
        periods=found.periods,
        curve_deg=list(found.curve),
        both_ways_deg=list(found.both_ways),
    )


def findings(found: AngleError, beyond_deg: float) -> list[Finding]:
    """As people read it; `beyond_deg` is what no table of a quarter wave takes away [deg electrical]."""
    friction = abs(found.friction)
    return [
        Finding(
            name="angle error",
            text="rotor less command over the electrical angle, mean of both ways, root mean square",
            value=found.rms,
            unit=ELECTRICAL,
        ),
        *(_finding(f"harmonic {order}", found.harmonic(order), text, ELECTRICAL) for order, text in CAUSES.items()),
        Finding(
            name="beyond the table",
            text="what stays with the best table of any resolution: both phases show one quarter wave, which holds "
            "only what comes once a full step",
            value=beyond_deg,
            unit=ELECTRICAL,
        ),
        Finding(
            name="friction",
            text="half of what is between both ways, friction and hysteresis: no table takes that away",
            value=friction,
            unit=ELECTRICAL,
            interval=_around(friction, found.friction_half),
        ),
        *(
            _finding(name, each, "of the encoder or its coupling: left out of the correction", SHAFT)
            for name, each in zip(("once a turn", "twice a turn"), found.shaft, strict=True)
        ),
        Finding(
            name="encoder's own harmonics",
            text="what the encoder is off once, twice or four times an electrical period cannot be told from the "
            "motor's",
            sure="cannot be told",
        ),
    ]


def _finding(name: str, found: Harmonic, text: str, unit: str) -> Finding:
    interval = _around(found.amplitude, found.half)
    return Finding(name=name, text=text, value=found.amplitude, unit=unit, interval=interval)


def _around(middle: float, half: float) -> Interval:
    return Interval(low=max(0.0, middle - half), high=middle + half)


def _harmonic(found: Harmonic) -> AngleHarmonic:
    return AngleHarmonic(
        order=found.order,
        sine_deg=found.sine,
        cosine_deg=found.cosine,
        amplitude_deg=found.amplitude,
        half_deg=found.half,
    )
