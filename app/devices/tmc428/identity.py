"""Who answers where a chip of this family is expected, and what has to be known of it."""

from __future__ import annotations

from abc import abstractmethod

from ..core.background_tasks import BackgroundTasks
from ..core.capabilities import Identity
from ..core.register_link import RegisterLink
from .memory import RampMemory
from .resets import Resets


class RampIdentity(Identity):
    """What the chips of this family have in common; each probes in its own way."""

    def __init__(self, link: RegisterLink, memory: RampMemory, resets: Resets, tasks: BackgroundTasks) -> None:
        self.link = link
        self._memory = memory
        self._resets = resets
        self._tasks = tasks

    @abstractmethod
    async def probe(self) -> str: ...

    async def refresh(self) -> None:
        await self._memory.refresh()
        for axis in self.link.session.axes:
            self._resets.judge(axis.index)

    def only_reads(self, frame: bytes) -> bool:
        return self.link.access.is_read(frame)

    async def let_go(self) -> None:
        await self._tasks.end()
