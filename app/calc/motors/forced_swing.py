"""The resonance of a rotor on its field, from its ripple at many speeds: how it answers what comes n times a period.

At a constant speed y'' + 2 d w y' + w^2 sin(y) = w^2 F of one order n. One amplitude |a| of it sees the restoring
torque as 2 J1(|a|)/|a| (the describing function of a sine), and less by the cosine of its mean lag, so that

    a (cos(lag) 2 J1(|a|)/|a| - (n f / f0)^2 + 2 j d n f / f0) = F

for each complex amplitude a [rad electrical] at an electrical frequency f. That is linear in 1/f0^2, 2 d / f0 and F
(one for each way of turning), and solved as an error of a by weights of the solution before (Sanathanan and Koerner
1963). Detent torque comes of where the rotor is, four times a period: it drives order 4 by F e^(j4 lag) (J0(4|a|) +
J2(4|a|) a/a*), and couples order 2 with itself turned back, by a part of a*. Runs in which the rotor would turn back
meanwhile (n |a| > 1) have friction in them, and do not count; nor do those that lie far off what the others tell: there
another order swings by itself, or an encoder's counts look like this one at the rate of the samples.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .ring_down import Fitted

# scipy is imported where it is used: the server starts without it.

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

DETENT = 4
"""Order of the detent torque."""
ROUNDS, FEWER = 12, 3
"""Of weights; runs that are drawn anew begin with those of all."""
STARTS, DAMPINGS = 16, (0.03, 0.12)
"""So many resonances, evenly spread, and these dampings are where the weights begin: from some they find no way."""
OUTSIDE, SIFTED = 6.0, 2
"""A run so many times further off than half of them does not count; so often are they sifted."""
RESAMPLES, SOLVED = 200, 0.9
"""So often are runs drawn anew for the interval, and that share of them has to show a resonance."""
TURNS_BACK = 0.8
"""Of the amplitude at which the rotor turns back: beyond, a run does not count."""
LEAST_RUNS = 10
LEFT_OUT = 0.012
"""Share of the resonance by which the equation is no motor, found on emulated ones: it is in each interval."""
ALIKE = 0.03
"""By such a share of itself may an amplitude be off beside its noise."""
STIFFEST = 0.02
"""A rotor without damping would answer without bound: no run counts for more than this share of what it would need."""
EDGE = 1.05
"""A resonance nearer to the end of the speeds is none that was passed."""


@dataclass(frozen=True, slots=True)
class OrderRun:
    """What one run shows of one order. electrical_hz : its speed; amplitude : complex [rad electrical], both turned
    about where it goes backward; lag : by how much the rotor runs ahead of its field, mean of both ways, negative as
    it lags; noise : what the amplitude could be without any ripple of this order [rad electrical]; rest : root mean
    square of what no order of that run explains [rad electrical]."""

    electrical_hz: float
    amplitude: complex
    forward: bool
    lag: float
    noise: float
    rest: float


@dataclass(frozen=True, slots=True)
class ForcedSwing:
    """Of one order. resonance_hz : of small swings; damping : over the critical one; forcing : what the ripple would
    be without resonance, mean of both ways [rad electrical]; left : share of the ripple that this does not explain."""

    resonance_hz: Fitted
    damping: Fitted
    forcing: float
    left: float


def fit_forced_swing(order: int, runs: Sequence[OrderRun], seed: int = 0) -> ForcedSwing:
    """Fit one order. Raises ValueError with why it shows no resonance."""
    counted = [run for run in runs if abs(run.amplitude) * order < TURNS_BACK]
    if len(counted) < LEAST_RUNS:
        raise ValueError(f"{len(counted)} runs in which the rotor does not turn back are too few")
    table = _Table(order, counted)
    rows = np.arange(len(counted))
    table.begin(rows)
    for _ in range(SIFTED):
        off = table.off(rows)
        near = off <= OUTSIDE * np.median(off)
        if near.all():
            break
        rows = rows[near]
        table.begin(rows)
    hz, damping, forcing, left = table.solved(rows, ROUNDS)
    lowest, highest = (order * of(run.electrical_hz for run in runs) for of in (min, max))
    if not lowest * EDGE < hz < highest / EDGE:
        raise ValueError("no resonance of it lies within the speeds")
    rng = np.random.default_rng(seed)
    again = []
    for _ in range(RESAMPLES):
        try:
            again.append(table.solved(rng.choice(rows, len(rows)), FEWER)[:2])
        except ValueError:
            continue
    if len(again) < SOLVED * RESAMPLES:
        raise ValueError("its resonance hangs on single runs")
    low, high = np.percentile(np.asarray(again), (2.5, 97.5), axis=0)
    half = (high - low) / 2
    return ForcedSwing(Fitted(hz, float(half[0])).wider(LEFT_OUT * hz), Fitted(damping, float(half[1])), forcing, left)


class _Table:
    """The runs as columns."""

    def __init__(self, order: int, runs: Sequence[OrderRun]) -> None:
        from scipy import special

        self._a = np.array([run.amplitude for run in runs])
        self._f = order * np.array([run.electrical_hz for run in runs])
        forward = np.array([run.forward for run in runs])
        self._ways = (forward.astype(float), (~forward).astype(float))
        lag, size = np.array([run.lag for run in runs]), np.maximum(np.abs(self._a), 1e-9)
        self._spring: FloatArray = np.cos(lag) * 2 * special.j1(size) / size
        self._driven: ComplexArray = np.ones(len(runs), dtype=complex)
        if order == DETENT:
            turned = np.exp(2j * np.angle(self._a))
            self._driven = np.exp(1j * order * lag) * (special.j0(order * size) + special.jv(2, order * size) * turned)
        self._turned_back = order * 2 == DETENT
        self._answer: FloatArray = np.ones(len(runs))
        self._noise = np.array([max(run.noise, 1e-6) for run in runs]) + ALIKE * size

    def begin(self, rows: NDArray[np.int64]) -> None:
        """Let weights begin with the resonance that explains most of the runs best. Raises ValueError for none."""
        f, spring = self._f[rows], self._spring[rows]
        found: list[tuple[float, FloatArray]] = []
        for hz in np.geomspace(f.min() * EDGE, f.max() / EDGE, STARTS):
            for damping in DAMPINGS:
                self._answer[rows] = _answer(f / hz, spring, damping)
                try:
                    _, found_damping, _, _ = self.solved(rows, ROUNDS)
                except ValueError:
                    continue
                if found_damping > 0:
                    found.append((float(np.median(self.off(rows))), self._answer.copy()))
        if not found:
            raise ValueError("its ripple shows no resonance")
        self._answer = min(found, key=lambda one: one[0])[1]

    def off(self, rows: NDArray[np.int64]) -> FloatArray:
        """By how many times its noise each run is off what the weights so far come to."""
        columns, wanted, _ = self._equation(rows)
        weight = 1 / (self._noise[rows] * self._answer[rows])
        return np.asarray(np.abs(columns @ _least(columns, wanted, weight) - wanted) * weight)

    def solved(self, rows: NDArray[np.int64], rounds: int) -> tuple[float, float, float, float]:
        """Resonance [Hz], damping, forcing of both ways, and the share that is left. Raises ValueError for none."""
        a, f, spring, noise = self._a[rows], self._f[rows], self._spring[rows], self._noise[rows]
        columns, wanted, scale = self._equation(rows)
        hz = damping = forcing = left = 0.0
        answer = self._answer[rows]
        for _ in range(rounds):
            found = _least(columns, wanted, 1 / (noise * answer))
            if not found[0] > 0:
                raise ValueError("its ripple shows no resonance")
            hz = scale / math.sqrt(found[0])
            damping = float(found[1]) / scale * hz / 2
            forcing = (math.hypot(found[2], found[3]) + math.hypot(found[4], found[5])) / 2
            answer = _answer(f / hz, spring, damping)
            left = float(np.linalg.norm((columns @ found - wanted) / answer) / np.linalg.norm(a))
        if rounds == ROUNDS:
            self._answer[rows] = answer
        return hz, damping, forcing, left

    def _equation(self, rows: NDArray[np.int64]) -> tuple[ComplexArray, ComplexArray, float]:
        """Columns of what is looked for, what they shall come to, and the frequency that they are scaled by."""
        a, f, driven = self._a[rows], self._f[rows], self._driven[rows]
        scale = float(np.median(f))
        ways = [way[rows] for way in self._ways]
        shapes = [-a * (f / scale) ** 2, 1j * a * (f / scale)]
        shapes += [-turn * way * driven for way in ways for turn in (1, 1j)]
        if self._turned_back:
            shapes += [turn * way * np.conj(a) for way in ways for turn in (1, 1j)]
        return np.stack(shapes, axis=1), np.asarray(-a * self._spring[rows], dtype=np.complex128), scale


def _answer(share: FloatArray, spring: FloatArray, damping: float) -> FloatArray:
    """How stiff a rotor is at a share of its resonance."""
    return np.asarray(np.maximum(np.abs(spring - share**2 + 2j * damping * share), STIFFEST))


def _least(columns: ComplexArray, wanted: ComplexArray, weight: FloatArray) -> FloatArray:
    """The real figures by which the columns come nearest to what is wanted."""
    design, right = columns * weight[:, None], wanted * weight
    found, *_ = np.linalg.lstsq(
        np.vstack([design.real, design.imag]), np.concatenate([right.real, right.imag]), rcond=None
    )
    return np.asarray(found)


def pooled(found: Sequence[Fitted]) -> Fitted:
    """One figure of several that tell the same, by their intervals; what the equation leaves out is alike in all."""
    weights = np.array([1 / one.half**2 for one in found])
    value = float(np.sum(weights * [one.value for one in found]) / weights.sum())
    return Fitted(value, max(1 / math.sqrt(float(weights.sum())), LEFT_OUT * value))
