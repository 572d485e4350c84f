"""The last frames of a link, for people who want to see what went over the wire.

Written on the hot path and read seldom: a batch of frames is kept as one tuple and taken apart when it is read.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from .arbiter import Priority

FRAMES_KEPT = 2000


@dataclass(frozen=True, slots=True)
class LoggedFrame:
    """One exchange: what went out, what came back (empty: nothing), how long it took [s], what was wrong with it."""

    seq: int
    time_unix_s: float
    priority: Priority
    tx: bytes
    rx: bytes
    took_s: float
    error: str = ""


@dataclass(frozen=True, slots=True)
class LogPage:
    """Frames in order; `next` is what to ask for afterwards, `lost` how many were too old to be had."""

    frames: list[LoggedFrame]
    next: int
    lost: int


_Batch = tuple[int, Priority, float, Sequence[bytes], Sequence[bytes], Sequence[float], str]
# number of its first frame; priority; Unix time of the start; out; back; when each was answered since the start; error


class FrameLog:
    """A ring of the last `FRAMES_KEPT` exchanges. For one event loop."""

    def __init__(self, kept: int = FRAMES_KEPT) -> None:
        self._kept = kept
        self._batches: deque[_Batch] = deque()
        self._next = 0

    def __len__(self) -> int:
        return min(self._next, self._kept)

    @property
    def next(self) -> int:
        """The number that the next frame will get; the first was 0."""
        return self._next

    def add(
        self,
        priority: Priority,
        start_unix_s: float,
        tx: Sequence[bytes],
        rx: Sequence[bytes],
        answered_s: Sequence[float],
        error: str = "",
    ) -> None:
        """Add frames sent in a row. `answered_s` [s] counts from the start; `error` belongs to the last frame.

        The sequences are kept as they are, and must not be changed afterwards.
        """
        if not tx:
            return
        batches = self._batches
        batches.append((self._next, priority, start_unix_s, tx, rx, answered_s, error))
        self._next += len(tx)
        oldest = self._next - self._kept
        while len(batches) > 1 and batches[1][0] <= oldest:
            batches.popleft()

    def page(self, after: int = 0, limit: int = FRAMES_KEPT) -> LogPage:
        """Up to `limit` frames from number `after` on; the oldest there is where that one is gone."""
        oldest = max(self._next - self._kept, 0)
        first = max(after, oldest)
        frames: list[LoggedFrame] = []
        for number, priority, start_unix_s, tx, rx, answered_s, error in self._batches:
            if number + len(tx) <= first:
                continue
            before_s = 0.0
            last = len(tx) - 1
            for index, sent in enumerate(tx):
                at_s = answered_s[index]
                if number + index >= first:
                    if len(frames) == limit:
                        break
                    text = error if index == last else ""
                    frames.append(
                        LoggedFrame(
                            number + index, start_unix_s + before_s, priority, sent, rx[index], at_s - before_s, text
                        )
                    )
                before_s = at_s
        # Who asks for what is not there yet (a log that began anew) goes on with what comes next.
        following = frames[-1].seq + 1 if frames else max(oldest, min(after, self._next))
        return LogPage(frames, following, max(0, oldest - after))
