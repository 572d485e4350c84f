"""A motion of pieces with constant jerk, in continuous time: the plan of every ramp type of a TMC4361.

Positions count microsteps from the start of the motion, times seconds from there; all are signed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...number_text import plain
from .curve import FloatArray, Phase, RampCurve, check_samples

# Relative to the size of the motion: a turning point that is beyond the target by less than this is on it.
_ON_TARGET = 1e-9


class JerkPiece(NamedTuple):
    """A stretch of constant jerk (a tuple, because plans are made by the thousand and these are most of their cost).

    x + v * t + a * t^2 / 2 + j * t^3 / 6, with t counted from `anchor_s`: the start of most pieces, the end of those
    that brake onto the target, so that the motion ends on it and not beside it. `position`, `velocity_pps` and
    `acceleration_pps2` are those at the anchor.

    name : the data sheet's phase: B1, B12, B2, B23, B3, B34, B4 of an S-ramp (DS-TMC4361 8.2), A1L, A1, A2, A3, A3L
        of a trapezoid, HOLD of a rectangle. On the way through velocity 0 the phases of braking are followed by those
        of accelerating; phases that take no time are left out.
    """

    name: str
    start_s: float
    end_s: float
    anchor_s: float
    position: float
    velocity_pps: float
    acceleration_pps2: float
    jerk_pps3: float

    def position_at(self, time_s: float) -> float:
        """[microsteps]"""
        t = time_s - self.anchor_s
        return self.position + t * (self.velocity_pps + t * (self.acceleration_pps2 / 2 + t * self.jerk_pps3 / 6))

    def velocity_at(self, time_s: float) -> float:
        """[pps]"""
        t = time_s - self.anchor_s
        return self.velocity_pps + t * (self.acceleration_pps2 + t * self.jerk_pps3 / 2)

    def acceleration_at(self, time_s: float) -> float:
        """[pps^2]"""
        return self.acceleration_pps2 + (time_s - self.anchor_s) * self.jerk_pps3


@dataclass(frozen=True)
class SRampMotion:
    """Samples: position [microsteps from the start], velocity [pps], acceleration [pps^2], jerk [pps^3].

    All in the shape of the times. Where a value jumps (velocity at VSTART and VSTOP) a sample has what follows.
    """

    position: FloatArray
    velocity_pps: FloatArray
    acceleration_pps2: FloatArray
    jerk_pps3: FloatArray


@dataclass(frozen=True)
class SRampCurve(RampCurve):
    """A `RampCurve` with the jerk of its samples [pps^3]."""

    jerk_pps3: FloatArray = field(kw_only=True)


class RampWarning(NamedTuple):
    """Something that the data sheet warns of, or that makes a parameter idle.

    code : stable, for programs, for example "vmax_not_reached"
    values : the numbers of `text`, in pps, pps^2 and microsteps
    template : what `text` makes of them, when it is read
    """

    code: str
    template: str
    values: tuple[float, ...]

    @property
    def text(self) -> str:
        """For people, with the numbers."""
        return self.template.format(*map(plain, self.values))


class LimitUse(NamedTuple):
    """How much of a limit a motion uses: `name` (VMAX, AMAX, DMAX), `limit` and `peak` in `unit`, both not negative."""

    name: str
    limit: float
    peak: float
    unit: str

    @property
    def reached(self) -> bool:
        return self.peak >= self.limit * (1 - 1e-9)


@dataclass(frozen=True)
class SRampPlan:
    """A whole motion, to be sampled at any times.

    pieces : in order, without gaps, each of a duration above 0
    duration_s : when the target is reached and the motor at rest; in velocity mode, when the velocity is reached [s]
    end_position : where it is then [microsteps from the start]; the distance itself, exactly, in positioning mode
    end_velocity_pps : velocity from then on: 0 after a move
    target : the distance asked for [microsteps], None in velocity mode
    warnings, limits : see `RampWarning`, `LimitUse`
    """

    pieces: tuple[JerkPiece, ...]
    duration_s: float
    end_position: float
    end_velocity_pps: float
    target: float | None = None
    warnings: tuple[RampWarning, ...] = ()
    limits: tuple[LimitUse, ...] = ()

    @cached_property
    def _table(self) -> FloatArray:
        """Rows end, anchor, x, v, a, j; one column a piece, and one for all that comes after."""
        columns = [
            (p.end_s, p.anchor_s, p.position, p.velocity_pps, p.acceleration_pps2, p.jerk_pps3) for p in self.pieces
        ]
        columns.append((math.inf, self.duration_s, self.end_position, self.end_velocity_pps, 0.0, 0.0))
        return np.array(columns, dtype=np.float64).T

    def at(self, time_s: ArrayLike) -> SRampMotion:
        """The motion at `time_s` [s from the start], finite and of any shape; before the start as at the start.

        From `duration_s` on it rests, or turns on at its velocity.
        """
        times = np.maximum(np.asarray(time_s, dtype=np.float64), 0.0)
        ends, anchors, x, v, a, j = self._table
        index = np.searchsorted(ends, times, side="right")
        t, jerk, acceleration, velocity = times - anchors[index], j[index], a[index], v[index]
        return SRampMotion(
            position=x[index] + t * (velocity + t * (acceleration / 2 + t * (jerk / 6))),
            velocity_pps=velocity + t * (acceleration + t * (jerk / 2)),
            acceleration_pps2=acceleration + t * jerk,
            jerk_pps3=jerk,
        )

    @cached_property
    def phases(self) -> tuple[Phase, ...]:
        """The pieces as the other calculators name them."""
        return tuple(
            Phase(
                piece.name,
                piece.start_s,
                piece.end_s,
                piece.position_at(piece.start_s),
                piece.position_at(piece.end_s),
                piece.velocity_at(piece.start_s),
                piece.velocity_at(piece.end_s),
            )
            for piece in self.pieces
        )

    @cached_property
    def overshoot(self) -> float:
        """Farthest beyond the target before the motor rests on it [microsteps], 0 where it never is beyond it.

        A motor that runs away from the target when the motion starts has not been there: that is no overshoot.
        """
        return 0.0 if self.target is None else overshoot_of(self.pieces, self.target)

    @cached_property
    def arrival_s(self) -> float:
        """When the target is reached for the first time: `duration_s` without overshoot [s]."""
        if not self.overshoot or self.target is None:
            return self.duration_s
        for piece in self.pieces:
            start, end = (piece.position_at(t) - self.target for t in (piece.start_s, piece.end_s))
            if start == 0 or start * end < 0:
                return _crossing(piece, self.target)
        return self.duration_s

    @property
    def shape(self) -> str:
        """Is "trapezoid" where a stretch of constant velocity is reached, else "triangle"; "velocity" or "rest"."""
        if self.target is None and self.end_velocity_pps:
            return "velocity"
        if not self.pieces:
            return "rest"
        cruises = any(piece.jerk_pps3 == piece.acceleration_pps2 == 0 for piece in self.pieces)
        return "trapezoid" if cruises else "triangle"

    def curve(self, samples: int = 1000, duration_s: float | None = None) -> SRampCurve:
        """The motion sampled evenly, the last sample at the end.

        duration_s : until when [s]; None for the plan's own

        Raises ValueError for a number of samples that cannot be.
        """
        check_samples(samples)
        end_s = self.duration_s if duration_s is None else duration_s
        time_s = np.linspace(0.0, end_s, samples)
        motion = self.at(time_s)
        phases = self.phases
        if end_s > self.duration_s and self.end_velocity_pps:
            after = Phase(
                "B23",
                self.duration_s,
                end_s,
                self.end_position,
                float(motion.position[-1]),
                self.end_velocity_pps,
                self.end_velocity_pps,
            )
            phases += (after,)
        return SRampCurve(
            duration_s=end_s,
            shape=self.shape,
            phases=phases,
            time_s=time_s,
            position=motion.position,
            velocity_pps=motion.velocity_pps,
            acceleration_pps2=motion.acceleration_pps2,
            jerk_pps3=motion.jerk_pps3,
            overshoot_steps=math.ceil(self.overshoot - 1e-6),
            settled=self.end_velocity_pps == 0,
            settling_s=self.duration_s - self.arrival_s,
        )


def overshoot_of(pieces: Sequence[JerkPiece], target: float) -> float:
    """`SRampPlan.overshoot`."""
    if not pieces:
        return 0.0
    # Velocity keeps its sign within a piece, so the farthest places are where pieces meet.
    places = [0.0, *(piece.position_at(piece.end_s) for piece in pieces)]
    way = math.copysign(1.0, target) if target else math.copysign(1.0, pieces[0].velocity_at(0.0))
    beyond = max(way * (place - target) for place in places)
    return beyond if beyond > _ON_TARGET * max(abs(place) for place in places) else 0.0


def _crossing(piece: JerkPiece, place: float) -> float:
    """When a piece in which velocity keeps its sign is at `place` [s], to the last bit by halving."""
    before, after = piece.start_s, piece.end_s
    rising = piece.position_at(after) > piece.position_at(before)
    while True:
        middle = (before + after) / 2
        if not before < middle < after:
            return after
        if (piece.position_at(middle) < place) == rising:
            before = middle
        else:
            after = middle
