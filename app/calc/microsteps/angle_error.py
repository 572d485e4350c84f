"""How far a motor stands from where it was told to, over the electrical angle: from slow whole turns both ways.

The mean of both ways is the motor's and the table's; half their difference is friction and hysteresis. What comes once
or twice a turn is the encoder's or its coupling's: a motor has as many electrical periods a turn as teeth. What an
encoder itself is off 50, 100 or 200 times a turn looks like the motor's: nothing seen from one side tells them apart.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

ORDERS = (1, 2, 3, 4, 5, 6, 7, 8, 12, 16)
"""Of the electrical angle: what is looked for."""
SHAFT_ORDERS = (1, 2)
BINS = 64
"""Places of the electrical period at which the curve is told."""
PERIODS_LEAST = 8
"""Electrical periods, of both ways together, below which an interval says nothing."""
CONFIDENCE = 0.95
OUTLIER = 9.0
"""Times the median of all: a sample that far from the fit is left out (of normal noise one in 1e9)."""


@dataclass(frozen=True, slots=True)
class ElectricalAngle:
    """The angle that is commanded at a position: `angle` [rad] at `position`, a turn of it in `period` [microsteps].

    sign : -1 where the field turns back as the position grows
    """

    position: float
    angle: float
    period: float
    sign: int = 1

    def at(self, position: ArrayLike) -> FloatArray:
        """[rad], not wrapped; of the shape of `position`."""
        gone = np.asarray(position, dtype=np.float64) - self.position
        return self.angle + self.sign * 2 * math.pi * gone / self.period


@dataclass(frozen=True, slots=True)
class Way:
    """Samples of one way at constant speed, whole electrical periods [microsteps], each of shape (samples,)."""

    position: FloatArray
    encoder: FloatArray
    forward: bool


@dataclass(frozen=True, slots=True)
class Harmonic:
    """The part sine * sin(order * angle) + cosine * cos(order * angle), and half its 95 % interval [deg]."""

    order: int
    sine: float
    cosine: float
    half: float

    @property
    def amplitude(self) -> float:
        """[deg]."""
        return math.hypot(self.sine, self.cosine)

    @property
    def shown(self) -> bool:
        """Whether it is more than its interval leaves open."""
        return self.amplitude > self.half


@dataclass(frozen=True, slots=True)
class AngleError:
    """Rotor less command. All in electrical degrees but `shaft`, whose harmonics are in degrees of the shaft.

    harmonics : of the electrical angle, one for each of `ORDERS`
    shaft : once and twice a turn
    friction, friction_half : half of what is between both ways, and half its interval
    curve : the mean of both ways at (bin + 1/2) * 360 / `BINS` degrees, shaft's orders taken off; mean 0
    both_ways : half the difference of both ways there
    residual : root mean square of what nothing of this explains
    periods : electrical periods looked at, both ways
    """

    harmonics: tuple[Harmonic, ...]
    shaft: tuple[Harmonic, ...]
    friction: float
    friction_half: float
    curve: tuple[float, ...]
    both_ways: tuple[float, ...]
    residual: float
    periods: int

    @property
    def rms(self) -> float:
        """Root mean square of all harmonics [deg]."""
        return math.sqrt(sum(each.amplitude**2 for each in self.harmonics) / 2)

    def harmonic(self, order: int) -> Harmonic:
        """One of `ORDERS`."""
        return next(each for each in self.harmonics if each.order == order)

    def at(self, angle: ArrayLike, *, shown: bool = False) -> FloatArray:
        """What the harmonics say at an electrical angle [rad], in radians; `shown`: of those alone that are."""
        place = np.asarray(angle, dtype=np.float64)
        total = np.zeros_like(place)
        for each in self.harmonics:
            if each.shown or not shown:
                total += each.sine * np.sin(each.order * place) + each.cosine * np.cos(each.order * place)
        return np.radians(total)


def angle_error(ways: Sequence[Way], electrical: ElectricalAngle, turn: float) -> AngleError:
    """Fit all ways at once by least squares; `turn` [microsteps].

    Intervals are those of a sandwich estimate with an electrical period of one way as its cluster: what neighbouring
    samples share makes them no narrower.

    Raises ValueError unless there are ways both ways with `PERIODS_LEAST` periods at the least and three samples for
    each figure.
    """
    from scipy import stats

    if {way.forward for way in ways} != {True, False}:
        raise ValueError("an angle error is the mean of both ways: there and back")
    position = np.concatenate([way.position for way in ways])
    encoder = np.concatenate([way.encoder for way in ways])
    forward = np.concatenate([np.full(len(way.position), way.forward) for way in ways])
    columns = 4 + 2 * (len(SHAFT_ORDERS) + len(ORDERS))
    if len(position) < 3 * columns:
        raise ValueError(f"a fit of {columns} figures needs {3 * columns} samples, got {len(position)}")
    degrees = electrical.sign * 360.0 / electrical.period
    seen = (encoder - position) * degrees
    angle, shaft = electrical.at(position), 2 * math.pi * position / turn
    # What the shaft does is told without the electrical angle's sign, in degrees of the shaft.
    base = np.stack(
        [
            np.ones_like(position),
            np.where(forward, 1.0, -1.0),
            (position - position.mean()) / turn,
            *(shape(order * shaft) * degrees * turn / 360.0 for order in SHAFT_ORDERS for shape in (np.sin, np.cos)),
        ],
        axis=1,
    )
    waves = np.stack([shape(order * angle) for order in ORDERS for shape in (np.sin, np.cos)], axis=1)
    design = np.concatenate([base, waves], axis=1)
    found, *_ = np.linalg.lstsq(design, seen, rcond=None)
    residual = seen - design @ found
    # A sample whose halves were asked for at different times, e.g. by a machine that was busy, is none.
    good = np.abs(residual) <= OUTLIER * np.median(np.abs(residual)) + 1e-9
    found, *_ = np.linalg.lstsq(design[good], seen[good], rcond=None)
    residual = np.where(good, seen - design @ found, 0.0)
    clusters = _clusters(ways, electrical.period)
    if len(clusters) < PERIODS_LEAST:
        raise ValueError(f"{len(clusters)} electrical periods were looked at, {PERIODS_LEAST} are needed")
    deviation = _deviations(design * good[:, None], residual, clusters)
    half = float(stats.t.ppf((1 + CONFIDENCE) / 2, len(clusters) - 1)) * deviation
    plain = seen - base @ found[: base.shape[1]]
    there, back = (_curve(plain[good & (forward == way)], angle[good & (forward == way)]) for way in (True, False))
    curve = (there + back) / 2
    first = base.shape[1]
    return AngleError(
        harmonics=_harmonics(ORDERS, found[first:], half[first:]),
        shaft=_harmonics(SHAFT_ORDERS, found[3:first], half[3:first]),
        friction=float(found[1]) * electrical.sign,
        friction_half=float(half[1]),
        curve=tuple((curve - curve.mean()).tolist()),
        both_ways=tuple(((there - back) / 2 + found[1]).tolist()),
        residual=float(np.sqrt(np.mean(residual**2))),
        periods=len(clusters),
    )


def _clusters(ways: Sequence[Way], period: float) -> list[NDArray[np.int64]]:
    """Which samples are of one electrical period of one way."""
    found: list[NDArray[np.int64]] = []
    first = 0
    for way in ways:
        number = np.floor((way.position - way.position.min()) / period).astype(np.int64)
        found += [first + np.flatnonzero(number == each) for each in np.unique(number)]
        first += len(number)
    return found


def _deviations(design: FloatArray, residual: FloatArray, clusters: Sequence[NDArray[np.int64]]) -> FloatArray:
    """Standard deviation of each figure of the fit."""
    bread = np.linalg.pinv(design.T @ design)
    scores = np.stack([design[each].T @ residual[each] for each in clusters])
    count = len(clusters)
    covariance = bread @ (scores.T @ scores) @ bread * count / (count - 1)
    return np.asarray(np.sqrt(np.maximum(np.diag(covariance), 0.0)))


def _harmonics(orders: Sequence[int], parts: FloatArray, half: FloatArray) -> tuple[Harmonic, ...]:
    """Their sines and cosines lie one after the other."""
    return tuple(
        Harmonic(order, float(parts[2 * at]), float(parts[2 * at + 1]), float(max(half[2 * at : 2 * at + 2])))
        for at, order in enumerate(orders)
    )


def _curve(error: FloatArray, angle: FloatArray) -> FloatArray:
    """The mean of all samples of each bin of the electrical angle; an empty one lies between its neighbours."""
    place = np.floor(angle / (2 * math.pi) * BINS).astype(np.int64) % BINS
    count = np.bincount(place, minlength=BINS)
    total = np.bincount(place, weights=error, minlength=BINS)
    known = np.flatnonzero(count)
    middle = total[known] / count[known]
    return np.interp(np.arange(BINS), known, middle, period=BINS)
