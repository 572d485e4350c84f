"""PID and closed loop again, plain and slow, from NOTES-TMC4361-ENCODER 5 and 6.

Written from the formulas, in Python numbers; every call is one tick of 128 clocks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


def between(value: float, low: float, high: float) -> float:
    return max(low, min(value, high))


@dataclass
class PlainPid:
    """regulation_modus 2 (`base` False) and 3."""

    p: int
    i: int
    d: int
    i_clip: int
    dv_clip: int
    divider: int
    tolerance: int
    base: bool
    isum: int = 0
    last: int | None = None
    difference: int = 0
    since: int = 0
    error: int = 0
    v: int = 0

    def tick(self, x_actual: int, enc_pos: int, vactual: float) -> float:
        self.error = x_actual - enc_pos
        if -self.tolerance <= self.error <= self.tolerance:
            self.error = 0
        if self.last is None:
            self.last = self.error
        self.isum = int(between(self.isum + self.error, -self.i_clip * 2**16, self.i_clip * 2**16))
        self.since += 1
        if self.since >= self.divider:
            self.difference, self.last, self.since = self.last - self.error, self.error, 0
        wanted = self.error * self.p / 256 + self.isum / 256 * self.i / 256 + self.d * self.difference
        self.v = math.trunc(between(wanted, -self.dv_clip, self.dv_clip))
        return vactual + self.v if self.base else float(self.v)


@dataclass
class PlainLoop:
    """The commutation angle without catch-up limiter."""

    beta: int
    gamma: int
    gain: float
    tolerance: int
    vmin: int
    vadd: int
    emf: bool

    def angle(self, x_actual: int, enc_pos: int, v_enc_mean: int) -> tuple[int, bool]:
        """Angle of the field over the rotor [1/256 full step], and whether beta cuts it."""
        deviation = x_actual - enc_pos
        gain = 1.0 if abs(deviation) <= self.tolerance else self.gain
        wanted = math.trunc(deviation * gain)
        return int(between(wanted, -self.beta, self.beta)) + self.back_emf(v_enc_mean), abs(wanted) >= self.beta

    def back_emf(self, v_enc_mean: int) -> int:
        speed = abs(v_enc_mean)
        if not self.emf or speed <= self.vmin:
            return 0
        share = 1.0 if speed >= self.vmin + self.vadd else (speed - self.vmin) / self.vadd
        return int(math.copysign(math.floor(self.gamma * share + 1e-9), v_enc_mean))


def scale(deviation: int, low: int, high: int, start: int, beta: int) -> int:
    """Closed-loop current scale at a deviation on its way up."""
    share = between((abs(deviation) - start) / (beta - start), 0.0, 1.0)
    return low + math.floor((high - low) * share + 1e-9)
