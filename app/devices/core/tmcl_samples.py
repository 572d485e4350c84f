"""Samples of a TMCL module over its link: questions for parameters, how many of them fit, and what the answers mean."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import BadReply, LinkTimeout
from ...links.queue import Priority
from ...links.tmcl import FRAME_BYTES
from ...registers.tmcl.commands import Status
from .row_telemetry import Pace
from .sample_plan import FloatArray, SamplePlan, Taken
from .session import Session

PACE = Pace(frames_emulated_hz=10_000.0)
"""An emulated module answers 180,000 questions a second in this process, so these cost 6 % of a core."""
SATURATED = 0.8
"""From this share of a wire on, rows are taken several at once: the way to the wire's thread and back costs a row of
one question a tenth of its time."""
AT_ONCE_S = 0.033
"""How long the rows taken at once last [s]: less than a beat of the screen later than they could be."""

TmclDecoder = Callable[[FloatArray, FloatArray], FloatArray]
"""(time_s[rows], values[rows, questions], NaN where an answer was wrong) to one column [rows]."""


@dataclass(frozen=True, slots=True)
class TmclPlan(SamplePlan):
    """Answers of nine bytes."""

    columns: tuple[TmclDecoder, ...]
    seen: Callable[[FloatArray, FloatArray], None] | None = None
    """Hears the times and values of each block, e.g. to learn that a motion has ended."""

    def decode(self, times_s: FloatArray, replies: bytes) -> FloatArray:
        count = len(times_s)
        values = values_of(self.frames, self.cut(count, replies))
        if self.seen is not None and count:
            self.seen(times_s, values)
        columns = np.empty((count, len(self.columns)))
        for index, decode in enumerate(self.columns):
            columns[:, index] = decode(times_s, values)
        return columns


def values_of(frames: Sequence[bytes], answers: NDArray[np.uint8]) -> FloatArray:
    """The values of `answers` [rows, frames, bytes] to `frames` [rows, frames].

    NaN where an answer is not sound: its checksum, its module, its command, or a status that is not 100.
    """
    asked = np.frombuffer(b"".join(frames), dtype=np.uint8).reshape(len(frames), FRAME_BYTES)
    # uint8 sums wrap at 256 by themselves, which is what the checksum does.
    sound = answers[:, :, :8].sum(axis=2, dtype=np.uint8) == answers[:, :, 8]
    sound &= answers[:, :, 1] == asked[:, 0]
    sound &= answers[:, :, 2] == Status.OK
    sound &= answers[:, :, 3] == asked[:, 1]
    values = np.ascontiguousarray(answers[:, :, 4:8]).view(">i4")[:, :, 0].astype(np.float64)
    values[~sound] = np.nan
    return values


class TmclSampler:
    """Takes the rows of a plan: what every module's telemetry has in common, whatever its channels are."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._row_spread_latest_s = 0.0

    def rows_at_once(self, plan: SamplePlan, rate_hz: float) -> int:
        possible, questions = self._session.calls_per_s_possible, len(plan.frames)
        if possible is None or rate_hz * questions < SATURATED * possible:
            return 1
        return max(1, int(AT_ONCE_S * possible / questions))

    async def take_samples(self, plan: SamplePlan, rows: int = 1) -> Taken:
        try:
            return await self._take(plan, rows)
        except (BadReply, LinkTimeout):
            # The link is in step again, and a row only reads: one flipped bit must not make a hole of a quarter second.
            return await self._take(plan, 1)

    async def _take(self, plan: SamplePlan, rows: int) -> Taken:
        """Several rows in one go; each bears the middle of the time between its first and its last answer."""
        count = len(plan.frames)
        frames = plan.frames * rows if rows > 1 else plan.frames
        async with self._session.queue.turn(Priority.SAMPLE) as turn:
            answers = await turn.exchange_many(frames)
            first_s, last_s = self._session.queue.sample_span_s = turn.span_s
        line = self._session.port.traits.batches
        if line is not None and len(line.batch.answered_s) == len(frames):
            answered_s = line.batch.started_s + np.array(line.batch.answered_s)
        else:  # something more urgent came between: the answers are taken to lie evenly
            answered_s = np.linspace(first_s, max(first_s, last_s), len(frames))
        begin_s, end_s = answered_s[::count], answered_s[count - 1 :: count]
        replies = [b"".join(answers[row * count : (row + 1) * count]) for row in range(rows)]
        self._row_spread_latest_s = float((end_s - begin_s).max())
        return Taken(((begin_s + end_s) / 2).tolist(), replies, float((end_s - begin_s).mean()))

    def row_spread_s(self) -> float:
        """From the first to the last question of a row [s]: none where the device samples itself."""
        return 0.0 if self._session.chip_timed else self._row_spread_latest_s
