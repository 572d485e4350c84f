"""The SixPoint ramp of the TMC5160 in continuous time: what a PD42-1241 does with MVP, ROR, ROL and MST.

VSTART -A1-> V1 -AMAX-> VMAX -DMAX-> V1 -D1-> VSTOP, then a dead stop at the target. V1 = 0 leaves A1 and D1 out, which
makes a trapezoid; a short move turns round below VMAX, maybe below V1. A velocity below VSTART is skipped when
starting, one below VSTOP when stopping. Turning round takes a stop, and TZEROWAIT there.

Some chips have two more corners: V1 -A2-> V2 -AMAX-> VMAX -DMAX-> V2 -D2-> V1, where V2 is above V1 (else there is no
such segment), and TVMAX, the least time at constant velocity between speeding up and braking.

The chip works this out clock by clock; the curve here is what its units and parameters mean, without its rounding.

Sources: FM-PD42-1241 1.3 and 7.5, where the last leg down is D1 (its text once calls it D2)
and the trapezoid brakes with parameter 17; velocity mode uses the maximum acceleration both ways (FM-PD42-1241 1.3). V2
and TVMAX: FIELDS-TMC5240, A2, D2 and TVMAX (its V2 is of an older design).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, fields
from itertools import accumulate, pairwise
from typing import NamedTuple

from ...number_text import plain
from .sixpoint_plan import MotionPlan, Piece

__all__ = ["MotionPlan", "SixPoint", "position_plan", "velocity_plan"]

ALMOST = 1e-9
"""Relative: a way that is shorter than the braking distance by less than this was meant to be just as long."""
POSITION_LIMIT = 1 << 32


@dataclass(frozen=True)
class SixPoint:
    """The ramp's parameters. Velocities in pps, accelerations in pps^2, none negative.

    v_max, a_max : above 0. d_max : above 0 for positioning, where it brakes
    v1 : 0 leaves a1 and d1 out; else both are above 0 where the ramp gets to them
    t_zero_wait_s : pause at standstill before turning round (TZEROWAIT) [s]
    v2 : a2 and d2 hold from v1 to there; not above v1 leaves them out
    t_v_max_s : least time at constant velocity between speeding up and braking for a target (TVMAX) [s]

    Raises ValueError for a number below 0 or not finite, and where v_max or a_max is 0.
    """

    v_max: float
    a_max: float
    d_max: float = 0.0
    v_start: float = 0.0
    a1: float = 0.0
    v1: float = 0.0
    d1: float = 0.0
    v_stop: float = 0.0
    t_zero_wait_s: float = 0.0
    v2: float = 0.0
    a2: float = 0.0
    d2: float = 0.0
    t_v_max_s: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            number = getattr(self, field.name)
            if not (math.isfinite(number) and number >= 0):
                raise ValueError(f"{field.name} is finite and not below 0, got {number}")
        for name in ("v_max", "a_max"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} is above 0: with 0 the motor never moves")


def position_plan(parameters: SixPoint, distance: float, v_actual: float = 0.0) -> MotionPlan:
    """A move by `distance` [microsteps, signed] that begins at velocity `v_actual` [pps, signed].

    A motor that runs the wrong way, or too fast to brake within `distance`, brakes to a stop, waits, and comes back.

    Raises ValueError: |distance| of 2^32 or more, a deceleration that is needed and 0, v_start above v_stop where the
    way is too short to brake from it.
    """
    if not (math.isfinite(distance) and abs(distance) < POSITION_LIMIT):
        raise ValueError(f"distance is below 2^32 microsteps, got {distance}")
    if not math.isfinite(v_actual):
        raise ValueError(f"v_actual is finite, got {v_actual}")
    track = _Track()
    speed, way = abs(v_actual), math.copysign(1.0, v_actual)
    down = _Slope.braking(parameters)
    overshoot, arrival_s = 0.0, math.nan
    on_the_way = v_actual * distance > 0 and _fits(down.length(parameters.v_stop, speed), abs(distance))
    if speed and not on_the_way:
        track.go(way, down.pieces(speed, min(parameters.v_stop, speed)))
        beyond = way * (track.position - distance)
        if distance * way >= 0:
            overshoot = max(beyond, 0.0)
            arrival_s = track.time_when(distance)
        track.wait(parameters.t_zero_wait_s if track.position != distance else 0.0)
        speed = 0.0
    left = distance - track.position
    cruises = False
    if left:
        way = math.copysign(1.0, left)
        if not speed:
            speed = min(parameters.v_start, parameters.v_max)
            if not _fits(down.length(parameters.v_stop, speed), abs(left)):
                raise ValueError(
                    f"v_start {plain(parameters.v_start)} pps is too fast to stop within {plain(abs(left))} "
                    "microsteps; v_start is not to be above v_stop"
                )
            if parameters.t_v_max_s:  # a start takes no more of v_start than the way allows for that too
                kept = abs(left) - down.length(parameters.v_stop, speed)
                speed = min(speed, max(kept, 0.0) / parameters.t_v_max_s)
        cruises = track.arrive(way, distance, _way_to(parameters, abs(left), speed))
    return MotionPlan(
        pieces=track.finished(),
        duration_s=track.time_s,
        end_position=distance,
        end_velocity_pps=0.0,
        overshoot=overshoot,
        arrival_s=track.time_s if math.isnan(arrival_s) else arrival_s,
        cruises=cruises,
    )


def velocity_plan(parameters: SixPoint, v_target: float, v_actual: float = 0.0) -> MotionPlan:
    """From `v_actual` to `v_target` [pps, signed], and on at that; a stop (MST) where `v_target` is 0.

    Both ways by a_max. v_max, d_max, v1, a1 and d1 have no part in it.

    Raises ValueError for a velocity that is not finite.
    """
    for name, number in (("v_actual", v_actual), ("v_target", v_target)):
        if not math.isfinite(number):
            raise ValueError(f"{name} is finite, got {number}")
    track = _Track()
    up = _Slope.constant(parameters.a_max, "acceleration")
    down = _Slope.constant(parameters.a_max, "deceleration")
    speed, way = abs(v_actual), math.copysign(1.0, v_actual)
    if speed and v_actual * v_target <= 0:
        track.go(way, down.pieces(speed, min(parameters.v_stop, speed)))
        track.wait(parameters.t_zero_wait_s if v_target else 0.0)
        speed = 0.0
    if v_target:
        way = math.copysign(1.0, v_target)
        if not speed:
            speed = min(parameters.v_start, abs(v_target))
        track.go(way, (up if abs(v_target) > speed else down).pieces(speed, abs(v_target)))
    return MotionPlan(
        pieces=track.finished(),
        duration_s=track.time_s,
        end_position=track.position,
        end_velocity_pps=float(v_target),
        arrival_s=track.time_s,
    )


# --- how it is worked out -------------------------------------------------------------------------

_Leg = tuple[str, float, float, float]
"""Name, speed at the start and at the end [pps], change of speed [pps^2]: 0 for a stretch of constant speed, whose
length in microsteps is then where the speed at the end would be."""


def _fits(needed: float, available: float) -> bool:
    return needed <= available * (1 + ALMOST)


class _Part(NamedTuple):
    """An acceleration that holds from a speed on [pps, pps^2]. name : of the register."""

    above: float
    rate: float
    name: str


@dataclass(frozen=True)
class _Slope:
    """Accelerations one above the other: `parts` by rising speed, the first from 0 on. `word` is what they do."""

    word: str
    parts: tuple[_Part, ...]

    @classmethod
    def accelerating(cls, p: SixPoint) -> _Slope:
        return cls("acceleration", _parts(p, ((p.a1, "A1"), (p.a2, "A2"), (p.a_max, "AMAX"))))

    @classmethod
    def braking(cls, p: SixPoint) -> _Slope:
        return cls("deceleration", _parts(p, ((p.d1, "D1"), (p.d2, "D2"), (p.d_max, "DMAX"))))

    @classmethod
    def constant(cls, rate: float, word: str) -> _Slope:
        return cls(word, (_Part(0.0, rate, "AMAX"),))

    def part(self, speed: float) -> _Part:
        """What holds just above `speed`. Raises ValueError where that is no acceleration at all."""
        part = next(part for part in reversed(self.parts) if speed >= part.above)
        if not part.rate > 0:
            name = part.name.lower().replace("max", "_max")
            raise ValueError(f"{name} is 0 and needed: with 0 the speed never changes")
        return part

    def rate(self, speed: float) -> float:
        """The acceleration just above `speed`. Raises ValueError where it is 0."""
        return self.part(speed).rate

    def length(self, slow: float, fast: float) -> float:
        """Microsteps between two speeds, 0 where `fast` is not above `slow`."""
        return sum((u1 - u0) * (u1 + u0) / (2 * rate) for _, u0, u1, rate in self._rising(slow, fast))

    def pieces(self, start: float, end: float) -> list[_Leg]:
        """From one speed to another, up or down."""
        if end >= start:
            return self._rising(start, end)
        return [(name, u1, u0, -rate) for name, u0, u1, rate in reversed(self._rising(end, start))]

    def _rising(self, slow: float, fast: float) -> list[_Leg]:
        marks = [slow, *(part.above for part in self.parts if slow < part.above < fast), fast]
        legs = []
        for u0, u1 in pairwise(marks):
            if u1 > u0:
                part = self.part(u0)
                legs.append((f"{self.word} {part.name}", u0, u1, part.rate))
        return legs


def _parts(p: SixPoint, rates: Iterable[tuple[float, str]]) -> tuple[_Part, ...]:
    """The three accelerations of a ramp where they hold."""
    (first, name1), (second, name2), (last, name3) = rates
    lower = (_Part(0.0, first, name1),) if p.v1 > 0 else ()
    middle = (_Part(p.v1, second, name2),) if p.v2 > p.v1 else ()
    return (*lower, *middle, _Part(max(p.v1, p.v2), last, name3))


def _way_to(p: SixPoint, left: float, speed: float) -> tuple[list[_Leg], list[_Leg], bool]:
    """Legs from `speed` over `left` microsteps onto the target: before the last braking, that, and if it cruises."""
    up, down = _Slope.accelerating(p), _Slope.braking(p)
    if speed > p.v_max:
        slowing = down.pieces(speed, p.v_max)
        cruise = left - down.length(p.v_max, speed) - down.length(p.v_stop, p.v_max)
        if cruise < 0 and p.v_max < p.v_stop:  # at the target before it is as slow as it was to be
            return [], _cut(slowing, left), False
        before = [*slowing, _constant(p.v_max, max(cruise, 0.0))]
        return before, down.pieces(p.v_max, min(p.v_stop, p.v_max)), cruise > 0
    cruise = left - up.length(speed, p.v_max) - down.length(p.v_stop, p.v_max)
    if cruise >= p.t_v_max_s * p.v_max:
        before = [*up.pieces(speed, p.v_max), _constant(p.v_max, cruise)]
        return before, down.pieces(p.v_max, min(p.v_stop, p.v_max)), cruise > 0
    peak = _peak(p, left, speed)
    before, braking = up.pieces(speed, peak), down.pieces(peak, min(p.v_stop, peak))
    if p.t_v_max_s:
        before.append(_constant(peak, max(left - up.length(speed, peak) - down.length(p.v_stop, peak), 0.0)))
    return before, braking, False


def _peak(p: SixPoint, left: float, speed: float) -> float:
    """The highest speed of a move that does not reach v_max, or not for t_v_max_s.

    Way up and way down are linear in the square of the speed, between the speeds at which another acceleration takes
    over, and what is kept at the peak in the speed itself: the peak is found on the one of these parabolas that crosses
    `left`.
    """
    up, down = _Slope.accelerating(p), _Slope.braking(p)
    marks = sorted({speed, p.v_max, *(mark for mark in (p.v1, p.v2, p.v_stop) if speed < mark < p.v_max)})
    kept = p.t_v_max_s
    gone = down.length(p.v_stop, speed) + kept * speed
    for slow, fast in pairwise(marks):
        per_square = 0.5 / up.rate(slow) + (0.5 / down.rate(slow) if slow >= p.v_stop else 0.0)
        step = (fast - slow) * ((fast + slow) * per_square + kept)
        if gone + step >= left:
            half = kept / (2 * per_square)
            root = math.sqrt((slow + half) ** 2 + max(left - gone, 0.0) / per_square)
            return min(root - half, fast)
        gone += step
    return p.v_max


def _cut(legs: list[_Leg], left: float) -> list[_Leg]:
    """The beginning of `legs`, `left` microsteps long."""
    cut: list[_Leg] = []
    for name, u0, u1, rate in legs:
        length = (u1 - u0) * (u1 + u0) / (2 * rate)
        if length >= left:
            cut.append((name, u0, math.sqrt(max(u0 * u0 + 2 * rate * left, 0.0)), rate))
            break
        cut.append((name, u0, u1, rate))
        left -= length
    return cut


def _constant(speed: float, length: float) -> _Leg:
    return "constant velocity", speed, length, 0.0


class _Track:
    """Pieces put one after the other."""

    def __init__(self) -> None:
        self.time_s = 0.0
        self.position = 0.0
        self._pieces: list[Piece] = []

    def go(self, way: float, legs: list[_Leg]) -> None:
        for leg in legs:
            duration_s, length = _extent(leg)
            name, speed, _, rate = leg
            self._add(Piece(name, self.time_s, 0.0, self.time_s, self.position, way * speed, way * rate), duration_s)
            self.position += way * length

    def wait(self, duration_s: float) -> None:
        if duration_s > 0:
            self._add(Piece("wait", self.time_s, 0.0, self.time_s, self.position, 0.0, 0.0), duration_s)

    def arrive(self, way: float, target: float, legs: tuple[list[_Leg], list[_Leg], bool]) -> bool:
        """The last move, onto `target`; returns whether it cruises."""
        before, braking, cruises = legs
        self.go(way, before)
        extents = [_extent(leg) for leg in braking]
        marks_s = list(accumulate((duration_s for duration_s, _ in extents), initial=self.time_s))
        end, last = target, []
        for index in range(len(braking) - 1, -1, -1):
            name, _, speed, rate = braking[index]
            begin_s, end_s = marks_s[index], marks_s[index + 1]
            last.append(Piece(name, begin_s, end_s, end_s, end, way * speed, way * rate))
            end -= way * extents[index][1]
        self._pieces += reversed(last)
        self.time_s = marks_s[-1]
        self.position = target
        return cruises

    def time_when(self, position: float) -> float:
        """When `position` is passed for the first time [s]; NaN where it is not."""
        for piece in self._pieces:
            begin, end = piece.position_at(piece.start_s), piece.position_at(piece.end_s)
            if min(begin, end) <= position <= max(begin, end):
                # From the faster end of the piece: the speed never changes sign inside of it.
                speed, rate, gap = abs(piece.velocity_pps), abs(piece.acceleration_pps2), abs(position - begin)
                root = math.sqrt(max(speed * speed - 2 * rate * gap, 0.0))
                return piece.start_s + (2 * gap / (speed + root) if speed + root > 0 else 0.0)
        return math.nan

    def finished(self) -> tuple[Piece, ...]:
        """Raises ValueError where it takes longer than a number can say."""
        if not math.isfinite(self.time_s):
            raise ValueError("the motion takes longer than a number can say: raise v_max or the accelerations")
        return tuple(self._pieces)

    def _add(self, piece: Piece, duration_s: float) -> None:
        self.time_s += duration_s
        self._pieces.append(
            Piece(
                piece.name,
                piece.start_s,
                self.time_s,
                piece.anchor_s,
                piece.position,
                piece.velocity_pps,
                piece.acceleration_pps2,
            )
        )


def _extent(leg: _Leg) -> tuple[float, float]:
    """How long a leg takes [s], and its length [microsteps]."""
    _, start, end, rate = leg
    if rate == 0:
        return end / start, end
    return (end - start) / rate, (end - start) * (end + start) / (2 * rate)
