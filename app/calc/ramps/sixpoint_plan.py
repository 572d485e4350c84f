"""A motion of pieces with constant acceleration, in continuous time: where it is at any moment, and its phases."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from .curve import FloatArray, Phase, RampCurve, check_samples


@dataclass(frozen=True)
class Piece:
    """A stretch of constant acceleration; signed, from the start of the motion on.

    position + velocity * t + acceleration * t^2 / 2, with t counted from `anchor_s`: the start of most pieces, the end
    of those that brake onto the target, so that the motion ends on it and not beside it.
    """

    name: str
    start_s: float
    end_s: float
    anchor_s: float
    position: float
    velocity_pps: float
    acceleration_pps2: float

    def position_at(self, time_s: float) -> float:
        t = time_s - self.anchor_s
        return self.position + (self.velocity_pps + self.acceleration_pps2 * t / 2) * t

    def velocity_at(self, time_s: float) -> float:
        return self.velocity_pps + self.acceleration_pps2 * (time_s - self.anchor_s)


@dataclass(frozen=True)
class Motion:
    """Samples: position [microsteps from the start], velocity [pps], acceleration [pps^2], in the shape of the times.

    Where velocity jumps (VSTART, VSTOP) a sample has what follows.
    """

    position: FloatArray
    velocity_pps: FloatArray
    acceleration_pps2: FloatArray


@dataclass(frozen=True)
class MotionPlan:
    """A whole motion, to be sampled at any times.

    pieces : in order, without gaps
    duration_s : when the target is reached and the motor at rest; of a rotation, when its velocity is reached [s]
    end_position : where it is then [microsteps from the start]
    end_velocity_pps : velocity from then on: 0 after a move
    overshoot : farthest beyond the target [microsteps]
    arrival_s : when the target is first reached, `duration_s` without overshoot [s]
    cruises : whether a stretch of the highest velocity is reached
    """

    pieces: tuple[Piece, ...]
    duration_s: float
    end_position: float
    end_velocity_pps: float
    overshoot: float = 0.0
    arrival_s: float = 0.0
    cruises: bool = False

    @cached_property
    def _table(self) -> FloatArray:
        """Rows end, anchor, position, velocity, acceleration; one column a piece, and one for all that comes after."""
        columns = [(p.end_s, p.anchor_s, p.position, p.velocity_pps, p.acceleration_pps2) for p in self.pieces]
        columns.append((math.inf, self.duration_s, self.end_position, self.end_velocity_pps, 0.0))
        return np.array(columns, dtype=np.float64).T

    def at(self, time_s: ArrayLike) -> Motion:
        """The motion at `time_s` [s from the start], finite and of any shape; before the start as at the start.

        After `duration_s` it rests, or turns on at its velocity.
        """
        times = np.maximum(np.asarray(time_s, dtype=np.float64), 0.0)
        ends, anchors, positions, velocities, accelerations = self._table
        index = np.searchsorted(ends, times, side="right")
        t, acceleration = times - anchors[index], accelerations[index]
        velocity = velocities[index] + acceleration * t
        return Motion(positions[index] + (velocities[index] + velocity) / 2 * t, velocity, acceleration)

    @property
    def phases(self) -> tuple[Phase, ...]:
        """Every piece that lasts."""
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
            if piece.end_s > piece.start_s
        )

    def curve(self, samples: int = 1000, duration_s: float | None = None) -> RampCurve:
        """The motion sampled evenly, the last sample at the end.

        duration_s : until when [s]; None for the plan's own

        Raises ValueError for a number of samples that cannot be.
        """
        check_samples(samples)
        end_s = self.duration_s if duration_s is None else duration_s
        time_s = np.linspace(0.0, end_s, samples)
        motion = self.at(time_s)
        phases = self.phases
        if end_s > self.duration_s:
            end = self.at(end_s)
            phases += (
                Phase(
                    "constant velocity",
                    self.duration_s,
                    end_s,
                    self.end_position,
                    float(end.position),
                    self.end_velocity_pps,
                    self.end_velocity_pps,
                ),
            )
        shape = "trapezoid" if self.cruises else "triangle"
        if self.end_velocity_pps:
            shape = "velocity"
        return RampCurve(
            duration_s=end_s,
            shape=shape if phases else "rest",
            phases=phases,
            time_s=time_s,
            position=motion.position,
            velocity_pps=motion.velocity_pps,
            acceleration_pps2=motion.acceleration_pps2,
            overshoot_steps=math.ceil(self.overshoot - 1e-6),
            settled=self.end_velocity_pps == 0,
            settling_s=self.duration_s - self.arrival_s,
        )
