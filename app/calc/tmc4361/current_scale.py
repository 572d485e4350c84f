"""Current scale of a TMC4361 over a motion: boost, drive and hold scales, the delays between them, freewheeling.

Exact in time: a scale that changes by one each so many clocks is a staircase, worked out stretch by stretch. Closed
loops set their scale by the deviation and have none of this.
Sources: NOTES-TMC4361-IO 9; what that leaves open is read as docs/tmc4361.md lists it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Literal

import numpy as np

from ...number_text import plain
from ..ramps.curve import FloatArray
from ..ramps.sramp_plan import JerkPiece, SRampPlan

Situation = Literal["drive", "drive 2", "boost", "hold", "freewheeling"]
FULL = 255
"""The scale without drive_current_scale_en: all of the driver's current."""
DELAY_MOST = (1 << 24) - 1


@dataclass(frozen=True, slots=True)
class CurrentSettings:
    """CURRENT_CONF, SCALE_VALUES and the delays, as the registers hold them; scales 0..255, times in clocks.

    Raises ValueError for a number that the registers cannot hold.
    """

    boost: int = FULL
    drive: int = FULL
    drive_2: int = FULL
    hold: int = FULL
    hold_en: bool = False
    drive_en: bool = False
    boost_on_acceleration: bool = False
    boost_on_deceleration: bool = False
    boost_after_start: bool = False
    drive_2_en: bool = False
    freewheeling_en: bool = False
    drive_2_above_pps: int = 0
    """VDRV_SCALE_LIMIT."""
    up_delay: int = 0
    hold_delay: int = 0
    drive_delay: int = 0
    """UP_SCALE_DELAY, HOLD_SCALE_DELAY, DRV_SCALE_DELAY: clocks that one step of the scale takes; 0: none."""
    boost_time: int = 0
    standby_delay: int = 0
    freewheel_delay: int = 0
    clock_hz: float = 16e6

    def __post_init__(self) -> None:
        for name in ("boost", "drive", "drive_2", "hold"):
            _within(name, getattr(self, name), FULL)
        for part in fields(self):
            if part.name.endswith(("_delay", "_time", "_pps")):
                most = 2**32 - 1 if part.name in ("standby_delay", "freewheel_delay") else DELAY_MOST
                _within(part.name, getattr(self, part.name), most)
        if not self.clock_hz > 0:
            raise ValueError(f"clock_hz is {plain(self.clock_hz)}, it has to be above 0")

    def seconds(self, clocks: int) -> float:
        return clocks / self.clock_hz

    @property
    def driving(self) -> int:
        """The scale in motion, when nothing else is asked for."""
        return self.drive if self.drive_en else FULL

    @property
    def settles_s(self) -> float:
        """How long after a motion the scale is still on its way, at most [s]."""
        down = FULL * self.seconds(self.hold_delay) if self.hold_en else FULL * self.seconds(self.drive_delay)
        free = self.seconds(self.freewheel_delay) if self.freewheeling_en else 0.0
        return self.seconds(self.standby_delay) + max(down, free)


@dataclass(frozen=True, slots=True)
class ScaleStretch:
    """A time in which one scale is asked for: from `scale_from` a staircase of one every `step_s` to `wanted`."""

    start_s: float
    end_s: float
    situation: Situation
    wanted: int
    scale_from: int
    step_s: float
    """0: at once."""
    lead_s: float
    """Of the first step so much has already gone by."""

    def at(self, time_s: FloatArray) -> FloatArray:
        """The scale at times within the stretch."""
        if self.step_s == 0.0 or self.wanted == self.scale_from:
            return np.full(time_s.shape, float(self.wanted))
        # a clock is at most 1/4.2 us: times that are a whole number of steps must not fall below it by rounding
        steps = np.floor((time_s - self.start_s + self.lead_s) / self.step_s + 1e-9)
        way = 1 if self.wanted > self.scale_from else -1
        return self.scale_from + way * np.minimum(steps, abs(self.wanted - self.scale_from))

    @property
    def lasts_s(self) -> float:
        return self.end_s - self.start_s

    @property
    def scale_to(self) -> int:
        return int(self.at(np.array([self.end_s]))[0])


