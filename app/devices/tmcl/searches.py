"""The module's own reference search (FM-PD42-1241 7.1): started, looked at and ended. What it finds, the module
knows."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import WrongState
from ...links.tmcl import Request
from ...registers.tmcl.commands import Opcode
from ..core.device import MotionStarted
from ..core.motion_watch import Look
from . import rows
from .motion import START, STATUS
from .polling import Looks

LOOK = (
    rows.ACTUAL_POSITION,
    rows.ACTUAL_SPEED,
    rows.POSITION_REACHED,
    rows.LEFT_SWITCH,
    rows.RIGHT_SWITCH,
    rows.HOME_SWITCH,
)
SPEEDS = (rows.SEARCH_SPEED, rows.SWITCH_SPEED)


@dataclass(frozen=True, slots=True)
class SearchLook:
    """A reference search at one moment. Position in microsteps, speed in pps, switches as the module sees them."""

    running: bool
    time_s: float
    position: int
    speed_pps: float
    left: bool
    right: bool
    home: bool


@dataclass(frozen=True, slots=True)
class SearchResult:
    """After a search [microsteps]."""

    position: int
    distance: int | None
    """Between the stop switches (AP 196), meaningful after modes 2 and 3; None where the firmware has it not."""
    last_position: int | None
    """Where the counter stood before it was set to 0 (AP 197); None where the firmware has it not."""


class Searches(Looks):
    """A TMCL module that finds its reference by itself."""

    async def start_search(self) -> None:
        """RFS START, with mode and speeds as they are set (AP 193 to 195). Sent once.

        Raises WrongState where the motor would not move, LinkError.
        """
        self.require_connected()
        async with self.calls(0) as calls:
            await self._prepare(calls)
            for register, speed in zip(SPEEDS, await calls.get_many(SPEEDS), strict=True):
                if speed == 0:
                    raise WrongState(f"{register.name} ({register.alias}) is 0, so the search would never move")
            started_s = await self._set_off(calls, Request(self.address, Opcode.RFS, START), "search", None)
            self._book.end(started_s, "a reference search")
        self._tell(MotionStarted(0, started_s))

    async def look_at_search(self) -> SearchLook:
        """How the search goes. Raises LinkError."""
        async with self.calls() as calls:
            running = (await calls.do(Request(self.address, Opcode.RFS, STATUS))).value != 0
            told_position, told_speed, told, left, right, home = await calls.ask_many(LOOK)
            position = calls.need(rows.ACTUAL_POSITION, told_position)
            speed = calls.need(rows.ACTUAL_SPEED, told_speed)
            time_s = calls.time_s
        self._watch.look(Look(time_s, position, speed, self._reached(told, position)), self._spread_s())
        return SearchLook(running, time_s, position, speed * self.speed_unit_pps, bool(left), bool(right), bool(home))

    async def search_result(self) -> SearchResult:
        """What the latest search found. Raises LinkError."""
        async with self.calls() as calls:
            position, *found = await calls.ask_many((rows.ACTUAL_POSITION, rows.SWITCH_DISTANCE, rows.LAST_REFERENCE))
            return SearchResult(calls.need(rows.ACTUAL_POSITION, position), *found)
