"""All feeds by device: follows the devices as they come, change and go."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from ..clock import Clock
from ..devices.core.background_tasks import BackgroundTasks
from ..devices.core.device import Device
from ..errors import UnknownThing, WrongState
from .feed import Feed, Joined
from .reader import Reader

SUBSCRIPTIONS_MAX = 96
"""Different wishes of readers, of all devices together: each is chosen and encoded by itself."""
FRAMES_PER_S_MAX = 2500.0
"""Frames of all readers together: each costs some 100 us. Who would like more gets them rarer, with all their rows."""
HISTORY_BYTES_MAX = 64 << 20
"""What histories may take that readers are being sent [bytes], before another one is made."""


class TelemetryHub:
    """`history_minutes` [min] of every connected device are remembered."""

    def __init__(self, clock: Clock, history_minutes: float) -> None:
        self._clock = clock
        self._minutes = history_minutes
        self._feeds: dict[str, Feed] = {}
        self._ending: list[Feed] = []
        """Closed, with a sample still on its way."""
        self._tasks = BackgroundTasks()
        self._history_bytes = 0
        self._stretch = 1.0

    @property
    def readers(self) -> int:
        """How many readers there are."""
        return sum(feed.readers for feed in self._feeds.values())

    def of_device(self, device_id: str) -> tuple[int, int]:
        """How many readers a device has, and how many rows they have lost for being slow, with those before them."""
        feed = self._feeds.get(device_id)
        return (0, 0) if feed is None else (feed.readers, feed.rows_dropped)

    def sync(self, devices: Iterable[Device]) -> None:
        """Have a feed for each of `devices`, and for no other. A renamed device keeps its feed."""
        old = {id(feed.device): feed for feed in self._feeds.values()}
        self._feeds = {}
        for device in devices:
            feed = old.pop(id(device), None)
            if feed is None:
                feed = Feed(device, self._clock, self._minutes, stretch=lambda: self._stretch)
                feed.start()
            self._feeds[device.id] = feed
        for feed in old.values():
            feed.close("the device was removed or connected in another way")
            self._ending.append(feed)
            self._tasks.begin(self._see_out(feed), f"last samples of {feed.device.id}")
        self._share_out()

    def _share_out(self) -> None:
        """Frames as often as their readers like, or all of them rarer."""
        wanted_per_s = sum(feed.frames_per_s for feed in self._feeds.values())
        self._stretch = max(1.0, wanted_per_s / FRAMES_PER_S_MAX)

    async def _see_out(self, feed: Feed) -> None:
        await feed.drained()
        self._ending.remove(feed)

    def join(
        self, device_id: str, channels: tuple[str, ...], rate_hz: float, batch_hz: float = 60.0, history_s: float = 0.0
    ) -> Joined:
        """A new reader of that device.

        Raises UnknownThing, OutOfRange, and WrongState where readers want too many different things.
        """
        feed = self._feeds.get(device_id)
        if feed is None:
            raise UnknownThing("device", device_id, list(self._feeds))
        alone = sum(each.subscriptions for each in self._feeds.values()) < SUBSCRIPTIONS_MAX
        joined = feed.join(channels, rate_hz, batch_hz, history_s, alone=alone)
        self._share_out()
        return joined

    def require_history_room(self) -> None:
        """Raises WrongState while the histories of others that take none of theirs fill the memory for it."""
        if self._history_bytes > HISTORY_BYTES_MAX:
            raise WrongState(
                f"histories of {self._history_bytes >> 20} MiB are on their way to other readers",
                "join again in a moment, or without history_s",
            )

    @contextmanager
    def handing_over(self, joined: Joined) -> Iterator[None]:
        """The history of `joined` is sent in this block; at its end it is forgotten."""
        size = joined.history_bytes
        self._history_bytes += size
        try:
            yield
        finally:
            self._history_bytes -= size
            joined.forget_history()

    def leave(self, reader: Reader) -> None:
        """A reader has gone."""
        for feed in self._feeds.values():
            feed.leave(reader)
        self._share_out()

    def flush(self, device_id: str) -> None:
        """What was sampled of that device so far goes to its readers now, not with their next beat."""
        feed = self._feeds.get(device_id)
        if feed is not None:
            feed.flush()

    async def close(self) -> None:
        """End all readers and everything that runs."""
        for feed in self._feeds.values():
            feed.close("the server shuts down")
        ending = [*self._ending, *self._feeds.values()]
        self._feeds = {}
        await asyncio.gather(*(feed.wait_closed() for feed in ending))
        await self._tasks.end()