@dataclass(frozen=True, slots=True)
class ScaleCourse:
    """The scale over a motion that begins at 0 s, and over the rest after it."""

    stretches: tuple[ScaleStretch, ...]
    scale_at_first: int
    duration_s: float

    def at(self, time_s: Sequence[float] | FloatArray) -> FloatArray:
        """The scale at `time_s`: 0..255, and -1 where the bridges are open (freewheeling)."""
        times = np.asarray(time_s, dtype=np.float64)
        starts = np.array([stretch.start_s for stretch in self.stretches])
        index = np.clip(np.searchsorted(starts, times, side="right") - 1, 0, len(starts) - 1)
        scale = np.empty(times.shape)
        for number in np.unique(index):
            stretch, here = self.stretches[number], index == number
            scale[here] = -1.0 if stretch.situation == "freewheeling" else stretch.at(times[here])
        return scale


def course(settings: CurrentSettings, plan: SRampPlan, duration_s: float | None = None) -> ScaleCourse:
    """The scale over a motion out of a long rest, and until a bit after it has settled or `duration_s` [s]."""
    moves = _moves(settings, plan)
    end_s = max(plan.duration_s + 1.1 * settings.settles_s if duration_s is None else duration_s, plan.duration_s)
    if plan.end_velocity_pps:
        moves += [(plan.duration_s, *_in_motion(settings, abs(plan.end_velocity_pps), 0, plan.duration_s))]
    else:
        moves += list(_after(settings, plan.duration_s))
    rested = settings.hold if settings.hold_en else settings.driving
    scale, lead_s = rested, 0.0
    stretches: list[ScaleStretch] = []
    for (start_s, situation, wanted), until in pairwise([*moves, (math.inf, "drive", 0)]):
        stop_s = min(until[0], end_s)
        if stop_s <= start_s:
            continue
        clocks = settings.hold_delay if situation == "hold" else settings.drive_delay
        if wanted > scale and situation != "hold":
            clocks = settings.up_delay
        stretch = ScaleStretch(start_s, stop_s, situation, wanted, scale, settings.seconds(clocks), lead_s)
        reached = stretch.scale_to
        took = stop_s - start_s + lead_s - abs(reached - scale) * stretch.step_s
        lead_s = max(took, 0.0) if reached != wanted else 0.0
        scale = reached
        stretches.append(stretch)
    if not stretches:  # nothing moves, and nobody asked for a time
        stretches.append(ScaleStretch(0.0, 0.0, "hold" if settings.hold_en else "drive", rested, rested, 0.0, 0.0))
    return ScaleCourse(tuple(_joined(stretches)), rested, end_s)


def findings(settings: CurrentSettings, plan: SRampPlan, found: ScaleCourse) -> list[str]:
    """What of the settings does not come about in this motion, or not as meant; in plain words."""
    said: list[str] = []
    met = {stretch.situation for stretch in found.stretches}
    fastest = max((abs(piece.velocity_at(t)) for piece in plan.pieces for t in (piece.start_s, piece.end_s)), default=0)
    if settings.drive_2_en and "drive 2" not in met:
        said.append(
            f"the second drive scale does not come about: this motion gets to {plain(round(fastest))} pps, "
            f"VDRV_SCALE_LIMIT is {plain(settings.drive_2_above_pps)} pps"
        )
    if settings.boost_after_start and not settings.boost_time:
        said.append("boost after a start lasts no time: BOOST_TIME is 0")
    boosts = settings.boost_on_acceleration or settings.boost_on_deceleration or settings.boost_after_start
    if boosts and settings.boost < settings.driving:
        said.append(f"boost is less than drive: scale {settings.boost} against {settings.driving}")
    for stretch in found.stretches:
        if stretch.situation == "boost" and stretch.wanted > stretch.scale_to:
            said.append(
                f"the boost ends at scale {stretch.scale_to} of {stretch.wanted}: UP_SCALE_DELAY lets the scale rise "
                f"by one every {plain(stretch.step_s * 1e6)} us, and it lasts {plain(stretch.lasts_s * 1e3)} ms"
            )
            break
    if (
        settings.freewheeling_en
        and settings.hold_en
        and settings.freewheel_delay < settings.hold_delay * abs(settings.driving - settings.hold)
    ):
        said.append("the motor is let go before its current has come down to hold: FREEWHEEL_DELAY is shorter")
    if settings.freewheeling_en:
        said.append("a freewheeling motor holds nothing: a load moves it")
    return said


