"""The ramp that the calculators expect for a motion under way, on device time.

A prediction begins with every command that changes a motion, and ends with the next. Making one
costs nothing until it is read: the curve is computed at the first read (telemetry or API), away
from the command that began it. What a family's ramps look like is its own: `ticked_prediction`, `pd42`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...calc.ramps.curve import RampCurve

FloatArray = NDArray[np.float64]

SAMPLE_EVERY_S = 0.5e-3
SAMPLES = (200, 10_000)
"""Fewest and most points of a curve: 10,000 take 4 ms, and a cubic between them is true to a step."""
STANDS_S = 0.02
"""A motor that stands so long while it should turn was stopped by something that no command told of [s]."""
KEPT = 8
"""Past predictions that telemetry still needs to decode samples taken before a change."""


def wrapped(position: FloatArray, bits: int) -> FloatArray:
    """Positions as a counter of so many bits shows them: a motor that turns on comes round to the other end."""
    half = 2.0 ** (bits - 1)
    return np.asarray((position + half) % (2 * half) - half)


@dataclass(frozen=True, slots=True)
class PredictedPhase:
    """A named part of the ramp, in seconds from its start."""

    name: str
    start_s: float
    end_s: float


class Prediction(ABC):
    """`time_s` counts from `started_at_s` (device time); positions are absolute, of `bits` bits [microsteps]."""

    def __init__(self, axis: int, started_at_s: float, start_position: int, bits: int) -> None:
        self.axis = axis
        self.started_at_s = started_at_s
        self.start_position = start_position
        self.bits = bits
        self.ended_at_s: float | None = None
        """When something changed the motion (a stop, a write, a switch): from then on the ramp says nothing."""
        self.ended_by = ""

    @abstractmethod
    def _ramp(self, samples: int) -> RampCurve:
        """The curve with so many points."""

    @property
    def duration_s(self) -> float:
        """From the start to rest at the target, or to the wanted velocity [s]."""
        return self._outline.duration_s

    @property
    def ends(self) -> bool:
        """Whether the motor comes to rest by itself."""
        return self._outline.settled

    @property
    def time_s(self) -> FloatArray:
        return self._curve.time_s

    @property
    def position(self) -> FloatArray:
        return wrapped(self.start_position + self._curve.position, self.bits)

    @property
    def velocity_pps(self) -> FloatArray:
        return self._curve.velocity_pps

    @property
    def phases(self) -> tuple[PredictedPhase, ...]:
        return tuple(PredictedPhase(phase.name, phase.start_s, phase.end_s) for phase in self._outline.phases)

    @cached_property
    def _outline(self) -> RampCurve:
        return self._ramp(SAMPLES[0])

    @cached_property
    def _curve(self) -> RampCurve:
        samples = int(np.clip(self._outline.duration_s / SAMPLE_EVERY_S, *SAMPLES))
        return self._outline if samples == SAMPLES[0] else self._ramp(samples)

    def _forget_curve(self) -> None:
        """The curve is computed anew at the next look."""
        for computed in ("_outline", "_curve"):
            self.__dict__.pop(computed, None)

    def at(self, times_s: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Position [microsteps] and velocity [pps] at device times [s], NaN before the start and after the end.

        Behind the last point the motion goes on with the velocity it has there: none at a target.
        """
        curve = self._curve
        elapsed = times_s - self.started_at_s
        inside = np.clip(elapsed, 0.0, curve.duration_s)
        velocity = np.interp(inside, curve.time_s, curve.velocity_pps)
        position = _cubic(inside, curve.time_s, curve.position, curve.velocity_pps)
        position = position + np.maximum(elapsed - curve.duration_s, 0.0) * curve.velocity_pps[-1]
        outside = elapsed < 0
        if self.ended_at_s is not None:
            outside |= times_s >= self.ended_at_s
        return (
            np.where(outside, np.nan, wrapped(self.start_position + position, self.bits)),
            np.where(outside, np.nan, velocity),
        )


P = TypeVar("P", bound=Prediction)


def _cubic(at: FloatArray, time_s: FloatArray, position: FloatArray, velocity: FloatArray) -> FloatArray:
    """Hermite interpolation: velocities are known too, and a straight line would cut the ramps' corners."""
    if len(time_s) < 2 or time_s[-1] <= 0:
        return np.full(at.shape, position[-1])
    index = np.clip(np.searchsorted(time_s, at, side="right") - 1, 0, len(time_s) - 2)
    step = time_s[index + 1] - time_s[index]
    safe = np.where(step > 0, step, 1.0)
    u = (at - time_s[index]) / safe
    before, after = position[index], position[index + 1]
    slope_before, slope_after = velocity[index] * step, velocity[index + 1] * step
    u2, u3 = u * u, u * u * u
    return np.asarray(
        (2 * u3 - 3 * u2 + 1) * before
        + (u3 - 2 * u2 + u) * slope_before
        + (-2 * u3 + 3 * u2) * after
        + (u3 - u2) * slope_after
    )


class PredictionBook(Generic[P]):
    """One axis's predictions: the present one, and those that recent samples may still belong to."""

    def __init__(self) -> None:
        self._entries: deque[P] = deque(maxlen=KEPT)
        self._stands_since_s: float | None = None

    def add(self, entry: P) -> P:
        """A motion starts as `entry` says; what was predicted before ends there."""
        self.end(entry.started_at_s, "another command")
        self._entries.append(entry)
        self._stands_since_s = None
        return entry

    def end(self, at_s: float, why: str) -> None:
        """Whatever is predicted holds no longer."""
        present = self.present()
        if present is not None:
            present.ended_at_s, present.ended_by = at_s, why

    def present(self) -> P | None:
        """The prediction that holds, if one does."""
        latest = self._entries[-1] if self._entries else None
        return latest if latest is not None and latest.ended_at_s is None else None

    def over(self, times_s: FloatArray) -> tuple[P, ...]:
        """The predictions that may say something about device times in order [s], the latest last."""
        if not times_s.size:
            return ()
        return tuple(
            entry
            for entry in self._entries
            if entry.started_at_s <= times_s[-1] and (entry.ended_at_s is None or entry.ended_at_s > times_s[0])
        )

    def at(self, times_s: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Position [microsteps] and velocity [pps] that were expected at device times [s]; NaN where nothing was."""
        position, velocity = np.full(times_s.shape, np.nan), np.full(times_s.shape, np.nan)
        for entry in self.over(times_s):
            expected = entry.at(times_s)
            known = ~np.isnan(expected[0])
            position[known], velocity[known] = expected[0][known], expected[1][known]
        return position, velocity

    def observe(self, times_s: FloatArray, standing: NDArray[np.bool_]) -> None:
        """Learn from samples: `standing` is where the motor was at rest although it was expected to turn [rows].

        A stop by a switch is no command, so this is how it is noticed. Ends the present prediction
        where the motor has stood for `STANDS_S`; shorter differences are those of a ramp's last tick.
        """
        if not standing.size:
            return
        if not standing[-1]:
            self._stands_since_s = None
            return
        turning = np.flatnonzero(~standing)
        if turning.size:
            self._stands_since_s = float(times_s[turning[-1] + 1])
        elif self._stands_since_s is None:
            self._stands_since_s = float(times_s[0])
        since_s = self._stands_since_s
        if since_s is not None and times_s[-1] - since_s >= STANDS_S:
            self.end(since_s, "the motor stands: a switch stopped it")
