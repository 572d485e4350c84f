"""Events of an axis in the order in which they were seen, the oldest forgotten first, each told once."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from .results import ChipEvents, EventPage

KEPT = 2000


class Timeline:
    """What event registers have told. Bits that stay set are told when they come, and again only after they were
    cleared. `names` gives the events of some bits; bits without a name are none."""

    def __init__(self, axis: int, mask: int, names: Callable[[int], tuple[str, ...]]) -> None:
        self._axis = axis
        self._mask = mask
        self._names = names
        self._entries: deque[ChipEvents] = deque(maxlen=KEPT)
        self._seq = 0
        self._told = 0
        """Bits that are set in the chip as far as is known, and were told."""
        self._read_s = float("-inf")
        """When the registers were read last, device time [s]."""

    def read(self, word: int, left: int, time_s: float, mask: int | None = None) -> ChipEvents | None:
        """The registers read `word` at `time_s` [s], and are now `left`, as far as nothing new has come; what of it is
        new. Where only some bits were read, `mask` says which."""
        mask = self._mask if mask is None else mask & self._mask
        new = word & ~self._told & mask
        self._told = self._told & ~mask | left & mask
        self._read_s = time_s
        return self._add(new, time_s) if new else None

    def glimpsed(self, bits: int, time_s: float) -> ChipEvents | None:
        """Bits were seen to be set at `time_s` [s], as by a status byte; what of it is new.

        What is older than the latest reading has been told by that.
        """
        new = bits & ~self._told & self._mask
        if not new or time_s <= self._read_s:
            return None
        self._told |= new
        return self._add(new, time_s)

    def cleared(self, bits: int) -> None:
        """These are not set any more: they will be told when they come again."""
        self._told &= ~bits

    def forget(self) -> None:
        """The chip may be another one: what is set there will be told."""
        self._told = 0

    def page(self, after: int, limit: int) -> EventPage:
        """The oldest `limit` entries behind number `after`."""
        first = self._entries[0].seq if self._entries else self._seq + 1
        entries = [entry for entry in self._entries if entry.seq > after][:limit]
        return EventPage(
            tuple(entries), entries[-1].seq if entries else min(after, self._seq), max(first - after - 1, 0)
        )

    def _add(self, bits: int, time_s: float) -> ChipEvents:
        self._seq += 1
        entry = ChipEvents(self._axis, self._seq, time_s, time.time(), self._names(bits))
        self._entries.append(entry)
        return entry