# --- situations ------------------------------------------------------------------------------------------------------

Move = tuple[float, Situation, int]
"""From when on, in which situation, which scale is asked for."""


def _moves(settings: CurrentSettings, plan: SRampPlan) -> list[Move]:
    found: list[Move] = []
    for piece in plan.pieces:
        for start_s, end_s in pairwise(_cuts(settings, piece)):
            middle = (start_s + end_s) / 2
            velocity = piece.velocity_at(middle)
            slope = piece.acceleration_at(middle) * velocity
            found.append((start_s, *_in_motion(settings, abs(velocity), (slope > 0) - (slope < 0), middle)))
    return found


def _cuts(settings: CurrentSettings, piece: JerkPiece) -> list[float]:
    """Where something may change within a piece, its ends among them. Velocity is monotonous in a piece."""
    cuts = {piece.start_s, piece.end_s}
    boost_s = settings.seconds(settings.boost_time)
    if settings.boost_after_start and piece.start_s < boost_s < piece.end_s:
        cuts.add(boost_s)
    limit = float(settings.drive_2_above_pps)
    low, high = piece.start_s, piece.end_s
    if settings.drive_2_en and (abs(piece.velocity_at(low)) > limit) != (abs(piece.velocity_at(high)) > limit):
        above = abs(piece.velocity_at(low)) > limit
        while low < (middle := (low + high) / 2) < high:
            if (abs(piece.velocity_at(middle)) > limit) == above:
                low = middle
            else:
                high = middle
        cuts.add(high)
    return sorted(cuts)


def _in_motion(settings: CurrentSettings, speed_pps: float, slope: int, since_start_s: float) -> tuple[Situation, int]:
    """What is asked for at a speed that rises (slope 1), falls (-1) or stays, so long after the start."""
    if (
        (settings.boost_on_acceleration and slope > 0)
        or (settings.boost_on_deceleration and slope < 0)
        or (settings.boost_after_start and since_start_s <= settings.seconds(settings.boost_time))
    ):
        return "boost", settings.boost
    if settings.drive_2_en and speed_pps > settings.drive_2_above_pps:
        return "drive 2", settings.drive_2
    return "drive", settings.driving


def _after(settings: CurrentSettings, end_s: float) -> Iterator[Move]:
    """What is asked for once the motor stands."""
    yield end_s, "drive", settings.driving
    standby_s = end_s + settings.seconds(settings.standby_delay)
    if settings.hold_en:
        yield standby_s, "hold", settings.hold
    if settings.freewheeling_en:
        scale = settings.hold if settings.hold_en else settings.driving
        yield standby_s + settings.seconds(settings.freewheel_delay), "freewheeling", scale


def _joined(stretches: Sequence[ScaleStretch]) -> Iterator[ScaleStretch]:
    """Neighbours that are one and the same staircase as one."""
    held: ScaleStretch | None = None
    for stretch in stretches:
        if held and (held.situation, held.wanted, held.step_s) == (stretch.situation, stretch.wanted, stretch.step_s):
            held = ScaleStretch(
                held.start_s, stretch.end_s, held.situation, held.wanted, held.scale_from, held.step_s, held.lead_s
            )
            continue
        if held:
            yield held
        held = stretch
    if held:
        yield held


def _within(name: str, value: int, most: int) -> None:
    if not 0 <= value <= most:
        raise ValueError(f"{name} is {value}, allowed is 0..{most}")
