"""Reference search (FM-PD42-1241 7.1): a state machine on the events of the drive.

The drawings of the manual are lost; what its texts leave open is decided here.
- A stop switch is searched fast, left slowly, and entered slowly again. Modes 1 and 2 take the place where it closes
  then; modes 3 and 4 the middle between where it opened and where it closed: an end switch can be approached from both
  sides only as far as it has two switching points, for behind it is the end of the stage.
- A home switch has two edges: it is left backwards, entered slowly from this side, crossed, and entered slowly from the
  other side. Zero is the middle of both entries.
- Modes 5 and 6 turn round at the stop switch that their text names, once. If the home switch is not found then, the
  search stands at the other stop switch until it is stopped.
- Stop switches stop the motor whatever parameters 12 and 13 say; in modes 7 and 8 they do not.
- At the end the motor stands at zero, and both encoder counters are zero with it: else the deviation would be wrong.
"""

from __future__ import annotations

from collections.abc import Generator
from enum import IntEnum
from typing import Protocol

from ...registers.tmcl.commands import HOME_INVERTED, SWAPPED
from ..drive import EventKind

LEFT, RIGHT = -1, 1
DIRECTION_7_AND_8 = (RIGHT, LEFT)
"""Where modes 7 and 8 search: TMCL-RS says so of the sister modules, PD42-1240 included, as do programs for others.
FM-PD42-1241 says to the right for both, which cannot be; a sister has this in its
table, and the opposite in its chapter."""
WATCHED = (
    EventKind.SWITCH_LEFT
    | EventKind.SWITCH_RIGHT
    | EventKind.SWITCH_HOME
    | EventKind.STOPPED
    | EventKind.POSITION_REACHED
)


class Phase(IntEnum):
    """What RFS STATUS answers; only that 0 means "no search" is known."""

    NONE = 0
    FAST = 1
    OTHER_END = 2
    LEAVE = 3
    ENTER = 4
    CROSS = 5
    RE_ENTER = 6
    TO_ZERO = 7


PHASE_TEXTS = {
    Phase.NONE: "",
    Phase.FAST: "looking for the switch",
    Phase.OTHER_END: "looking at the other end",
    Phase.LEAVE: "leaving the switch",
    Phase.ENTER: "entering the switch slowly",
    Phase.CROSS: "crossing the switch",
    Phase.RE_ENTER: "entering it from the other side",
    Phase.TO_ZERO: "going to zero",
}


class Searched(Protocol):
    """What a search does to an axis, and sees of it."""

    def turn(self, direction: int, fast: bool) -> None:
        """Rotate at the search speed, or at the switch speed."""
        ...

    def halt(self) -> None:
        """Slow down to a stop."""
        ...

    def go(self, position: int) -> None:
        """Go to `position` at the switch speed."""
        ...

    def stop_switch(self, side: int) -> bool:
        """Whether the stop switch of that side is active, polarity and swapping included."""
        ...

    def home_switch(self) -> bool: ...

    @property
    def position(self) -> int: ...

    @property
    def standing(self) -> bool: ...


_Steps = Generator[None, None, int]
"""Runs until an event is needed; sent on after each one. Returns a position."""


class Search:
    """One reference search, from RFS START to its end."""

    def __init__(self, axis: Searched, mode: int) -> None:
        self.phase = Phase.FAST
        self.mode = mode
        self.reference = 0
        """Where zero is to be, in the counter's old scale. Valid once `done`."""
        self.distance: int | None = None
        """Between the end switches [microsteps]; None where the mode does not measure it."""
        self.done = False
        self._axis = axis
        self._steps = self._stop_switches() if mode & ~SWAPPED <= 4 else self._home()

    @property
    def stops(self) -> bool:
        """Whether stop switches stop the motor during this search."""
        return self.mode & ~HOME_INVERTED not in (7, 8)

    def advance(self) -> None:
        """Something happened: go on as far as that takes us."""
        try:
            next(self._steps)
        except StopIteration as end:
            self.reference = end.value
            self.done = True

    # --- the parts -------------------------------------------------------------------------------

    def _stop_switches(self) -> _Steps:
        mode = self.mode & ~SWAPPED
        side = RIGHT if self.mode & SWAPPED else LEFT
        other_end: int | None = None
        if mode in (2, 3):
            other_end = yield from self._hit(-side, Phase.FAST)
            yield from self._hit(side, Phase.OTHER_END)
        else:
            yield from self._hit(side, Phase.FAST)
        self.phase = Phase.LEAVE
        self._axis.turn(-side, fast=False)
        while self._axis.stop_switch(side):
            yield
        opened = self._axis.position
        self.phase = Phase.ENTER
        self._axis.turn(side, fast=False)
        while not self._axis.stop_switch(side):
            yield
        closed = self._axis.position
        yield from self._stand()
        zero = (opened + closed) // 2 if mode in (3, 4) else closed
        if other_end is not None:
            self.distance = abs(other_end - zero)
        return zero

    def _hit(self, side: int, phase: Phase) -> _Steps:
        """Run into a stop switch; where it closed."""
        self.phase = phase
        self._axis.turn(side, fast=True)
        while not self._axis.stop_switch(side):
            yield
        closed = self._axis.position
        yield from self._stand()
        return closed

    def _home(self) -> _Steps:
        axis = self._axis
        mode = self.mode & ~HOME_INVERTED
        forwards = {5: LEFT, 6: RIGHT, 7: DIRECTION_7_AND_8[0], 8: DIRECTION_7_AND_8[1]}[mode]
        self.phase = Phase.FAST
        axis.turn(forwards, fast=True)
        while not self._at_home():
            if self.phase is Phase.FAST and self.stops and axis.stop_switch(forwards):
                forwards = -forwards
                self.phase = Phase.OTHER_END
                axis.turn(forwards, fast=True)
            yield
        axis.halt()
        yield from self._stand()
        self.phase = Phase.LEAVE
        axis.turn(-forwards, fast=False)
        while not self._at_home():  # it was crossed while slowing down
            yield
        while self._at_home():
            yield
        self.phase = Phase.ENTER
        near = yield from self._enter(forwards)
        self.phase = Phase.CROSS
        while self._at_home():
            yield
        self.phase = Phase.RE_ENTER
        far = yield from self._enter(-forwards)
        middle = (near + far) // 2
        self.phase = Phase.TO_ZERO
        axis.go(middle)
        while not (axis.standing and axis.position == middle):
            yield
        return middle

    def _enter(self, direction: int) -> _Steps:
        """Slowly into the home switch; where it closed."""
        self._axis.turn(direction, fast=False)
        while not self._at_home():
            yield
        return self._axis.position

    def _at_home(self) -> bool:
        return self._axis.home_switch() != bool(self.mode & HOME_INVERTED)

    def _stand(self) -> _Steps:
        """Until the motor stands."""
        while not self._axis.standing:
            yield
        return 0
