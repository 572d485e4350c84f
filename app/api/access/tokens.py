"""The named tokens of a running server: those of the file, read anew whenever it changes."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Sequence

from ...clock import WallClock
from ...devices.core.background_tasks import BackgroundTasks
from ...errors import StoreUnavailable
from ...store.tokens import NamedToken, Role, TokenStore, hash_of

log = logging.getLogger("stepscope.tokens")

POLL_PERIOD_S = 0.25
"""How often the file is looked at [s]: the command line writes it, too."""

Changed = Callable[[Sequence[NamedToken], Sequence[NamedToken], bool], None]
"""Hears of those that came, those that went, and whether this server did it."""


class Tokens:
    """`load` at the start, then `match` as often as wanted."""

    def __init__(self, store: TokenStore, changed: Changed) -> None:
        self._store = store
        self._changed = changed
        self._by_hash: dict[str, NamedToken] = {}
        self._stamp: tuple[int, int, int] | None = None
        self._reading = asyncio.Lock()
        self._tasks = BackgroundTasks()
        self._clock = WallClock()  # of the file's changes, whatever time a test owns
        self.warnings: tuple[str, ...] = ()

    async def start(self) -> None:
        """Read the file, and watch it from now on."""
        async with self._reading:
            self._take(await asyncio.to_thread(self._read))
        self._tasks.begin(self._watch(), "tokens")

    async def close(self) -> None:
        """End the watching."""
        await self._tasks.end()

    def match(self, said: str) -> NamedToken | None:
        """The one that was said; None where it is none."""
        # Found by its hash: the time that takes tells nothing of the token.
        return self._by_hash.get(hash_of(said)) if self._by_hash else None

    def of_hash(self, token_hash: str) -> NamedToken | None:
        """The one of that hash, if it is still there."""
        return self._by_hash.get(token_hash)

    def all(self) -> list[NamedToken]:
        """Every one, in the order they were made."""
        return list(self._by_hash.values())

    async def refresh(self, *, ours: bool = False) -> None:
        """Read the file anew where it is another one."""
        async with self._reading:
            await self._refresh(ours=ours)

    async def add(self, name: str, role: Role) -> str:
        """Make one and return it, the only time. Raises as `TokenStore.add`, StoreUnavailable for OSError."""
        return await self._do(lambda: self._store.add(name, role))

    async def revoke(self, name: str) -> None:
        """End one, its sessions and its sockets. Raises UnknownThing, StoreUnavailable."""
        await self._do(lambda: self._store.revoke(name))

    async def _do(self, work: Callable[[], str | None]) -> str:
        async with self._reading:
            await self._refresh(ours=False)  # what the command line did until now is not our doing
            try:
                return await asyncio.to_thread(work) or ""
            except OSError as error:
                raise StoreUnavailable(
                    f"{self._store.path} cannot be written: {error}",
                    "make room on its disk, or let stepscope write there",
                ) from error
            finally:
                await self._refresh(ours=True)

    async def _watch(self) -> None:
        while True:
            await self._clock.sleep(POLL_PERIOD_S)
            await self.refresh()

    async def _refresh(self, *, ours: bool) -> None:
        if await asyncio.to_thread(self._store.stamp) == self._stamp:
            return
        before = self._by_hash
        self._take(await asyncio.to_thread(self._read))
        came = [token for digest, token in self._by_hash.items() if token != before.get(digest)]
        went = [token for digest, token in before.items() if token != self._by_hash.get(digest)]
        if came or went:
            self._changed(came, went, ours)

    def _read(self) -> tuple[tuple[int, int, int] | None, Sequence[NamedToken], tuple[str, ...]]:
        stamp = self._store.stamp()  # before the reading: what changes meanwhile is read again
        found = self._store.load()
        return stamp, found.tokens, found.warnings

    def _take(self, found: tuple[tuple[int, int, int] | None, Sequence[NamedToken], tuple[str, ...]]) -> None:
        self._stamp, tokens, warnings = found
        self._by_hash = {token.hash: token for token in tokens}
        for warning in set(warnings) - set(self.warnings):
            log.warning("%s", warning)
        self.warnings = warnings
