"""How good a microstep table is: vector length, angle errors, steps, harmonics.

The current vector of a step is (phase B, phase A) = (cosine, sine). With a motor whose flux is a
pure sine the rotor settles at its angle, and the holding torque is proportional to its length: the
ripple of the length is the torque ripple of such a motor.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..driver_chain.ram_words import whole_number
from .sequencer import WAVE_POSITIONS, step_through

DAC_BITS = 6
HARMONICS = 15
ANGLE_NOISE_DEG = 1e-9
"""Angle steps below this are standstill: what atan2 leaves of two equal vectors."""


@dataclass(frozen=True, slots=True)
class AngleStep:
    """The way from step `step` to the next one: `size_deg` electrical, `ratio` of an ideal microstep."""

    step: int
    size_deg: float
    ratio: float


@dataclass(frozen=True, slots=True)
class TableMetrics:
    """One electrical period at one resolution; sequences have `steps` entries, in positive direction.

    Angles are electrical degrees, 360 a period; `angle_error_microsteps` is the same error in
    microsteps of that resolution. `step_deg[k]` leads from step k to step k + 1 (the last one to
    step 0 of the next period). `ripple` is (max - min) / mean of the vector length [DAC counts].

    `harmonics` are the amplitudes of harmonic 1..15 of the staircase that a coil sees over a period,
    relative to the first; `thd` is the root of the summed squares of all above the first, as far as
    the sampled period holds them, relative to the first.

    Where a vector has no length it has no angle: its angles are None, and so are the figures over
    all steps; with no fundamental, `harmonics` and `thd` are None.
    """

    usrs: int
    steps: int
    ideal_step_deg: float
    vector_length: tuple[float, ...]
    vector_length_mean: float
    vector_length_min: float
    vector_length_max: float
    vector_length_ripple: float | None
    angle_deg: tuple[float | None, ...]
    angle_error_deg: tuple[float | None, ...]
    angle_error_microsteps: tuple[float | None, ...]
    angle_error_max_deg: float | None
    angle_error_rms_deg: float | None
    worst_angle_step: int | None
    step_deg: tuple[float | None, ...]
    largest_step: AngleStep | None
    smallest_step: AngleStep | None
    backward_steps: tuple[int, ...]
    standing_steps: tuple[int, ...]
    harmonics: tuple[float, ...] | None
    thd: float | None


def metrics(values: Sequence[int], usrs: int = 6, dac_bits: int = DAC_BITS) -> TableMetrics:
    """The figures of a table of 64 values, stepped through at `usrs` (0..6).

    `dac_bits` (1..6) is how many of the upper DAC bits reach the driver: 4 for TMC236 and its family
    (DS-TMC428 Table 11-2), which sees the values in units of four.

    Raises ValueError for a bad table, or for `usrs` or `dac_bits` out of range.
    """
    lost = DAC_BITS - whole_number("dac_bits", dac_bits, 1, DAC_BITS)
    period = step_through(values, usrs)
    phase_a = [_reaching(step.current_a, lost) for step in period]
    phase_b = [_reaching(step.current_b, lost) for step in period]
    return metrics_of_currents(phase_a, phase_b)


def metrics_of_currents(phase_a: ArrayLike, phase_b: ArrayLike) -> TableMetrics:
    """The figures of any two phase currents over one electrical period, sine and cosine like.

    Both of shape (4 * 2^usrs,) for some usrs of 0..6, in any unit, which is that of the lengths.
    Raises ValueError for any other shape and for currents that are not finite.
    """
    sine = np.asarray(phase_a, dtype=np.float64)
    cosine = np.asarray(phase_b, dtype=np.float64)
    if sine.ndim != 1 or sine.shape != cosine.shape or sine.size not in {4 << usrs for usrs in range(7)}:
        raise ValueError(f"a period has 4, 8, ... 256 steps in both phases, not {sine.shape} and {cosine.shape}")
    if not (np.isfinite(sine).all() and np.isfinite(cosine).all()):
        raise ValueError("a current is not finite")
    steps = sine.size
    ideal_step = 360.0 / steps
    length = np.hypot(cosine, sine)
    mean = float(length.mean())
    angle = np.where(length > 0, np.degrees(np.arctan2(sine, cosine)), np.nan)
    error = _wrapped(angle - np.arange(steps) * ideal_step)
    step_size = _wrapped(np.roll(angle, -1) - angle)
    known = bool(np.isfinite(angle).all())
    harmonics, thd = _harmonics(sine)
    return TableMetrics(
        usrs=steps.bit_length() - 3,
        steps=steps,
        ideal_step_deg=ideal_step,
        vector_length=tuple(length.tolist()),
        vector_length_mean=mean,
        vector_length_min=float(length.min()),
        vector_length_max=float(length.max()),
        vector_length_ripple=float(np.ptp(length)) / mean if mean > 0 else None,
        angle_deg=_optional(angle % 360.0),
        angle_error_deg=_optional(error),
        angle_error_microsteps=_optional(error / ideal_step),
        angle_error_max_deg=float(np.abs(error).max()) if known else None,
        angle_error_rms_deg=float(np.sqrt(np.mean(error**2))) if known else None,
        worst_angle_step=_first_peak(np.abs(error)) if known else None,
        step_deg=_optional(step_size),
        largest_step=_angle_step(step_size, _first_peak(step_size), ideal_step) if known else None,
        smallest_step=_angle_step(step_size, _first_peak(-step_size), ideal_step) if known else None,
        backward_steps=tuple(np.flatnonzero(step_size < -ANGLE_NOISE_DEG).tolist()),
        standing_steps=tuple(np.flatnonzero(np.abs(step_size) <= ANGLE_NOISE_DEG).tolist()),
        harmonics=harmonics,
        thd=thd,
    )


def _reaching(current: int, lost_bits: int) -> int:
    # Truncated as a magnitude, then signed: the phase bit travels apart from the DAC bits.
    magnitude = abs(current) >> lost_bits << lost_bits
    return -magnitude if current < 0 else magnitude


def _wrapped(angle_deg: NDArray[np.float64]) -> NDArray[np.float64]:
    """Into -180..180: differences of angles, taken the short way."""
    return np.asarray((angle_deg + 180.0) % 360.0 - 180.0)


def _optional(numbers: NDArray[np.float64]) -> tuple[float | None, ...]:
    """NaN as None, which JSON knows."""
    return tuple(None if math.isnan(number) else number for number in numbers.tolist())


def _first_peak(numbers: NDArray[np.float64]) -> int:
    # Every quarter repeats the extremes; the last digits of atan2 must not choose among them.
    return int(np.round(numbers, 9).argmax())


def _angle_step(sizes_deg: NDArray[np.float64], step: int, ideal_deg: float) -> AngleStep:
    return AngleStep(step, float(sizes_deg[step]), float(sizes_deg[step]) / ideal_deg)


def _harmonics(wave: NDArray[np.float64]) -> tuple[tuple[float, ...] | None, float | None]:
    # Each value is held until the next microstep. Held at the full wave's 256 positions, a coarse
    # resolution shows the harmonics of its stairs, and one FFT length serves all resolutions.
    held = np.repeat(wave, WAVE_POSITIONS // wave.size)
    amplitude = np.abs(np.fft.rfft(held))
    amplitude[-1] /= math.sqrt(2)  # the Nyquist line has no mirror image, so half the power of the others
    if not amplitude[1] > 1e-12 * max(1.0, float(np.abs(wave).max())) * wave.size:
        return None, None
    relative = amplitude / amplitude[1]
    return tuple(relative[1 : HARMONICS + 1].tolist()), float(np.sqrt(np.sum(relative[2:] ** 2)))
