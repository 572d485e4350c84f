"""What the runs of a resonance map show: ripple by speed and order, and the resonance that several orders meet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ...calc.motors.forced_swing import ForcedSwing, OrderRun, fit_forced_swing, pooled
from ...calc.motors.ring_down import Fitted
from ...calc.signals.order_spectrum import OrderSpectrum
from ..fitted import Estimate, estimate
from ..proof import LEVEL, mean_interval
from .found import ComparedPoint, Crossing, MapPoint, ResonanceFound, Told

ORDERS = (4, 2, 1, 8, 3, 6, 5, 7)
"""Of the electrical frequency, those that a motor makes first: detent torque, uneven phases, an offset."""
DRIVEN = (4, 2, 1)
"""Orders whose ripple may tell the resonance: others are what a large swing of these makes beside them."""
FORCED = 4.0
"""So many times its noise is the least forcing that tells a resonance."""
EXPLAINED = 0.5
"""A share of the ripple that a fit leaves, from which on it tells nothing."""
SAME = 0.08
"""Resonances no further apart than this share are one that several orders meet."""
NEAR = 0.1
BESIDE = ((0.5, 0.8), (1.25, 2.0))
"""What is near to where an order meets the resonance, and beside it, as shares of that speed."""
TIMES, LEAST_RAD = 1.8, math.radians(0.5)
"""So many times of what is beside, and so much, is the peak of an order that has a name."""
COARSE = 0.4
"""Of what no order explains: the counts of a coarse encoder look like so much of any order."""
LEAST_SHARE = 0.03
"""Of the strongest peak: less is left of a start, or mixed from others, where it is amplified."""


@dataclass(frozen=True, slots=True)
class Way:
    """One way at one speed. mean : of the deviation, as seen in its direction [rad electrical]"""

    electrical_hz: float
    forward: bool
    spectrum: OrderSpectrum
    mean: float
    samples: int

    @property
    def noise(self) -> float:
        """What an amplitude could be without any ripple [rad electrical]."""
        return self.spectrum.rest * math.sqrt(2 / self.samples)


@dataclass(slots=True)
class AtSpeed:
    """All that was run at one speed with one setting: ways there and back.

    lost : runs in which steps were lost. blind : runs whose samples tell no order, and so no ripple: they fall on the
        same places of each electrical period
    """

    speed_rps: float
    pairs: list[tuple[Way, Way]] = field(default_factory=list)
    lost: int = 0
    blind: int = 0

    @property
    def ways(self) -> list[Way]:
        """All of them."""
        return [way for pair in self.pairs for way in pair]


def order_runs(speeds: Sequence[AtSpeed], order: int) -> list[OrderRun]:
    """What they show of one order."""
    return [
        OrderRun(
            way.electrical_hz,
            way.spectrum.amplitudes[order],
            way.forward,
            (there.mean + back.mean) / 2,
            way.noise,
            way.spectrum.rest,
        )
        for at in speeds
        for there, back in at.pairs
        for way in (there, back)
        if order in way.spectrum.amplitudes
    ]


def resonance(speeds: Sequence[AtSpeed]) -> tuple[Fitted | None, Fitted | None, list[int]]:
    """The resonance [Hz], its damping, and the orders that tell it; None and no order where none does."""
    told: dict[int, ForcedSwing] = {}
    for order in DRIVEN:
        runs = order_runs(speeds, order)
        try:
            found = fit_forced_swing(order, runs)
        except ValueError:
            continue
        noise = float(np.median([run.noise for run in runs]))
        if found.left < EXPLAINED and found.forcing > FORCED * noise and found.damping.value > 0:
            told[order] = found
    if not told:
        return None, None, []
    surest = min(told.values(), key=lambda one: one.resonance_hz.half)
    near = {
        order: one for order, one in told.items() if abs(one.resonance_hz.value / surest.resonance_hz.value - 1) < SAME
    }
    return pooled([one.resonance_hz for one in near.values()]), surest.damping, sorted(near)


def _between(runs: Sequence[OrderRun], order: int, hz: float, low: float, high: float) -> list[OrderRun]:
    """Those whose order has a frequency between two shares of the resonance."""
    return [run for run in runs if low * hz <= order * run.electrical_hz <= high * hz]


def crossings(speeds: Sequence[AtSpeed], hz: Fitted, told_by: Sequence[int], periods: float) -> list[Crossing]:
    """The orders whose ripple grows where they meet the resonance: those that tell it first, then the strongest.

    periods : electrical, a turn
    """
    found = []
    for order in ORDERS:
        runs = order_runs(speeds, order)
        near = _between(runs, order, hz.value, 1 - NEAR, 1 + NEAR)
        beside = [abs(run.amplitude) for each in BESIDE for run in _between(runs, order, hz.value, *each)]
        if order in told_by:  # it is known by its flanks, even where no speed was near
            near.append(min(runs, key=lambda run: abs(order * run.electrical_hz - hz.value)))
        if not near or not beside:
            continue
        strongest = max(near, key=lambda run: abs(run.amplitude))
        peak, usual = abs(strongest.amplitude), float(np.median(beside))
        if order not in told_by and peak < max(TIMES * usual, COARSE * strongest.rest, LEAST_RAD):
            continue
        found.append(
            Crossing(
                order=order,
                speed_rps=estimate(hz, 1 / (order * periods)),
                peak_deg=math.degrees(peak),
                times=peak / usual,
            )
        )
    least = LEAST_SHARE * max((one.peak_deg for one in found), default=0.0)
    named = [one for one in found if one.order in told_by or one.peak_deg >= least]
    return sorted(named, key=lambda one: (one.order not in told_by, -one.peak_deg))


def mapped(speeds: Sequence[AtSpeed], orders: Sequence[int]) -> list[MapPoint]:
    """The map, by rising speed."""
    return [_point(at, orders) for at in sorted(speeds, key=lambda at: at.speed_rps)]


def _point(at: AtSpeed, orders: Sequence[int]) -> MapPoint:
    ways = at.ways
    ripples = [math.degrees(way.spectrum.ripple) for way in ways]
    strongest = max(ways, key=lambda way: way.spectrum.rest_amplitude, default=None)
    return MapPoint(
        speed_rps=at.speed_rps,
        electrical_hz=float(np.mean([way.electrical_hz for way in ways])) if ways else 0.0,
        ripple_deg=float(np.mean(ripples)) if ripples else None,
        interval_deg=mean_interval(ripples) if len(ripples) > 1 else None,
        amplitudes_deg=[_mean_amplitude(ways, order) for order in orders],
        rest_deg=float(np.mean([math.degrees(way.spectrum.rest) for way in ways])) if ways else None,
        rest_hz=None if strongest is None else strongest.spectrum.rest_hz,
        runs=len(ways),
        lost=at.lost,
        blind=at.blind,
    )


def _mean_amplitude(ways: Sequence[Way], order: int) -> float | None:
    told = [abs(way.spectrum.amplitudes[order]) for way in ways if order in way.spectrum.amplitudes]
    return math.degrees(float(np.mean(told))) if told else None


def compared(before: Sequence[AtSpeed], after: Sequence[AtSpeed]) -> list[ComparedPoint]:
    """Each speed with a change and without, by pairs of ways; those with two of them at the least."""
    points = []
    for one, other in zip(before, after, strict=True):
        pairs = list(zip(one.ways, other.ways, strict=False))
        differences = [math.degrees(b.spectrum.ripple - a.spectrum.ripple) for a, b in pairs]
        if len(differences) < 2:
            continue
        interval = mean_interval(differences, LEVEL / len(before))
        told: Told = "quieter" if interval.high < 0 else "louder" if interval.low > 0 else "no difference"
        points.append(
            ComparedPoint(
                speed_rps=one.speed_rps,
                before_deg=math.degrees(float(np.mean([a.spectrum.ripple for a, _ in pairs]))),
                after_deg=math.degrees(float(np.mean([b.spectrum.ripple for _, b in pairs]))),
                difference_deg=float(np.mean(differences)),
                interval_deg=interval,
                told=told,
            )
        )
    return points


def tell(found: ResonanceFound, speeds: Sequence[AtSpeed], periods: float) -> None:
    """Put the map and what it shows into `found`."""
    found.points = mapped(speeds, found.orders)
    hz, damping, found.told_by = resonance(speeds)
    found.resonance_hz = _told(hz)
    found.damping_ratio = _told(damping)
    found.crossings = [] if hz is None else crossings(speeds, hz, found.told_by, periods)


def _told(figure: Fitted | None) -> Estimate | None:
    return None if figure is None else estimate(figure)
