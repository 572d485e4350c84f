"""Which frames a set of telemetry channels needs, and how to make columns of the replies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Decoder = Callable[[FloatArray, NDArray[np.int64], NDArray[np.int64]], FloatArray]
"""(time_s[rows], words[rows, frames] without status, status[rows]) to one column [rows]."""


@dataclass(frozen=True, slots=True)
class Channel:
    """One telemetry channel: `name` is `quantity.axis`."""

    name: str
    quantity: str
    axis: int
    unit: str


@dataclass(frozen=True, slots=True)
class SamplePlan:
    """`frames` to exchange for one sample, in order; `channels` and `units` in the order asked for."""

    frames: tuple[bytes, ...]
    channels: tuple[Channel, ...]
    columns: tuple[Decoder, ...]

    @property
    def units(self) -> tuple[str, ...]:
        return tuple(channel.unit for channel in self.channels)

    def decode(self, times_s: FloatArray, replies: bytes) -> FloatArray:
        """Samples to columns, float64[rows, columns]; NaN where a channel has no value.

        `times_s` is device time [rows], `replies` the joined replies of all rows, 4 bytes a frame.
        Raises ValueError where their lengths do not fit.
        """
        rows = len(times_s)
        expected = rows * len(self.frames) * 4
        if len(replies) != expected:
            raise ValueError(f"{rows} samples of {len(self.frames)} frames have {expected} bytes, not {len(replies)}")
        words = np.frombuffer(replies, dtype=">u4").reshape(rows, len(self.frames)).astype(np.int64)
        status = words[:, -1] >> 24
        data = words & 0xFF_FFFF
        columns = np.empty((rows, len(self.columns)))
        for index, decode in enumerate(self.columns):
            columns[:, index] = decode(times_s, data, status)
        return columns
