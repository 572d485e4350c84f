"""A module behind a line on which frames break, in either direction."""

from __future__ import annotations

import random
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import cast

from app.links.emulator import EmulatorPort
from tests.devices.tmcl.harness import Bench, Tap, bench


@dataclass
class BrokenLine(Tap):
    """Of so many frames one has a bit flipped on its way."""

    rng: random.Random | None = None
    broken: float = 0.0
    hits: int = 0

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        return self._spoilt(self.module.exchange(self._spoilt(frame), at_s))

    def _spoilt(self, frame: bytes) -> bytes:
        assert self.rng is not None
        if self.rng.random() >= self.broken:
            return frame
        self.hits += 1
        at = self.rng.randrange(len(frame) * 8)
        spoilt = bytearray(frame)
        spoilt[at // 8] ^= 1 << at % 8
        return bytes(spoilt)


@asynccontextmanager
async def broken_line(seed: int, broken: float) -> AsyncIterator[Bench]:
    """A connected module whose line breaks that share of frames from now on."""
    async with bench() as b:
        port = cast("EmulatorPort", b.device.session.port)
        port.wire = BrokenLine(b.module, rng=random.Random(seed), broken=broken)
        yield b
