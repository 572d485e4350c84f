"""Predictions for chips whose ramp generator works in ticks: computed to the tick, and aligned to the chip's own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...calc.ramps.curve import RampCurve
from ...calc.ramps.ticked import RampParameters, RampStart, exact_ramp
from ..core.prediction import FloatArray, Prediction, PredictionBook
from .tick_phase import TickPhase

POSITION_BITS = 24
UNBOUNDED_S = 20.0
"""How much is drawn of a motion that does not end by itself, an oscillation say [s]."""


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


class TickedPrediction(Prediction):
    """The exact ramp from `origin`."""

    def __init__(self, origin: Origin, until_tick_s: float | None = None) -> None:
        super().__init__(origin.axis, origin.started_at_s, origin.position, POSITION_BITS)
        self.origin = origin
        self.until_tick_s = origin.tick_period_s if until_tick_s is None else until_tick_s
        """From the start to the first ramp tick [s]; a whole period where nothing is known."""

    def align(self, until_tick_s: float) -> None:
        """Begin with a ramp tick `until_tick_s` [s] after the start; the curve is computed anew at the next look."""
        self.until_tick_s = until_tick_s
        self._forget_curve()

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
            return exact_ramp(origin.parameters, origin.distance, samples, start, duration_s=UNBOUNDED_S)


class TickedBook(PredictionBook[TickedPrediction]):
    """One axis's predictions, which learn from its motion when the ramp ticks fall."""

    def __init__(self) -> None:
        super().__init__()
        self._ticks = TickPhase()

    def begin(self, origin: Origin) -> TickedPrediction:
        """A motion starts from `origin`; what was predicted before ends there."""
        self.end(origin.started_at_s, "another command")
        self._ticks.next_motion()
        return self.add(TickedPrediction(origin, self._ticks.until_tick_s(origin.started_at_s, origin.tick_period_s)))

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
