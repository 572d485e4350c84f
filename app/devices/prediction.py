"""The ramp that the calculators expect for a motion under way, on device time.

A prediction begins with every command that changes a motion, and ends with the next. Making one
costs nothing until somebody looks: the curve is computed at the first look (telemetry or API), away
from the command that began it.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from app.calc.ramp import RampParameters, RampStart, exact_ramp
from app.calc.ramp_curve import RampCurve
from app.devices.tick_phase import TickPhase

FloatArray = NDArray[np.float64]

SPAN = 1 << 24
"""Positions are 24 bits: a motor that turns on and on comes round to the other end."""
ENDLESS_S = 20.0
"""How much is drawn of a motion that does not end by itself, an oscillation say [s]."""
SAMPLE_EVERY_S = 0.5e-3
SAMPLES = (200, 10_000)
"""Fewest and most points of a curve: 10,000 take 4 ms, and a cubic between them is true to a step."""
STANDS_S = 0.02
"""A motor that stands so long while it should turn was stopped by something that no command told of [s]."""
KEPT = 8
"""Past predictions that telemetry still needs to decode samples taken before a change."""


def wrapped(position: FloatArray) -> FloatArray:
    """Positions as the chip's 24 bits show them, -2^23..2^23-1 [microsteps]."""
    half = SPAN / 2
    return np.asarray((position + half) % SPAN - half)


@dataclass(frozen=True, slots=True)
class PredictedPhase:
    """A named part of the ramp, in seconds from its start."""

    name: str
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class Origin:
    """What a motion starts from. Positions in microsteps, `started_at_s` device time [s]."""

    axis: int
    started_at_s: float
    position: int
    distance: int
    """x_target - position; 0 where the mode does not care."""
    velocity: int
    """As v_actual reads."""
    parameters: RampParameters

    @property
    def tick_period_s(self) -> float:
        """Of the ramp ticks [s]."""
        return self.parameters.ramp_period_clocks / self.parameters.clock_hz


class Prediction:
    """`time_s` counts from `started_at_s` (device time); positions are absolute microsteps."""

    def __init__(self, origin: Origin, until_tick_s: float | None = None) -> None:
        self.origin = origin
        self.until_tick_s = origin.tick_period_s if until_tick_s is None else until_tick_s
        """From the start to the first ramp tick [s]; a whole period where nothing is known."""
        self.ended_at_s: float | None = None
        """When something changed the motion (a stop, a write, a switch): from then on the ramp says nothing."""
        self.ended_by = ""

    @property
    def axis(self) -> int:
        return self.origin.axis

    @property
    def started_at_s(self) -> float:
        return self.origin.started_at_s

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
        return wrapped(self.origin.position + self._curve.position)

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

    def align(self, until_tick_s: float) -> None:
        """Begin with a ramp tick `until_tick_s` [s] after the start; the curve is computed anew at the next look."""
        self.until_tick_s = until_tick_s
        for computed in ("_outline", "_curve"):
            self.__dict__.pop(computed, None)

    def _ramp(self, samples: int) -> RampCurve:
        origin = self.origin
        parameters = origin.parameters
        ramp_tick = int(np.clip(round(self.until_tick_s * parameters.clock_hz), 1, parameters.ramp_period_clocks))
        # Both dividers count the same clocks (a reading, like the law): pulse ticks fall on ramp ticks.
        pulse_tick = (ramp_tick - 1) % parameters.pulse_period_clocks + 1
        start = RampStart(velocity=origin.velocity, clocks_to_ramp_tick=ramp_tick, clocks_to_pulse_tick=pulse_tick)
        try:
            return exact_ramp(origin.parameters, origin.distance, samples, start)
        except ValueError:  # it never ends; what happens until then is worth seeing all the more
            return exact_ramp(origin.parameters, origin.distance, samples, start, duration_s=ENDLESS_S)

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
            np.where(outside, np.nan, wrapped(self.origin.position + position)),
            np.where(outside, np.nan, velocity),
        )


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


class PredictionBook:
    """One axis's predictions: the present one, and those that recent samples may still belong to."""

    def __init__(self) -> None:
        self._entries: deque[Prediction] = deque(maxlen=KEPT)
        self._stands_since_s: float | None = None
        self._ticks = TickPhase()

    def begin(self, origin: Origin) -> Prediction:
        """A motion starts from `origin`; what was predicted before ends there."""
        self.end(origin.started_at_s, "another command")
        self._ticks.next_motion()
        entry = Prediction(origin, self._ticks.until_tick_s(origin.started_at_s, origin.tick_period_s))
        self._entries.append(entry)
        self._stands_since_s = None
        return entry

    def end(self, at_s: float, why: str) -> None:
        """Whatever is predicted holds no longer."""
        present = self.present()
        if present is not None:
            present.ended_at_s, present.ended_by = at_s, why

    def present(self) -> Prediction | None:
        """The prediction that holds, if one does."""
        latest = self._entries[-1] if self._entries else None
        return latest if latest is not None and latest.ended_at_s is None else None

    def at(self, times_s: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Position [microsteps] and velocity [pps] that were expected at device times [s]; NaN where nothing was."""
        position, velocity = np.full(times_s.shape, np.nan), np.full(times_s.shape, np.nan)
        if not times_s.size:
            return position, velocity
        for entry in self._entries:
            if entry.started_at_s > times_s[-1] or (entry.ended_at_s is not None and entry.ended_at_s <= times_s[0]):
                continue
            expected = entry.at(times_s)
            known = ~np.isnan(expected[0])
            position[known], velocity[known] = expected[0][known], expected[1][known]
        return position, velocity

    def learn(self, times_s: FloatArray, residual: FloatArray, velocity_pps: FloatArray) -> None:
        """Learn from measured less predicted positions [microsteps] when the chip's ramp ticks fall; same lengths.

        Only from a motion that began at rest: v_actual hides a fraction of any other beginning.
        """
        present = self.present()
        if present is None or present.origin.velocity != 0:
            return
        origin = present.origin
        first_tick_s = origin.started_at_s + present.until_tick_s
        own = times_s >= origin.started_at_s
        if self._ticks.learn(residual[own], velocity_pps[own], first_tick_s, origin.tick_period_s):
            present.align(self._ticks.until_tick_s(origin.started_at_s, origin.tick_period_s) or present.until_tick_s)

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
