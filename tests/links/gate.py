"""A real emulator behind a gate: the test decides when each frame is answered, and sees the order they came in."""

from __future__ import annotations

import asyncio

from app.clock import VirtualClock
from app.emulators.build import build_emulator
from app.links.emulator import EmulatorPort


class GatedPort(EmulatorPort):
    """`EmulatorPort` that keeps every exchange waiting until `open` or `let_through`."""

    def __init__(self, model: str = "tmc428") -> None:
        super().__init__(build_emulator(model, VirtualClock()))
        self.seen: list[bytes] = []
        self._gate = asyncio.Semaphore(0)

    async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
        self.seen.append(frame)
        await self._gate.acquire()
        return await super().exchange(frame, timeout_s)

    async def let_through(self, frames: int = 1) -> None:
        """Answer the next `frames` frames, and let everybody run on."""
        for _ in range(frames):
            self._gate.release()
            await settle()


async def settle() -> None:
    """Let every task run until it waits for something that only the test can give."""
    for _ in range(20):
        await asyncio.sleep(0)
