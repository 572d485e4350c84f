"""What a measurement swings at: its spectrum, as amplitudes that can be read off and powers that add up."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from .alignment import REACH, usual_interval_s

FloatArray = NDArray[np.float64]
Window = Literal["hann", "flattop", "blackman", "none"]
Detrend = Literal["mean", "line", "none"]
SAMPLES_MIN = 8
SAMPLES_MAX = 1 << 20
"""More would take seconds, and tell of frequencies below a thousandth of a hertz."""
EVEN = 1e-3
"""Intervals that differ by less than this share of the usual one count as even: a clock's own rounding."""
# Sums of cosines, highest order last; flat top: amplitudes right to 0.01 dB between two lines (ISO 18431-2).
WINDOWS: dict[str, tuple[float, ...]] = {
    "hann": (0.5, 0.5),
    "flattop": (1.0, 1.933, 1.286, 0.388, 0.0322),
    "blackman": (0.42, 0.5, 0.08),
    "none": (1.0,),
}


@dataclass(frozen=True, slots=True)
class Spectrum:
    """One side of a spectrum, without the constant part where it was taken off.

    frequency_hz, amplitude : [lines]; a sine of amplitude a on a line shows as a [unit of the channel]
    density : [lines], power density [unit^2 / Hz]; its sum times `line_hz` is the mean square of what was analysed
    line_hz : distance of two lines; two sines closer than `resolution_hz` cannot be told apart (the window's bandwidth)
    rate_hz, samples, from_s, to_s : what was analysed: the longest part without a gap
    resampled : times were uneven, so the samples were read off at even ones along straight lines; this damps what lies
        above a third of the rate
    """

    frequency_hz: FloatArray
    amplitude: FloatArray
    density: FloatArray
    line_hz: float
    resolution_hz: float
    rate_hz: float
    samples: int
    from_s: float
    to_s: float
    resampled: bool


def window_of(name: Window, samples: int) -> FloatArray:
    """[samples], periodic, as a spectrum needs it."""
    angle = 2 * np.pi * np.arange(samples) / samples
    window = np.zeros(samples)
    for order, weight in enumerate(WINDOWS[name]):
        window += (-1) ** order * weight * np.cos(order * angle)
    return window


def spectrum(time_s: FloatArray, values: FloatArray, *, window: Window = "hann", detrend: Detrend = "line") -> Spectrum:
    """The spectrum of `values` [rows] at `time_s` [rows, s, rising]; NaN is missing, and never made up.

    detrend : take off nothing, the mean, or the straight line that fits best
    Raises ValueError where fewer than 8 samples follow each other without a gap, or more than 2^20.
    """
    if window not in WINDOWS or detrend not in get_args(Detrend):
        raise ValueError(f"no such window or detrending: {window}, {detrend}")
    first, last = longest_part(time_s, values)
    samples = last - first
    if samples < SAMPLES_MIN:
        raise ValueError(f"a spectrum needs {SAMPLES_MIN} samples without a gap, here are {samples}")
    if samples > SAMPLES_MAX:
        raise ValueError(f"a spectrum takes {SAMPLES_MAX} samples at the most, here are {samples}")
    time_s, values = time_s[first:last], values[first:last]
    interval_s = float(time_s[-1] - time_s[0]) / (samples - 1)
    even_s = time_s[0] + interval_s * np.arange(samples)
    resampled = bool(np.abs(time_s - even_s).max() > EVEN * interval_s)
    analysed = np.interp(even_s, time_s, values) if resampled else values.astype(np.float64)
    if detrend != "none":
        analysed = analysed - analysed.mean()
    if detrend == "line":
        steps = np.arange(samples) - (samples - 1) / 2
        analysed = analysed - steps * (steps @ analysed) / (steps @ steps)
    weights = window_of(window, samples)
    lines = np.abs(np.fft.rfft(analysed * weights))
    # Each line but the constant and, with an even number, the last stands for its mirror image too.
    sides = np.full(len(lines), 2.0)
    sides[0] = 1.0
    if samples % 2 == 0:
        sides[-1] = 1.0
    rate_hz = 1 / interval_s
    power = float(weights @ weights)
    return Spectrum(
        frequency_hz=np.arange(len(lines), dtype=np.float64) * (rate_hz / samples),
        amplitude=sides * lines / float(weights.sum()),
        density=sides * lines**2 / (rate_hz * power),
        line_hz=rate_hz / samples,
        resolution_hz=rate_hz * power / float(weights.sum()) ** 2,
        rate_hz=rate_hz,
        samples=samples,
        from_s=float(time_s[0]),
        to_s=float(time_s[-1]),
        resampled=resampled,
    )


def longest_part(time_s: FloatArray, values: FloatArray) -> tuple[int, int]:
    """The longest run of rows without a missing sample or a hole in the times: (first, behind the last)."""
    if not len(values):
        return 0, 0
    missing = ~np.isfinite(values)
    holes = np.flatnonzero(np.diff(time_s) > REACH * usual_interval_s(time_s)) + 1
    # A missing row is a part of its own, which does not count.
    lost = np.flatnonzero(missing)
    bounds = np.unique(np.concatenate(([0], holes, lost, lost + 1, [len(values)])))
    lengths = np.where(missing[bounds[:-1]], 0, np.diff(bounds))
    best = int(lengths.argmax())
    return (int(bounds[best]), int(bounds[best + 1])) if lengths[best] else (0, 0)
