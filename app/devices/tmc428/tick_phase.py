"""When a chip's ramp ticks fall, learned from its motion.

A command takes effect at the next ramp tick, and no register tells when that is: a prediction alone is
uncertain by one tick (256 us at ramp_div 7 and 16 MHz, 20 microsteps at 80,000 pps). The ticks come
evenly for as long as ramp_div stays, so the first move that is watched tells for all that follow.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

LEAST_SAMPLES = 3
STEP_NOISE = 0.3
"""Standard deviation of a position that is counted in whole microsteps, sqrt(1/12) [microsteps]."""
SHARPNESS = 50
"""A tick is known when the motion tells its time to a fiftieth of the tick period..."""
MISFIT = 1.5
"""...and what is left then looks like whole microsteps: rms at most this [microsteps]. Link jitter looks otherwise."""


class TickPhase:
    """The ramp ticks of one axis on device time; `period_s` is that of the settings it was learned with."""

    def __init__(self) -> None:
        self._period_s = 0.0
        self._tick_s: float | None = None
        self.forget_samples()

    def forget_samples(self) -> None:
        """Begin to collect anew."""
        self._count = 0
        self._vv = self._rv = self._rr = 0.0
        self._first_tick_s = 0.0

    def next_motion(self) -> None:
        """A motion is over: all of its samples together tell the ticks best.

        A start close to a tick needs that: a little off, and the prediction would begin a whole tick early or late.
        """
        lead_s = self._lead_s(self._period_s) if self._tick_s is not None else None
        if lead_s is not None and abs(lead_s) <= self._period_s / SHARPNESS:
            self._tick_s = self._first_tick_s - lead_s
        self.forget_samples()

    def until_tick_s(self, now_s: float, period_s: float) -> float | None:
        """Time from `now_s` to the next ramp tick [s], above 0 up to a period; None while unknown."""
        if self._tick_s is None or not math.isclose(period_s, self._period_s):
            return None
        return period_s - (now_s - self._tick_s) % period_s

    def learn(self, residual: FloatArray, velocity_pps: FloatArray, first_tick_s: float, period_s: float) -> bool:
        """Take in samples of one motion from rest; True when they moved the ticks.

        Parameters
        ----------
        residual : measured less predicted position, NaN where nothing was predicted [microsteps], any length
        velocity_pps : predicted velocity, of the same length
        first_tick_s : when the first ramp tick of the prediction fell, device time [s]
        period_s : of the ramp ticks [s]
        """
        moving = np.isfinite(residual) & (np.abs(velocity_pps) > 0)
        r, v = residual[moving], velocity_pps[moving]
        self._count += r.size
        self._vv += float(v @ v)
        self._rv += float(r @ v)
        self._rr += float(r @ r)
        self._first_tick_s = first_tick_s
        lead_s = self._lead_s(period_s)
        if lead_s is None:
            return False
        if abs(lead_s) <= period_s / SHARPNESS and self.until_tick_s(first_tick_s, period_s) is not None:
            return False  # as known before
        self._tick_s, self._period_s = first_tick_s - lead_s, period_s
        self.forget_samples()
        return True

    def _lead_s(self, period_s: float) -> float | None:
        """How much earlier the samples so far came than predicted [s]; None where they cannot tell."""
        if self._count < LEAST_SAMPLES or STEP_NOISE / math.sqrt(self._vv) > period_s / SHARPNESS:
            return None
        lead_s = self._rv / self._vv
        misfit = math.sqrt(max(0.0, self._rr - lead_s * self._rv) / self._count)
        return lead_s if misfit <= MISFIT and abs(lead_s) <= 1.1 * period_s else None
