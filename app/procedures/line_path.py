"""Where the axes of a line were seen on a leg, each sample with its own time, and how far that was off the line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class AxisPath:
    """Where one axis was seen on a leg. Names as in the REST contract.

    time_s : after the first start of that leg; positions [microsteps] are None where a reading was lost
    off_line : how far it was from the line at the most, by the way that the axis of the longest way had gone
        [microsteps]; None where nothing was seen
    uncertainty : how much more or less that may be: by when the samples were taken, and by half of the greatest change
        against the plan between two of them
    """

    device: str
    axis: int
    time_s: tuple[float, ...]
    position: tuple[int | None, ...]
    off_line: float | None
    uncertainty: float | None


@dataclass(frozen=True, slots=True)
class LegMotion:
    """The part of one axis in a leg: where it starts, and its way [microsteps], 0 for one that stands."""

    device: str
    axis: int
    start: int
    way: int
    velocity_pps: float
    expected: Callable[[FloatArray], FloatArray]
    """How far it is planned to have gone by times [s]: [microsteps]."""


@dataclass(frozen=True, slots=True)
class _Sample:
    time_s: float
    uncertainty_s: float
    position: int | None


class LegPath:
    """The samples of one leg. Beyond `samples_max` an axis keeps every other one, and takes half as many from then."""

    def __init__(self, motions: Sequence[LegMotion], samples_max: int) -> None:
        self._motions = motions
        self._max = samples_max
        self._samples: list[list[_Sample]] = [[] for _ in motions]
        self._every = [1] * len(motions)
        self._seen = [0] * len(motions)

    def add(self, number: int, time_s: float, uncertainty_s: float, position: int | None) -> None:
        """What the axis of that number was seen at [microsteps], None where a reading was lost; so long after the first
        start [s], more or less."""
        self._seen[number] += 1
        if self._seen[number] % self._every[number]:
            return
        self._samples[number].append(_Sample(time_s, uncertainty_s, position))
        if len(self._samples[number]) > self._max:
            del self._samples[number][::2]
            self._every[number] *= 2

    def paths(self) -> tuple[AxisPath, ...]:
        """Every axis that moves, as far as it has been seen."""
        moving = [number for number, motion in enumerate(self._motions) if motion.way]
        if not moving:
            return ()
        longest = max(moving, key=lambda number: abs(self._motions[number].way))
        return tuple(self._path(number, longest) for number in moving)

    def _path(self, number: int, longest: int) -> AxisPath:
        motion, samples = self._motions[number], self._samples[number]
        off, uncertainty = self._off_line(number, longest)
        return AxisPath(
            motion.device,
            motion.axis,
            tuple(each.time_s for each in samples),
            tuple(each.position for each in samples),
            off,
            uncertainty,
        )

    def _off_line(self, number: int, longest: int) -> tuple[float | None, float | None]:
        own, other = self._motions[number], self._motions[longest]
        times, at, unsure_s = self._columns(number)
        if not np.isfinite(at).any() or not self._samples[longest]:
            return None, None
        if number == longest:
            return 0.0, 0.0
        of_times, of_at, of_unsure_s = self._columns(longest)
        # What lies between two samples is as planned, but for what both of them are off the plan.
        off_plan = of_at - other.start - other.expected(of_times)
        share = (other.expected(times) + np.interp(times, of_times, off_plan)) / other.way
        off = np.abs(at - (own.start + share * own.way))
        known = np.isfinite(off)
        if not known.any():
            return None, None
        between = float(np.nanmax(np.abs(np.diff(off_plan)), initial=0.0)) / 2 * abs(own.way / other.way)
        return float(off[known].max()), own.velocity_pps * float(unsure_s.max() + of_unsure_s.max()) + between

    def _columns(self, number: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Times [s], positions with NaN where one was lost [microsteps], how unsure times are [s]; the start first."""
        motion, samples = self._motions[number], self._samples[number]
        missing = float("nan")
        return (
            np.array([0.0, *(each.time_s for each in samples)]),
            np.array([motion.start, *(missing if each.position is None else each.position for each in samples)], float),
            np.array([0.0, *(each.uncertainty_s for each in samples)]),
        )
