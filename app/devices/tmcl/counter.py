"""The position counter of a TMCL module, and its tick timer, which tells of a reset.

The timer (GP 132) counts milliseconds from power-on. Where it has gone on by less than the time since the look before,
the module was reset in between, or the timer was set: either is a reason to ask where the axis is.
"""

from __future__ import annotations

from collections.abc import Callable

from ...errors import UnknownParameter
from ..core.capabilities import PositionCounter
from ..core.counter import CounterReading
from ..core.session import Session
from ..core.tmcl_calls import Calls
from ..core.tmcl_link import TmclLink
from .roles import COUNTER_NAMES, RegisterRoles
from .state import ModuleState

TICKS_WRAP = 1 << 31
BEHIND_S, BEHIND = 0.5, 0.01
"""How much the timer may lag: by questions asked again [s], and as a share, by two clocks that differ."""


COUNTER_WRITES = frozenset({"set_position", *COUNTER_NAMES})


def counter_writes(roles: RegisterRoles) -> Callable[[str], bool]:
    """Tells whether after a command, as `Session.commanded` names it, the counter shows another number for the same
    place."""
    # By hand, and at the end of a search, which sets the counter to 0 by itself.
    rows = (roles.actual_position, roles.microsteps)
    by_hand = tuple(f"{command} {row.address}," for command in ("SAP", "AAP") for row in rows)

    def counts_as_written(what: str) -> bool:
        return what in COUNTER_WRITES or what.startswith(("RFS START", *by_hand))

    return counts_as_written


class TickTimer:
    """The module's own clock, and the resets that it has told of."""

    def __init__(self, session: Session, state: ModuleState) -> None:
        self._session = session
        self._state = state
        self._latest: tuple[float, int] | None = None
        self._resets = 0

    @property
    def latest(self) -> tuple[float, int] | None:
        """When it was read last, device time [s], and what it showed [ms]; None where it never was."""
        return self._latest

    @property
    def resets(self) -> int | None:
        """How often a reset was seen; None where the timer was never read."""
        return None if self._latest is None else self._resets

    async def reset_since(self, calls: Calls) -> bool | None:
        """Read it: whether the module was reset since the timer was read last; None where it never was."""
        time_s = self._session.device_time_s()
        try:
            ticks = await calls.get(self._state.roles.ticks)
        except UnknownParameter:
            return None
        before, self._latest = self._latest, (time_s, ticks)
        if before is None:
            return None
        elapsed_s = time_s - before[0]
        went_s = (ticks - before[1]) % TICKS_WRAP / 1000
        reset = went_s < elapsed_s * (1 - BEHIND) - BEHIND_S or went_s > elapsed_s * (1 + BEHIND) + 1.0
        self._resets += reset
        return reset


class ModuleCounter(PositionCounter):
    """AP 1, which wraps by as many bits as the module has for it."""

    def __init__(self, session: Session, state: ModuleState, link: TmclLink, ticks: TickTimer) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._ticks = ticks
        self._resets_told = 0

    async def poll(self, axis: int) -> CounterReading:
        session = self._session
        session.axis(axis)
        session.require_connected()
        async with self._link.calls() as calls:
            asked_at_s = session.device_time_s()
            count = await calls.get(self._state.roles.actual_position)
            seen = await self._ticks.reset_since(calls)
        before, self._resets_told = self._resets_told, self._ticks.resets or 0
        reset_seen = None if seen is None else self._resets_told > before
        session.saw_position(axis, count, asked_at_s)
        return CounterReading(count, asked_at_s, reset_seen)

    def counter_bits(self, axis: int) -> int | None:
        self._session.axis(axis)
        return self._state.module.position_bits

    async def runs_for_s(self) -> float | None:
        latest = self._ticks.latest
        return None if latest is None else latest[1] / 1000

    def latch_register(self, axis: int) -> str | None:
        self._session.axis(axis)
        return None

    def compare_register(self, axis: int) -> str | None:
        self._session.axis(axis)
        return None
