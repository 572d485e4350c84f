"""A microstep table that makes up for the motor's angle error, as far as a table of a quarter wave can.

The field is turned to where the rotor then stands as commanded. A table shows its one quarter four times in each phase,
so of what would have to be added to the angle it holds only what is odd and comes with each quarter: sines of order 4,
8, 12. What is between the phases (unequal torque, not a right angle apart: orders 1 and 2) it cannot hold.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .angle_error import ORDERS, AngleError, Harmonic
from .mslut import ENTRIES, POSITIONS, Wave
from .mslut_nearest import nearest

FloatArray = NDArray[np.float64]

HIGHEST = max(ORDERS)
GRID: FloatArray = (np.arange(POSITIONS, dtype=np.float64) + 0.5) * (2 * math.pi / POSITIONS)
"""The commanded angles of a period [rad], each in the middle of its microstep."""
AMPLITUDE_MAX = 248.0
"""What leaves the current regulator its headroom [counts]."""
ROUNDS = 8
"""Each leaves a share of what is left, that by which the motor's error changes with the angle."""


class TooUneven(ValueError):
    """A motor whose rotor would go back somewhere as its field goes on: no table makes up for that."""


@dataclass(frozen=True, slots=True)
class MotorError:
    """Rotor less field, over the field's angle: the motor's own, whatever table turned it. `values` are on `GRID`."""

    values: FloatArray
    """[rad], shape (1024,), mean 0."""

    def at(self, field: FloatArray) -> FloatArray:
        """At any field angle [rad]."""
        return np.asarray(np.interp(field, GRID, self.values, period=2 * math.pi))


def motor_error(measured: AngleError, field: FloatArray) -> MotorError:
    """The motor's own part of an error that was measured with a table whose field angles on `GRID` are `field` [rad].

    Of the measured harmonics those alone count that are more than their interval leaves open.
    """
    rest = measured.at(GRID, shown=True) + GRID - field
    return MotorError(_smooth(np.interp(GRID, field, rest, period=2 * math.pi)))


def _phases(wave: Wave) -> tuple[FloatArray, FloatArray]:
    sine: FloatArray = wave.period().astype(np.float64) - wave.mirror / 2
    return sine, np.roll(sine, -ENTRIES)


def lengths(wave: Wave) -> FloatArray:
    """How long the current's vector is on `GRID` [counts]."""
    return np.asarray(np.hypot(*_phases(wave)))


def field_of(wave: Wave) -> FloatArray:
    """The angle of the current's vector on `GRID` [rad]."""
    off = np.arctan2(*_phases(wave)) - GRID
    return np.asarray(GRID + (off + math.pi) % (2 * math.pi) - math.pi)


def quarter_part(turned: FloatArray) -> FloatArray:
    """What a table of a quarter wave can hold of an addition to the angle on `GRID`: the mean over its symmetries."""
    quarters = [np.roll(turned, shift) for shift in range(0, POSITIONS, ENTRIES)]
    return np.asarray(np.mean([each - each[::-1] for each in quarters], axis=0) / 2)


def predicted(motor: MotorError, field: FloatArray, grid: FloatArray = GRID) -> FloatArray:
    """The angle error [rad] on `grid`, a period in equal steps, with a table of these field angles.

    Its mean is 0, and what is finer than order 16 is left out.
    """
    return _smooth(field + motor.at(field) - grid)


def motor_of(harmonics: Iterable[Harmonic]) -> MotorError:
    """A motor of which these are told."""
    total: FloatArray = np.zeros(POSITIONS)
    for each in harmonics:
        total += each.sine * np.sin(each.order * GRID) + each.cosine * np.cos(each.order * GRID)
    return MotorError(np.radians(total))


@dataclass(frozen=True, slots=True)
class Correction:
    """A table, and what it is expected to leave. Errors in electrical degrees on `GRID`.

    before : as measured, its harmonics
    after : with `wave`
    beyond : what would stay with the best table of any resolution: it is not symmetric
    """

    wave: Wave
    before: FloatArray
    after: FloatArray
    beyond: FloatArray


def corrected(measured: AngleError, wave: Wave) -> Correction:
    """The encodable wave (MSLUT) nearest to what makes up for an error that was measured with `wave`.

    Its amplitude is that of `wave`, at most `AMPLITUDE_MAX`. Raises TooUneven.
    """
    return corrected_for(motor_error(measured, field_of(wave)), wave)


def corrected_for(motor: MotorError, wave: Wave) -> Correction:
    """The same for a motor whose own error is known."""
    added = added_angle(motor)
    amplitude = min(float(lengths(wave).mean()), AMPLITUDE_MAX)
    wanted = amplitude * np.sin(GRID + added)[:ENTRIES] + wave.mirror / 2
    found = nearest(wanted, wave.mirror).wave
    return Correction(
        wave=found,
        before=np.degrees(predicted(motor, field_of(wave))),
        after=np.degrees(predicted(motor, field_of(found))),
        beyond=np.degrees(predicted(motor, GRID + added)),
    )


def added_angle(motor: MotorError) -> FloatArray:
    """What a table of any resolution has to add to the angle on `GRID` [rad], so that nothing is left that it holds."""
    if 1 + np.diff(motor.values, append=motor.values[:1]).min() / (GRID[1] - GRID[0]) <= 0:
        raise TooUneven("the rotor would turn back while its field goes on")
    added = np.zeros(POSITIONS)
    for _ in range(ROUNDS):
        added -= quarter_part(predicted(motor, GRID + added))
    return added


def rms(error: FloatArray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(error**2)))


def _smooth(error: FloatArray) -> FloatArray:
    """Without its mean and what is finer than any order that was measured."""
    spectrum = np.fft.rfft(error)
    spectrum[0] = 0.0
    spectrum[HIGHEST + 1 :] = 0.0
    return np.fft.irfft(spectrum, len(error))
