"""Which frames a set of telemetry channels needs, and how to make columns of the replies."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...links.access32 import Spi32Access
from ...links.datagram32 import DATA_MASK
from ...links.register_access import BoardAccess, RegisterAccess, UartAccess
from ...links.spi_access import SpiAccess
from ...registers.tmcl.commands import Status

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Decoder = Callable[[FloatArray, IntArray, IntArray], FloatArray]
"""(time_s[rows], words[rows, registers] without status, status[rows]) to one column [rows]."""
Seen = Callable[[FloatArray, IntArray, IntArray], None]
"""The same block, for whoever learns from it."""
Block = tuple[IntArray, IntArray, NDArray[np.bool_]]
"""Words [rows, registers], status bytes [rows], and which rows can be trusted."""
Form = Callable[[NDArray[np.uint8]], Block]
"""The bytes of samples [rows, frames, bytes] to what they say."""


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
    """`frames` to exchange for one sample, in order; `channels` and `units` in the order asked for.

    reply_bytes : length of one reply
    """

    frames: tuple[bytes, ...]
    channels: tuple[Channel, ...]
    reply_bytes: int

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

    def cut(self, rows: int, replies: bytes) -> NDArray[np.uint8]:
        """The bytes of `rows` samples [rows, frames, bytes]. Raises ValueError where there are more or fewer."""
        expected = rows * self.row_bytes
        if len(replies) != expected:
            raise ValueError(f"{rows} samples of {len(self.frames)} frames have {expected} bytes, not {len(replies)}")
        return np.frombuffer(replies, dtype=np.uint8).reshape(rows, len(self.frames), self.reply_bytes)


@dataclass(frozen=True, slots=True)
class WordsPlan(SamplePlan):
    """Words; `form` takes them out of the replies, `seen` hears of each block before it is decoded."""

    columns: tuple[Decoder, ...]
    form: Form
    seen: Seen | None = None

    def decode(self, times_s: FloatArray, replies: bytes) -> FloatArray:
        rows = len(times_s)
        words, status, sound = self.form(self.cut(rows, replies))
        if self.seen is not None and rows:
            self.seen(times_s, words, status)
        columns = np.empty((rows, len(self.columns)))
        for index, decode in enumerate(self.columns):
            columns[:, index] = decode(times_s, words, status)
        columns[~sound] = np.nan
        return columns


def form_of(access: RegisterAccess) -> Form:
    """How words lie in the replies of this access."""
    if isinstance(access, UartAccess):
        return _uart
    if isinstance(access, BoardAccess):
        return _board
    if isinstance(access, SpiAccess):
        return _told(access)
    return _spi32 if isinstance(access, Spi32Access) else _spi40


def _told(access: SpiAccess) -> Form:
    """Datagrams of a told format: the first byte of an answer is taken for its status."""
    head, first = access.form.head_bytes, int(access.form.answer == "next")
    big = access.form.byte_order == "big"

    def form(raw: NDArray[np.uint8]) -> Block:
        data = raw[:, first:, head:] if big else raw[:, first:, : head - 1 : -1]
        # Of 64 bits only as many mean something as a register may have; the others are masked away.
        words = np.zeros(data.shape[:2], dtype=np.int64)
        for place in range(data.shape[2]):
            words = words << 8 | data[:, :, place]
        return words, raw[:, -1, 0].astype(np.int64), np.ones(len(raw), dtype=np.bool_)

    return form


def _words(replies: NDArray[np.uint8]) -> IntArray:
    """Four bytes [rows, frames, 4] as a word each [rows, frames]."""
    return np.ascontiguousarray(replies).view(">u4")[:, :, 0].astype(np.int64)


def _spi32(raw: NDArray[np.uint8]) -> Block:
    """The status, then 24 bits of data."""
    return _words(raw) & DATA_MASK, raw[:, -1, 0].astype(np.int64), np.ones(len(raw), dtype=np.bool_)


def _spi40(raw: NDArray[np.uint8]) -> Block:
    """Each reply has the status of its moment and the word of the frame before."""
    return _words(raw[:, 1:, 1:]), raw[:, -1, 0].astype(np.int64), np.ones(len(raw), dtype=np.bool_)


def _board(raw: NDArray[np.uint8]) -> Block:
    """Nine-byte answers of an evaluation board, which brings no status byte."""
    # uint8 sums wrap at 256 by themselves, which is what the checksum does.
    sound = raw[:, :, :8].sum(axis=2, dtype=np.uint8) == raw[:, :, 8]
    sound &= raw[:, :, 2] == Status.OK
    return _words(raw[:, :, 4:8]), np.zeros(len(raw), dtype=np.int64), sound.all(axis=1)


def _uart(raw: NDArray[np.uint8]) -> Block:
    """Answers of a single-wire UART, of which the port has judged the CRC: no status byte."""
    return _words(raw[:, :, -5:-1]), np.zeros(len(raw), dtype=np.int64), np.ones(len(raw), dtype=np.bool_)
