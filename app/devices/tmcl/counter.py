"""The position counter of a TMCL module, and its tick timer, which tells of a reset.

The timer (GP 132) counts milliseconds from power-on. Where it has gone on by less than the time since the look before,
the module was reset in between, or somebody has set the timer: either is a reason to ask where the axis is.
"""

from __future__ import annotations

import contextlib
from dataclasses import replace

from ...errors import UnknownParameter
from ...links.queue import Priority, SampleDropped
from ...registers.model import Space
from ...registers.tmcl.pd42 import PD42
from ..core.counter import CounterLook
from ..core.results import AxisState
from ..core.signs import Signs
from . import rows
from .calls import Calls
from .searches import Searches

_TICKS = PD42.at(132, Space.GLOBAL_0)
assert _TICKS is not None
TICKS = _TICKS
TICKS_WRAP = 1 << 31
BEHIND_S, BEHIND = 0.5, 0.01
"""How much the timer may lag: by questions asked again [s], and as a share, by two clocks that differ."""


class Counting(Searches):
    """A TMCL module whose position counter can be followed."""

    COUNTER_WRITES = frozenset({"set_position", rows.ACTUAL_POSITION.name, rows.MICROSTEPS.name})

    _ticks: tuple[float, int] | None = None
    """When the tick timer was read last, device time [s], and what it showed [ms]."""
    _resets = _resets_told = 0
    """How often a reset was seen, and how many of those `look` has told of."""

    def writes_counter(self, what: str) -> bool:
        # By hand, and at the end of a search, which sets the counter to 0 by itself.
        by_hand = tuple(f"{command} {row.address}," for command in ("SAP", "AAP") for row in rows.COUNTER)
        return super().writes_counter(what) or what.startswith(("RFS START", *by_hand))

    def speed_limit_pps(self, axis: int) -> float:
        self.axis(axis)
        return self.clock_hz / 2  # of the driver chip's ramp generator, whatever the module counts in

    async def look(self, axis: int) -> CounterLook:
        self.axis(axis)
        self.require_connected()
        async with self.calls() as calls:
            asked_at_s = self.device_time_s()
            count = await calls.get(rows.ACTUAL_POSITION)
            seen = await self._reset_since(calls)
        before, self._resets_told = self._resets_told, self._resets
        reset_seen = None if seen is None else self._resets > before
        self.saw_position(axis, count, asked_at_s)
        return CounterLook(count, asked_at_s, reset_seen)

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        state = await super().axis_state(axis, priority)
        if priority is Priority.SAMPLE:  # whoever looks on all the time has to see a reset too
            with contextlib.suppress(SampleDropped):  # the line is busy: later then
                async with self.calls(priority=priority) as calls:
                    await self._reset_since(calls)
        return state

    def signs(self, axis: int, state: AxisState) -> Signs:
        return replace(super().signs(axis, state), resets=None if self._ticks is None else self._resets)

    async def _reset_since(self, calls: Calls) -> bool | None:
        """Whether the module was reset since the timer was read last; None where it never was."""
        time_s = self.device_time_s()
        try:
            ticks = await calls.get(TICKS)
        except UnknownParameter:
            return None
        before, self._ticks = self._ticks, (time_s, ticks)
        if before is None:
            return None
        elapsed_s = time_s - before[0]
        went_s = (ticks - before[1]) % TICKS_WRAP / 1000
        reset = went_s < elapsed_s * (1 - BEHIND) - BEHIND_S or went_s > elapsed_s * (1 + BEHIND) + 1.0
        self._resets += reset
        return reset

    async def runs_for_s(self) -> float | None:
        return None if self._ticks is None else self._ticks[1] / 1000
