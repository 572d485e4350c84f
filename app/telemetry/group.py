"""Readers that want the same: their samples are chosen, decimated and encoded once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .reader import Body, Event, Reader, Status
from .sampling import Block

FloatArray = NDArray[np.float64]

PUMP_S = 1 / 60
"""The beat on which samples are handed on [s]: once a frame of a screen."""


@dataclass(frozen=True, slots=True)
class Subscription:
    """What a reader wants: channels in its order, samples a second, frames a second at the most."""

    channels: tuple[str, ...]
    rate_hz: float
    batch_hz: float


@dataclass(frozen=True, slots=True)
class WireUse:
    """What is asked of a wire, what it could carry, and how far the questions of one row lie apart."""

    calls_per_s: float
    calls_per_s_possible: float | None
    row_spread_ms: float


class Group:
    """One subscription and everybody who has it."""

    def __init__(self, subscription: Subscription, now_s: float) -> None:
        self.subscription = subscription
        self.readers: list[Reader] = []
        self._columns: NDArray[np.intp] | None = None
        self._sampled_hz = subscription.rate_hz
        self._times_s: list[FloatArray] = []
        self._samples: list[FloatArray] = []
        self._oldest_s = now_s
        self._flush_due_s = now_s + 1 / subscription.batch_hz
        self._status_s = now_s
        self._intervals_s: list[FloatArray] = []
        self._last_time_s = np.nan
        self._rows_since_status = 0

    def follow(self, channels: Sequence[str], sampled_hz: float) -> None:
        """From now on blocks have these columns, at this rate (never below the subscription's)."""
        where = {name: index for index, name in enumerate(channels)}
        self._columns = np.array([where[name] for name in self.subscription.channels], dtype=np.intp)
        self._sampled_hz = sampled_hz

    def offer(self, block: Block, oldest_s: float) -> None:
        """Take what this group wants of a block whose first row is of server time `oldest_s` [s]."""
        assert self._columns is not None
        time_s, samples = block.time_s, block.samples[:, self._columns]
        if self.subscription.rate_hz < self._sampled_hz:
            # By count, not by time: exact in the long run at any ratio, and no sample twice.
            share = self.subscription.rate_hz / self._sampled_hz
            slots = np.floor(np.arange(block.first, block.first + len(time_s) + 1) * share + 1e-9)
            wanted = np.diff(slots) > 0
            time_s, samples = time_s[wanted], samples[wanted]
        if len(time_s):
            self.add(time_s, samples, oldest_s)

    def add(self, time_s: FloatArray, samples: FloatArray, oldest_s: float) -> None:
        """Queue rows for the next frame."""
        if not self._times_s:
            self._oldest_s = oldest_s
        self._times_s.append(time_s)
        self._samples.append(samples)
        self._intervals_s.append(np.diff(time_s, prepend=self._last_time_s))
        self._last_time_s = float(time_s[-1])
        self._rows_since_status += len(time_s)

    def gap(self, time_s: float, now_s: float) -> None:
        """A row of NaN at device time `time_s` [s]: a plot must not draw a line across what is unknown."""
        if np.isnan(self._last_time_s) or time_s >= self._last_time_s:
            self.add(np.array([time_s]), np.full((1, len(self.subscription.channels)), np.nan), now_s)
        self._last_time_s = np.nan  # the interval across the gap says nothing about jitter

    @property
    def frames_per_s(self) -> float:
        """How many all its readers would like."""
        return len(self.readers) * self.subscription.batch_hz

    def flush(self, now_s: float, *, at_once: bool = False, stretch: float = 1.0) -> None:
        """Give the readers a frame, if it is time for one; frames are that much rarer and longer."""
        # Half a beat of the pump early is on time, and beats are counted from the one before: a pump that
        # is now late, now punctual, must not cost every second frame.
        period_s = stretch / self.subscription.batch_hz
        if not self._times_s or (not at_once and now_s < self._flush_due_s - PUMP_S / 2):
            return
        self._flush_due_s = max(self._flush_due_s, now_s - period_s) + period_s
        body = Body(np.concatenate(self._times_s), np.concatenate(self._samples), self._oldest_s)
        self._times_s.clear()
        self._samples.clear()
        for reader in self.readers:
            reader.push(body)

    def tell(self, event: Event) -> None:
        """Tell every reader."""
        for reader in self.readers:
            reader.tell(event)

    def report(self, now_s: float, use: Callable[[], WireUse] | None = None) -> None:
        """Tell every reader how the last second went, when it is over, and what it took of the wire."""
        elapsed_s = now_s - self._status_s
        if elapsed_s < 1.0:
            return
        rate_hz = self._rows_since_status / elapsed_s
        intervals_s = np.concatenate(self._intervals_s) if self._intervals_s else np.empty(0)
        intervals_s = intervals_s[np.isfinite(intervals_s)]
        jitter_ms = float(intervals_s.std() * 1e3) if len(intervals_s) else 0.0
        self._intervals_s.clear()
        self._rows_since_status = 0
        self._status_s = now_s
        wire = use() if use is not None else WireUse(0.0, None, 0.0)
        for reader in self.readers:
            reader.tell(
                Status(
                    rate_hz,
                    jitter_ms,
                    reader.dropped,
                    reader.latency_s * 1e3,
                    wire.calls_per_s,
                    wire.calls_per_s_possible,
                    wire.row_spread_ms,
                )
            )
            reader.latency_s = 0.0
