"""Calls that may change something and are under way."""

from __future__ import annotations

import asyncio


class CallsUnderWay:
    """Calls that may change something and have begun: who takes the bench waits until those before are over."""

    def __init__(self) -> None:
        self._calls: set[asyncio.Future[None]] = set()

    @property
    def any(self) -> bool:
        """Whether there are such calls."""
        return bool(self._calls)

    def begin(self) -> asyncio.Future[None]:
        """One begins; `end` it."""
        call: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._calls.add(call)
        return call

    def end(self, call: asyncio.Future[None]) -> None:
        """That one is over."""
        self._calls.discard(call)
        call.set_result(None)

    async def over(self, within_s: float) -> bool:
        """Return when all that have begun by now are over, True, or after `within_s` [s], False."""
        return not self._calls or not (await asyncio.wait(set(self._calls), timeout=within_s))[1]
