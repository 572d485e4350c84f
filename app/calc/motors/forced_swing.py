"""The resonance of a rotor on its field, from its ripple at many speeds: how it answers what comes n times a period.

At a constant speed y'' + 2 d w y' + w^2 sin(y) = w^2 F of one order n. One amplitude |a| of it sees the restoring
torque as 2 J1(|a|)/|a| (the describing function of a sine), and less by the cosine of its mean lag, so that

    a (cos(lag) 2 J1(|a|)/|a| - (n f / f0)^2 + 2 j d n f / f0) = F

for each complex amplitude a [rad electrical] at an electrical frequency f. That is linear in 1/f0^2, 2 d / f0 and F
(one for each way of turning), and solved as an error of a by weights of the solution before (Sanathanan and Koerner
1963). Detent torque comes of where the rotor is, four times a period: it drives order 4 by F e^(j4 lag) (J0(4|a|) +
J2(4|a|) a/a*), and couples order 2 with itself turned back, by a part of a*. Runs in which the rotor would turn back
meanwhile (n |a| > 1) have friction in them, and do not count.
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
    it lags; noise : what the amplitude could be without any ripple of this order [rad electrical]."""

    electrical_hz: float
    amplitude: complex
    forward: bool
    lag: float
    noise: float


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
    hz, damping, forcing, left = table.solved(np.arange(len(counted)), ROUNDS)
    lowest, highest = (order * of(run.electrical_hz for run in runs) for of in (min, max))
    if not lowest * EDGE < hz < highest / EDGE:
        raise ValueError("no resonance of it lies within the speeds")
    rng = np.random.default_rng(seed)
    again = []
    for _ in range(RESAMPLES):
        try:
            again.append(table.solved(rng.integers(0, len(counted), len(counted)), FEWER)[:2])
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

    def solved(self, rows: NDArray[np.int64], rounds: int) -> tuple[float, float, float, float]:
        """Resonance [Hz], damping, forcing of both ways, and the share that is left. Raises ValueError for none."""
        a, f, spring, driven = self._a[rows], self._f[rows], self._spring[rows], self._driven[rows]
        ways, noise = [way[rows] for way in self._ways], self._noise[rows]
        scale = float(np.median(f))
        shapes = [-a * (f / scale) ** 2, 1j * a * (f / scale)]
        shapes += [-turn * way * driven for way in ways for turn in (1, 1j)]
        if self._turned_back:
            shapes += [turn * way * np.conj(a) for way in ways for turn in (1, 1j)]
        columns = np.stack(shapes, axis=1)
        hz = damping = forcing = left = 0.0
        answer = self._answer[rows]
        for _ in range(rounds):
            weight = 1 / (noise * answer)
            design, wanted = columns * weight[:, None], -a * spring * weight
            found, *_ = np.linalg.lstsq(
                np.vstack([design.real, design.imag]), np.concatenate([wanted.real, wanted.imag]), rcond=None
            )
            if not found[0] > 0:
                raise ValueError("its ripple shows no resonance")
            hz = scale / math.sqrt(found[0])
            damping = float(found[1]) / scale * hz / 2
            forcing = (math.hypot(found[2], found[3]) + math.hypot(found[4], found[5])) / 2
            answer = np.maximum(np.abs(spring - (f / hz) ** 2 + 2j * damping * f / hz), STIFFEST)
            left = float(np.linalg.norm((columns @ found + a * spring) / answer) / np.linalg.norm(a))
        if rounds == ROUNDS:
            self._answer[rows] = answer
        return hz, damping, forcing, left


def pooled(found: Sequence[Fitted]) -> Fitted:
    """One figure of several that tell the same, by their intervals; what the equation leaves out is alike in all."""
    weights = np.array([1 / one.half**2 for one in found])
    value = float(np.sum(weights * [one.value for one in found]) / weights.sum())
    return Fitted(value, max(1 / math.sqrt(float(weights.sum())), LEFT_OUT * value))
