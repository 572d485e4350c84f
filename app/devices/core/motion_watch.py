"""What ended a motion, and when: a module tells nobody, so it has to be polled.

Polls come from telemetry where that asks for position, speed and arrival anyway, from whoever reads
the axis, and else from a task that asks ten times a second while a motion is under way. A motor that
rests is not always at its end (a ramp wait time, a reference search between two legs), so all but an
arrival and a stop on command need a while of rest before they are called one.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from .results import MotionEnd, StopReason

Kind = Literal["position", "velocity", "search", "unknown"]
"""What drives a motion: a target, a speed, the module's reference search, or nobody here knows."""
KEPT = 200
POLL_S = 0.1
"""How often the module is asked while a motion is under way and nobody else asks [s]."""
REST_S = 0.15
"""How long a motor has to rest before that is called the end of its motion [s], ramp wait time apart."""


@dataclass(frozen=True, slots=True)
class MotionReading:
    """The axis at one moment: position [microsteps], speed in any unit, whether it is at its target."""

    time_s: float
    position: int
    speed: float
    reached: bool


@dataclass(slots=True)
class UnderWay:
    """A motion that has not ended yet."""

    kind: Kind
    began_s: float
    target: int | None
    seen_s: float
    """Until when it is known to have been under way."""
    direction: int = 0
    stopped_s: float | None = None
    """When a stop was commanded."""
    rest: MotionReading | None = None
    """The first reading at rest, if the latest was one as well."""
    position: int | None = None


class MotionWatch:
    """One axis. `tell` hears of each end; `wake` has to see to it that readings come while a motion is under way."""

    def __init__(self, axis: int, tell: Callable[[MotionEnd], None], wake: Callable[[], None]) -> None:
        self._axis = axis
        self._tell = tell
        self._wake = wake
        self._ends: deque[MotionEnd] = deque(maxlen=KEPT)
        self.under_way: UnderWay | None = None
        self.polled_s = float("-inf")
        """When the latest reading was taken, device time [s]."""
        self._ended_s = float("-inf")
        """When the latest motion was seen to have ended, device time [s]."""
        self.wait_s = 0.0
        """How long the module may rest between two legs, of its ramp wait time [s]."""

    @property
    def ends(self) -> tuple[MotionEnd, ...]:
        return tuple(self._ends)

    def began(self, kind: Kind, time_s: float, target: int | None = None) -> None:
        """A motion was commanded; one that was under way goes over into it."""
        direction = self.under_way.direction if self.under_way is not None else 0
        self.under_way = UnderWay(kind, time_s, target, time_s, direction)
        self._wake()

    def stop_commanded(self, time_s: float) -> None:
        """Whatever is under way is to end; nothing happens where nothing is."""
        if self.under_way is not None:
            self.under_way.stopped_s, self.under_way.rest = time_s, None

    def update(self, reading: MotionReading, spread_s: float = 0.0) -> None:
        """Take in a reading; `spread_s` [s] lay between the first and the last question of it."""
        self.polled_s = max(self.polled_s, reading.time_s)
        motion = self.under_way
        if motion is None:
            # Polls come from several sides: one from before the end that another has seen is no new motion.
            if reading.speed and reading.time_s - spread_s > self._ended_s:
                self.began("unknown", reading.time_s)
                self.update(reading)
            return
        if reading.time_s - spread_s < motion.seen_s:
            return  # partly from before the command
        motion.position = reading.position
        if reading.speed:
            motion.seen_s, motion.rest = reading.time_s, None
            motion.direction = 1 if reading.speed > 0 else -1
        elif motion.rest is None or motion.rest.position != reading.position:
            motion.rest = reading
        if motion.rest is None or reading.speed or motion.kind == "search":
            return
        if motion.stopped_s is not None and reading.time_s >= motion.stopped_s:
            self.end("stop_command", "stopped on command")
        elif motion.kind == "position" and reading.reached and motion.target in (None, reading.position):
            self.end("target_reached", "at its target")

    def at_rest(self, now_s: float) -> tuple[UnderWay, MotionReading] | None:
        """The motion under way and since when it rests, where that is long enough to ask why."""
        motion = self.under_way
        if motion is None or motion.rest is None or now_s - motion.rest.time_s < REST_S + self.wait_s:
            return None
        return motion, motion.rest

    def end(self, reason: StopReason, detail: str) -> None:
        """The motion under way has ended."""
        motion, self.under_way = self.under_way, None
        if motion is None:
            return
        rest = motion.rest
        self._ended_s = motion.seen_s if rest is None else rest.time_s
        if rest is None:
            time_s, position = motion.seen_s, None if reason == "lost_link" else motion.position
        else:
            time_s, position = (motion.seen_s + rest.time_s) / 2, rest.position
        end = MotionEnd(self._axis, reason, time_s, time.time(), position, detail)
        self._ends.append(end)
        self._tell(end)
