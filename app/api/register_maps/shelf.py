"""The register maps of a bench, beside the devices that are made of them."""

from __future__ import annotations

import asyncio
from pathlib import Path

from ...devices.manager import DeviceManager
from ...registers.catalog import is_known
from ...registers.maps.models import MAPS, entry
from ...registers.maps.reader import RegisterMap
from ...store.register_maps import RegisterMaps, StoredMap


class MapShelf:
    """Makes models of the maps in the folder. Files are read in a thread; models change between two calls."""

    def __init__(self, data_dir: Path, manager: DeviceManager) -> None:
        self._maps = RegisterMaps(data_dir, is_known)
        self._manager = manager
        self._turn = asyncio.Lock()
        self._ours: dict[str, RegisterMap] = {}

    @property
    def folder(self) -> Path:
        return self._maps.folder

    @property
    def passed_over(self) -> list[str]:
        """Files in the folder that are none, for people."""
        return self._maps.passed_over

    def users(self) -> dict[str, dict[str, bool]]:
        """By model, the ids of its devices, and whether each is connected or tries to be."""
        found: dict[str, dict[str, bool]] = {}
        for device in self._manager.devices:
            found.setdefault(device.model, {})[device.id] = device.state != "disconnected"
        return found

    async def scan(self) -> list[StoredMap]:
        """What there is now; models and disconnected devices are as it says from then on. Raises StoreUnavailable."""
        async with self._turn:
            return self._taken_over(await asyncio.to_thread(self._maps.scan, self.users()))

    async def content(self, name: str) -> bytes:
        """The file. Raises UnknownThing, StoreUnavailable."""
        await self.scan()
        return await asyncio.to_thread(self._maps.content, name)

    async def put(self, name: str, content: bytes, *, csv: bool, dry_run: bool) -> StoredMap:
        """Keep one. Raises what `RegisterMaps.put` does."""
        async with self._turn:
            users = self.users()
            kept = await asyncio.to_thread(self._maps.put, name, content, users, csv=csv, dry_run=dry_run)
            self._taken_over(await asyncio.to_thread(self._maps.scan, users))
            return kept

    async def delete(self, name: str) -> None:
        """Delete one that no device is made of. Raises what `RegisterMaps.delete` does."""
        async with self._turn:
            await asyncio.to_thread(self._maps.delete, name, self.users())
            self._taken_over(await asyncio.to_thread(self._maps.scan, self.users()))

    def close(self) -> None:
        """Forget the models."""
        for name in self._ours:
            MAPS.pop(name, None)
        self._ours.clear()

    def _taken_over(self, kept: list[StoredMap]) -> list[StoredMap]:
        there = {each.name: each.found for each in kept if isinstance(each.found, RegisterMap)}
        for name in self._ours.keys() - there.keys():
            MAPS.pop(name, None)
            del self._ours[name]
        for name, found in there.items():
            if self._ours.get(name) is not found:
                self._ours[name] = found
                MAPS[name] = entry(found)
                self._manager.renew(name)
        return kept
