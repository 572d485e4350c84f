"""The threads that read recordings: few, and nobody else's, so that a long one keeps nobody else waiting."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from ...errors import WrongState

THREADS = 2
WAITING_MAX = 64
"""Readings that run or wait for a thread."""

T = TypeVar("T")


class Readers:
    """For work that takes as long as a recording is."""

    def __init__(self, waiting_max: int = WAITING_MAX) -> None:
        self._threads = ThreadPoolExecutor(THREADS, "recordings")
        self._waiting_max = waiting_max
        self._at_it = 0

    async def do(self, work: Callable[[], T]) -> T:
        """What `work` returns. Raises WrongState where too many wait already, and what `work` raises."""
        if self._at_it >= self._waiting_max:
            raise WrongState(f"{self._waiting_max} readings of recordings are under way", "try again in a moment")
        return await self._do(work)

    async def _do(self, work: Callable[[], T]) -> T:
        self._at_it += 1
        try:
            return await asyncio.get_running_loop().run_in_executor(self._threads, work)
        finally:
            self._at_it -= 1

    async def stream(self, pieces: Iterator[bytes]) -> AsyncIterator[bytes]:
        """`pieces`, each made when the one before is on its way. The first is there on return; raises as `do`."""
        first = await self.do(lambda: next(pieces, b""))
        return self._rest(first, pieces)

    async def _rest(self, piece: bytes, pieces: Iterator[bytes]) -> AsyncIterator[bytes]:
        while piece:
            yield piece
            piece = await self._do(lambda: next(pieces, b""))

    def close(self) -> None:
        """No more; what runs goes on to its end."""
        self._threads.shutdown(wait=False, cancel_futures=True)
