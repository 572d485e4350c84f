"""Resonance, damping, friction and detent torque of an axis from how its rotor rings after short, fast moves.

The rotor hangs on its field as a pendulum: y'' = w^2 (sin(field - y) - detent - c sign(y')) - 2 d w y', all as shares
of the holding torque, y in electrical angle. w = sqrt(teeth * holding torque / inertia). Least squares over all rings
at once, each with a place and a speed of its own at its start; so no small amplitude is needed, and friction, which
ends a ring early, is told apart from damping. Intervals: from what is left, taken as independent between rings, not
within one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from . import swing_kernel as k

# scipy is imported where it is used: the server starts without it.

FloatArray = NDArray[np.float64]

STEPS_A_RADIAN = 50.0
FIRST_PERIODS, ALL_PERIODS = 5.0, 40.0
"""So many periods of each ring are fitted at first, and in the end."""
FACTORS = (1.0, 1.15, 0.9, 1.3)
"""A large ring is slower than a small one: by so much is the resonance above the frequency that is seen."""
DAMPINGS = (0.03, 0.12)
LEAST_SAMPLES = 40
RESTS_RAD = 0.08
"""Within so much of where it rests in the end it swings no more [rad electrical]."""
LOG_W, DAMPING, FRICTION, SINE, COSINE, OFFSET = range(6)
SHARED = 6
"""What all rings share; each has two more: its place and its speed at its start."""
UNSURE = 0.1
"""A share by which nobody knows the frequency."""
TINY = 1e-9
SAMPLES_A_SWING = 3.0
"""With fewer it may be a faster one: sampled, both look the same."""
FASTEST_HZ = 500.0
"""No rotor swings faster: 0.02 N m on 1.6 g cm^2, among the smallest there are, swing at 400 Hz."""
EARLY, LATE, RELEASED = 1 / 8, 1 / 5, 0.75
"""A ring began at rest in its gap, by so many of its periods earlier or later; such a share of the rings has to."""
LEFT_OUT = 0.003
"""Share of the resonance by which the pendulum is no motor: currents follow late, which pulls it down by some 0.2 %."""
LOWEST = (-math.inf, 1e-4, 0.0, -0.5, -0.5, -math.inf)
HIGHEST = (math.inf, 2.0, 0.8, 0.5, 0.5, math.inf)


@dataclass(frozen=True, slots=True)
class Ring:
    """A ring after a move, from its end on. time_s : from 0; seen : by the encoder; field : where it shall rest [rad
    electrical]; forward : which way it came; gap_s : the move ended within so much before the first sample [s]."""

    time_s: FloatArray
    seen: FloatArray
    field: float
    forward: bool
    gap_s: float

    def until(self, longest_s: float) -> Ring:
        """Its beginning."""
        return self.first(int((self.time_s <= longest_s).sum()))

    def first(self, count: int) -> Ring:
        """So many samples of it."""
        return replace(self, time_s=self.time_s[:count], seen=self.seen[:count])


@dataclass(frozen=True, slots=True)
class Fitted:
    """A figure, and half of its 95 % interval."""

    value: float
    half: float

    def scaled(self, by: float) -> Fitted:
        """In another unit."""
        return Fitted(self.value * by, abs(self.half * by))

    def wider(self, half: float) -> Fitted:
        """With what the fit does not see: half of an interval of its own."""
        return Fitted(self.value, math.hypot(self.half, half))


@dataclass(frozen=True, slots=True)
class RingDown:
    """What was found. friction, detent : shares of the holding torque; residual : root mean square [rad electrical].
    alike : correlation of what is left with the next of it; 0 for white noise

    samples : a ring as it was measured, fitted : the same as it was fitted
    """

    resonance_hz: Fitted
    damping: Fitted
    friction: Fitted
    detent: Fitted
    residual: float
    alike: float
    time_s: FloatArray
    samples: FloatArray
    fitted: FloatArray


class _Fit:
    """Rings to be fitted; parameters are the shared ones, then place and speed (over w) of each ring."""

    def __init__(self, rings: Sequence[Ring], play: float, longest_s: float) -> None:
        self._rings = [ring.until(longest_s) for ring in rings]
        self._play = play
        self.friction: Fitted | None = None
        """Where it is known."""
        self._offset = float(np.median([float(np.median(ring.seen[-LEAST_SAMPLES:])) - ring.field for ring in rings]))
        ends = np.cumsum([len(ring.seen) for ring in self._rings])
        self.parts = [slice(int(a), int(b)) for a, b in zip((0, *ends[:-1]), ends, strict=True)]
        self.size = int(ends[-1])

    def modelled(self, x: FloatArray, index: int) -> FloatArray:
        """One ring as these parameters have it [rad electrical]."""
        ring = self._rings[index]
        w = math.exp(x[LOG_W])
        p = np.array([w * w, 2 * x[DAMPING] * w, x[FRICTION], x[SINE], x[COSINE], self._play])
        dt = 1 / (STEPS_A_RADIAN * w)
        place, speed = x[SHARED + 2 * index], x[SHARED + 2 * index + 1] * w
        grid = np.empty(math.ceil(ring.time_s[-1] / dt) + 2)
        k.swing(p, ring.field, 0.0, place, speed, self._play / 2 if ring.forward else -self._play / 2, dt, grid)
        return np.asarray(np.interp(ring.time_s, np.arange(len(grid)) * dt, grid) + x[OFFSET])

    def residual(self, x: FloatArray) -> FloatArray:
        return np.concatenate([self.modelled(x, at) - ring.seen for at, ring in enumerate(self._rings)])

    def jacobian(self, x: FloatArray) -> FloatArray:
        """By differences; a ring's own parameters move no other ring."""
        found = np.zeros((self.size, len(x)))
        for at, part in enumerate(self.parts):
            base = self.modelled(x, at)
            for column in (*range(SHARED), SHARED + 2 * at, SHARED + 2 * at + 1):
                step = 1e-5
                moved = x.copy()
                moved[column] += step
                found[part, column] = (self.modelled(moved, at) - base) / step
        return found

    def start(self, w: float, damping: float) -> FloatArray:
        """Parameters to begin with."""
        x = np.zeros(SHARED + 2 * len(self._rings))
        x[LOG_W], x[DAMPING], x[FRICTION] = math.log(w), damping, 0.02
        # An encoder's zero lies anywhere: from half a period beside it no fit finds its way.
        x[OFFSET] = self._offset
        for at, ring in enumerate(self._rings):
            few = slice(0, 3)
            slope = np.polyfit(ring.time_s[few], ring.seen[few], 1)[0]
            x[SHARED + 2 * at], x[SHARED + 2 * at + 1] = ring.seen[0] - self._offset, slope / w
        return x

    def solve(self, x: FloatArray, most: int) -> tuple[FloatArray, float]:
        """Least squares from `x` on; parameters and cost."""
        from scipy import optimize

        own = len(x) - SHARED
        low, high = [*LOWEST, *[-math.inf] * own], [*HIGHEST, *[math.inf] * own]
        if self.friction is not None:
            x = x.copy()
            x[FRICTION] = self.friction.value
            low[FRICTION], high[FRICTION] = x[FRICTION] - TINY, x[FRICTION] + TINY
        bounds = (low, high)
        found = optimize.least_squares(self.residual, x, self.jacobian, bounds=bounds, x_scale="jac", max_nfev=most)
        return found.x, float(found.cost)

    def halves(self, x: FloatArray) -> FloatArray:
        """Half 95 % intervals of all parameters: residuals of a ring count as one."""
        from scipy import stats

        jacobian, residual = self.jacobian(x), self.residual(x)
        known = self.friction
        if known is not None:
            jacobian[:, FRICTION] = 0.0
        inverse = np.linalg.pinv(jacobian.T @ jacobian)
        scores = np.array([jacobian[part].T @ residual[part] for part in self.parts])
        count = len(self.parts)
        clustered = inverse @ (scores.T @ scores) @ inverse * (count / max(count - 2, 1))
        plain = inverse * float(residual @ residual) / max(self.size - len(x), 1)
        variance = np.maximum(np.diag(clustered), np.diag(plain))
        halves = np.asarray(float(stats.t.ppf(0.975, max(count - 2, 1))) * np.sqrt(np.maximum(variance, 0.0)))
        if known is not None:
            moved = inverse @ (jacobian.T @ self.jacobian(x)[:, FRICTION]) * known.half
            halves = np.hypot(halves, moved)
            halves[FRICTION] = known.half
        return halves

    def released(self, x: FloatArray) -> float:
        """The share of rings that began at rest, a hop away, within their gaps."""
        w, damping = math.exp(x[LOG_W]), min(float(x[DAMPING]), 0.9)
        slower = math.sqrt(1 - damping**2)
        period_s = 2 * math.pi / (w * slower)
        inside = 0
        for at, ring in enumerate(self._rings):
            sign = -1.0 if ring.forward else 1.0
            away, speed = sign * (x[SHARED + 2 * at] - ring.field), sign * x[SHARED + 2 * at + 1]
            since_s = math.atan2(-slower * speed, away + damping * speed) / (w * slower)
            since_s = (since_s + EARLY * period_s) % period_s - EARLY * period_s
            inside += since_s <= ring.gap_s + LATE * period_s
        return inside / len(self._rings)


