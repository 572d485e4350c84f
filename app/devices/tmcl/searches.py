"""The module's own reference search (FM-PD42-1241 7.1): started, looked at and ended. What it finds, the module
knows."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import WrongState
from ...links.tmcl import Request
from ...registers.tmcl.commands import Opcode
from ..core.events import MotionStarted
from ..core.motion_watch import MotionReading
from ..core.session import Session
from ..core.tmcl_frames import START, STATUS
from ..core.tmcl_link import TmclLink
from .departure import Departure
from .ongoing import OngoingMotion
from .state import ModuleState


@dataclass(frozen=True, slots=True)
class SearchState:
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


class Searches:
    """Has the module find its reference by itself."""

    def __init__(
        self, session: Session, state: ModuleState, link: TmclLink, ongoing: OngoingMotion, departure: Departure
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._ongoing = ongoing
        self._departure = departure

    @property
    def speed_unit_pps(self) -> float:
        """What a speed of 1, of the parameters that a search goes by, is as the module is set [pps]."""
        return self._state.speed_unit_pps

    async def read_units(self) -> None:
        """Ask what speeds count by. Raises LinkError."""
        async with self._link.calls() as calls:
            await calls.get_many(self._state.roles.counting)

    def apart(self, one: int, other: int) -> int:
        """How far two positions are from each other, the shorter way round [microsteps]."""
        return abs(self._state.wrap.way(one, other))

    async def start(self) -> None:
        """RFS START, with mode and speeds as they are set (AP 193 to 195). Sent once.

        Raises WrongState where the motor would not move, LinkError.
        """
        self._session.require_connected()
        async with self._link.calls(0) as calls:
            await self._departure.prepare(calls)
            speeds = (self._state.roles.search_speed, self._state.roles.switch_speed)
            for register, speed in zip(speeds, await calls.get_many(speeds), strict=True):
                if speed == 0:
                    raise WrongState(f"{register.name} ({register.alias}) is 0, so the search would never move")
            started_s = await self._departure.set_off(
                calls, Request(self._link.address, Opcode.RFS, START), "search", None
            )
            self._ongoing.book.end(started_s, "a reference search")
        self._session.tell(MotionStarted(0, started_s))

    async def poll(self) -> SearchState:
        """How the search goes. Raises LinkError."""
        async with self._link.calls() as calls:
            running = (await calls.do(Request(self._link.address, Opcode.RFS, STATUS))).value != 0
            told_position, told_speed, told, left, right, home = await calls.ask_many(self._state.roles.searching)
            position = calls.need(self._state.roles.actual_position, told_position)
            speed = calls.need(self._state.roles.actual_speed, told_speed)
            time_s = calls.time_s
        self._ongoing.watch.update(
            MotionReading(time_s, position, speed, self._ongoing.reached(told, position)), self._link.poll_spread_s
        )
        return SearchState(
            running, time_s, position, speed * self._state.speed_unit_pps, bool(left), bool(right), bool(home)
        )

    async def result(self) -> SearchResult:
        """What the latest search found. Raises LinkError."""
        async with self._link.calls() as calls:
            position, *found = await calls.ask_many(
                (self._state.roles.actual_position, self._state.roles.switch_distance, self._state.roles.last_reference)
            )
            return SearchResult(calls.need(self._state.roles.actual_position, position), *found)
