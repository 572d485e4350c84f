"""All feeds by device: follows the devices as they come, change and go."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable

from ..clock import Clock
from ..devices.core.background_tasks import OwnTasks
from ..devices.core.device import Device
from ..errors import UnknownThing
from .feed import Feed, Joined
from .reader import Reader


class TelemetryHub:
    """`history_minutes` [min] of every connected device are remembered."""

    def __init__(self, clock: Clock, history_minutes: float) -> None:
        self._clock = clock
        self._minutes = history_minutes
        self._feeds: dict[str, Feed] = {}
        self._ending: list[Feed] = []
        """Closed, with a sample still on its way."""
        self._tasks = OwnTasks()

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
                feed = Feed(device, self._clock, self._minutes)
                feed.start()
            self._feeds[device.id] = feed
        for feed in old.values():
            feed.close("the device was removed or connected in another way")
            self._ending.append(feed)
            self._tasks.begin(self._see_out(feed), f"last samples of {feed.device.id}")

    async def _see_out(self, feed: Feed) -> None:
        await feed.drained()
        self._ending.remove(feed)

    def join(
        self, device_id: str, channels: tuple[str, ...], rate_hz: float, batch_hz: float = 60.0, history_s: float = 0.0
    ) -> Joined:
        """A new reader of that device. Raises UnknownThing and OutOfRange."""
        feed = self._feeds.get(device_id)
        if feed is None:
            raise UnknownThing("device", device_id, list(self._feeds))
        return feed.join(channels, rate_hz, batch_hz, history_s)

    def leave(self, reader: Reader) -> None:
        """A reader has gone."""
        for feed in self._feeds.values():
            feed.leave(reader)

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