def fit_ring_downs(rings: Sequence[Ring], play: float = 0.0, friction: Fitted | None = None) -> RingDown:
    """Fit rings of one axis; `play` between shaft and encoder is known [rad electrical], `friction` where it is given.

    Raises ValueError for fewer than three rings, and for rings that are too short, or sampled too rarely, to tell.
    """
    if len(rings) < 3 or min(len(ring.seen) for ring in rings) < LEAST_SAMPLES:
        raise ValueError(f"a fit needs three rings of {LEAST_SAMPLES} samples, got {[len(r.seen) for r in rings]}")
    rings = [_until_rest(ring) for ring in rings]
    seen_hz = float(np.median([_frequency(ring) for ring in rings]))
    first = _Fit(rings, play, FIRST_PERIODS / seen_hz)
    starts = [first.start(2 * math.pi * seen_hz * factor, damping) for factor in FACTORS for damping in DAMPINGS]
    tried = [first.solve(start, 12) for start in starts]
    best = min(tried, key=lambda found: found[1])[0]
    whole = _Fit(rings, play, ALL_PERIODS / seen_hz)
    whole.friction = friction
    x, _ = whole.solve(best, 60)
    hz = math.exp(x[LOG_W]) / (2 * math.pi)
    every_s = float(np.median(np.concatenate([np.diff(ring.time_s) for ring in rings])))
    few = hz * every_s > 1 / SAMPLES_A_SWING
    if few or (1 / every_s < FASTEST_HZ + hz and whole.released(x) < RELEASED):
        raise ValueError(
            f"samples every {1e3 * every_s:.3g} ms are too few for how it swings: a link that gives "
            f"{SAMPLES_A_SWING:g} samples of a swing or more tells it"
        )
    halves = whole.halves(x)
    if halves[LOG_W] > UNSURE or halves[DAMPING] > max(float(x[DAMPING]), UNSURE):
        raise ValueError("no pendulum rings like that: too much damping, or too few samples of a swing")
    ring = max(range(len(rings)), key=lambda at: float(np.ptp(rings[at].seen)))
    shown = rings[ring].time_s <= ALL_PERIODS / seen_hz
    left = whole.residual(x)
    next_to = np.concatenate([left[part][:-1] * left[part][1:] for part in whole.parts])
    return RingDown(
        resonance_hz=Fitted(hz, hz * float(halves[LOG_W])).wider(LEFT_OUT * hz),
        damping=Fitted(float(x[DAMPING]), float(halves[DAMPING])),
        friction=Fitted(float(x[FRICTION]), float(halves[FRICTION])),
        detent=Fitted(math.hypot(x[SINE], x[COSINE]), float(max(halves[SINE], halves[COSINE]))),
        residual=float(np.sqrt(np.mean(left**2))),
        alike=float(np.mean(next_to) / max(float(np.mean(left**2)), 1e-12)),
        time_s=rings[ring].time_s[shown],
        samples=rings[ring].seen[shown] - rings[ring].field - x[OFFSET],
        fitted=whole.modelled(x, ring) - rings[ring].field - x[OFFSET],
    )


def warm_up() -> None:
    """Compile the kernel, or load it from disk: seconds once, milliseconds after that."""
    k.swing(np.ones(k.PARAMETERS), 0.0, 0.0, 0.0, 0.0, 0.0, 1e-4, np.zeros(2))


def _until_rest(ring: Ring) -> Ring:
    """As long as it swings: where it sticks in the end, friction at rest decides, which is another one."""
    rest = float(np.median(ring.seen[-(len(ring.seen) // 5) :]))
    away = np.flatnonzero(np.abs(ring.seen - rest) > RESTS_RAD)
    end = max(int(away[-1]) + 1 if len(away) else 0, LEAST_SAMPLES // 4)
    return ring.first(end)


def _frequency(ring: Ring) -> float:
    """What swings most [Hz]. Raises ValueError where nothing does."""
    away = ring.seen - float(np.mean(ring.seen[len(ring.seen) // 2 :]))
    padded = 8 * len(away)
    spectrum = np.abs(np.fft.rfft(away * np.hanning(2 * len(away))[len(away) :], padded))
    spectrum[: 2 * 8] = 0.0
    at = int(np.argmax(spectrum))
    if at == 0:
        raise ValueError("nothing swings")
    return at / (padded * float(np.median(np.diff(ring.time_s))))
