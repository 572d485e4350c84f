"""Which frames a set of telemetry channels needs, and how to make columns of the replies."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...registers.tmcl.commands import Status

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
class Taken:
    """Samples just taken over a link: a time [s, device time] and the joined replies of each row, in order."""

    times_s: list[float]
    replies: list[bytes]
    spread_s: float
    """From the first to the last question of a row."""


@dataclass(frozen=True, slots=True)
class SamplePlan(ABC):
    """`frames` to exchange for one sample, in order; `channels` and `units` in the order asked for."""

    frames: tuple[bytes, ...]
    channels: tuple[Channel, ...]

    reply_bytes: ClassVar[int]
    """Length of one reply."""

    @property
    def units(self) -> tuple[str, ...]:
        return tuple(channel.unit for channel in self.channels)

    @property
    def row_bytes(self) -> int:
        """Length of all replies of one sample."""
        return len(self.frames) * self.reply_bytes

    @abstractmethod
    def decode(self, times_s: FloatArray, replies: bytes) -> FloatArray:
        """Samples to columns, float64[rows, columns]; NaN where a channel has no value.

        `times_s` is device time [rows], `replies` the joined replies of all rows. Raises ValueError
        where their lengths do not fit.
        """

    def _require_rows(self, rows: int, replies: bytes) -> None:
        expected = rows * self.row_bytes
        if len(replies) != expected:
            raise ValueError(f"{rows} samples of {len(self.frames)} frames have {expected} bytes, not {len(replies)}")


@dataclass(frozen=True, slots=True)
class DatagramPlan(SamplePlan):
    """Replies of 32 bits: status, then 24 bits of data."""

    columns: tuple[Decoder, ...]

    reply_bytes = 4

    def decode(self, times_s: FloatArray, replies: bytes) -> FloatArray:
        rows = len(times_s)
        self._require_rows(rows, replies)
        words = np.frombuffer(replies, dtype=">u4").reshape(rows, len(self.frames)).astype(np.int64)
        status = words[:, -1] >> 24
        data = words & 0xFF_FFFF
        columns = np.empty((rows, len(self.columns)))
        for index, decode in enumerate(self.columns):
            columns[:, index] = decode(times_s, data, status)
        return columns


Seen = Callable[[FloatArray, NDArray[np.int64], NDArray[np.int64]], None]
"""Hears (time_s[rows], words[rows, registers], status[rows]) of each block before it is decoded."""


@dataclass(frozen=True, slots=True)
class WordsPlan(SamplePlan):
    """Words of 32 bits, however they travel."""

    columns: tuple[Decoder, ...]
    seen: Seen | None

    def decode(self, times_s: FloatArray, replies: bytes) -> FloatArray:
        rows = len(times_s)
        self._require_rows(rows, replies)
        raw = np.frombuffer(replies, dtype=np.uint8).reshape(rows, len(self.frames), self.reply_bytes)
        words, status, sound = self._taken(raw)
        if self.seen is not None and rows:
            self.seen(times_s, words, status)
        columns = np.empty((rows, len(self.columns)))
        for index, decode in enumerate(self.columns):
            columns[:, index] = decode(times_s, words, status)
        columns[~sound] = np.nan
        return columns

    @abstractmethod
    def _taken(self, raw: NDArray[np.uint8]) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
        """Words [rows, registers], status bytes [rows] and which rows can be trusted, of raw[rows, frames, bytes]."""


@dataclass(frozen=True, slots=True)
class PipelinedPlan(WordsPlan):
    """Replies of 40 bits, each with the status of its moment and the word of the frame before."""

    reply_bytes = 5

    def _taken(self, raw: NDArray[np.uint8]) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
        words = np.ascontiguousarray(raw[:, 1:, 1:]).view(">u4")[:, :, 0].astype(np.int64)
        return words, raw[:, -1, 0].astype(np.int64), np.ones(len(raw), dtype=np.bool_)


@dataclass(frozen=True, slots=True)
class BoardPlan(WordsPlan):
    """Nine-byte answers of an evaluation board, which brings no status byte."""

    reply_bytes = 9

    def _taken(self, raw: NDArray[np.uint8]) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
        # uint8 sums wrap at 256 by themselves, which is what the checksum does.
        sound = raw[:, :, :8].sum(axis=2, dtype=np.uint8) == raw[:, :, 8]
        sound &= raw[:, :, 2] == Status.OK
        words = np.ascontiguousarray(raw[:, :, 4:8]).view(">u4")[:, :, 0].astype(np.int64)
        return words, np.zeros(len(raw), dtype=np.int64), sound.all(axis=1)


@dataclass(frozen=True, slots=True)
class UartPlan(WordsPlan):
    """Answers of a single-wire UART, of which the port has judged the CRC: no status byte."""

    reply_bytes = 8

    def _taken(self, raw: NDArray[np.uint8]) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
        words = np.ascontiguousarray(raw[:, :, -5:-1]).view(">u4")[:, :, 0].astype(np.int64)
        return words, np.zeros(len(raw), dtype=np.int64), np.ones(len(raw), dtype=np.bool_)


@dataclass(frozen=True, slots=True)
class PlainUartPlan(UartPlan):
    """The same of a TMC5062, whose answers name no host."""

    reply_bytes = 7
