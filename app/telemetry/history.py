"""What the server remembers of a device, so that a reloaded page has its past."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .ring import Ring
from .sampling import Block

FloatArray = NDArray[np.float64]

HISTORY_RATE_HZ = 50.0
REST_RATE_HZ = 2.0
"""The same while nothing moves and nobody commands anything: 64 devices at rest must not keep a computer busy."""
SHARED_RATE_HZ = 10.0
"""The same on a wire that readers share, while there are none."""
SHARED_SHARE = 0.25
"""How much of such a wire the history takes at the most."""


class History:
    """The last `minutes` of `channels`, sampled at `HISTORY_RATE_HZ`."""

    def __init__(self, channels: Sequence[str], minutes: float) -> None:
        self.channels = tuple(channels)
        self.latest: FloatArray | None = None
        """The row that was added last."""
        self._column = {name: index for index, name in enumerate(self.channels)}
        self._slot = np.nan
        self._ring = Ring(len(self.channels), max(1, round(minutes * 60 * HISTORY_RATE_HZ)), minutes * 60)

    def __len__(self) -> int:
        return len(self._ring)

    def append(self, block: Block) -> None:
        """Add what was sampled."""
        if len(block.time_s):
            self._ring.append(block.time_s, block.samples)
            self.latest = block.samples[-1]

    def append_shared(self, block: Block, channels: Sequence[str]) -> None:
        """Add what was sampled for readers, no more than the history wants; what they did not ask is not known."""
        slots = np.floor(block.time_s * HISTORY_RATE_HZ)
        wanted = np.diff(slots, prepend=self._slot) != 0
        if not wanted.any():
            return
        self._slot = float(slots[-1])
        samples = np.full((int(wanted.sum()), len(self.channels)), np.nan)
        for index, name in enumerate(channels):
            samples[:, self._column[name]] = block.samples[wanted, index]
        self._ring.append(block.time_s[wanted], samples)

    def forget(self) -> None:
        """Give its memory back, which is too much to leave to the garbage collector."""
        self._ring = Ring(len(self.channels), 1)

    def mark_gap(self, time_s: float) -> None:
        """A row of NaN at device time `time_s` [s]: a plot must not draw a line across what is unknown."""
        self._ring.append(np.array([time_s]), np.full((1, len(self.channels)), np.nan))

    def since(self, from_s: float, channels: Sequence[str]) -> tuple[FloatArray, FloatArray]:
        """Time [rows] and samples [rows, len(channels)] from device time `from_s` [s] on; NaN for what is not kept."""
        kept = {at: self._column[name] for at, name in enumerate(channels) if name in self._column}
        time_s, samples = self._ring.since(from_s, [*kept.values()])
        wanted = np.full((len(time_s), len(channels)), np.nan)
        wanted[:, [*kept]] = samples
        return time_s, wanted
