"""Channels of such a driver. Every question writes DRVCONF, so its frames are made when it is asked, never before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ....links.queue import Priority
from ....links.spi_access import TaggedAccess
from ....registers.model import Register
from ...core.register_link import RegisterLink
from ...core.row_telemetry import RowTelemetry
from ...core.sample_plan import Channel, FloatArray, SamplePlan, Taken
from ..telemetry import DRIVER_FLAGS
from .memory import TaggedMemory

QUANTITIES = {
    "load_value": "",
    "actual_current_scale": "1/32",
    "mscnt": "1/1024 turn",
    "driver_flags": "bits",
}
UNASKED = 0xF
"""Lowest four bits of a reply that stands for one that could not be asked for."""
FLAG_BITS = ("SG", "OT", "OTPW", "S2GA", "S2GB", "OLA", "OLB", "STST")
assert len(FLAG_BITS) == len(DRIVER_FLAGS)


@dataclass(frozen=True, slots=True)
class StatusPlan(SamplePlan):
    """Answers by row; each channel is a field of one. `frames` only say how many there are."""

    rows: tuple[Register, ...]
    columns: tuple[tuple[int, int, int], ...]
    """By channel: which row, lowest bit, width."""

    def decode(self, times_s: FloatArray, replies: bytes) -> FloatArray:
        raw = self.cut(len(times_s), replies)[:, 1::2]
        words = np.zeros(raw.shape[:2], dtype=np.int64)
        for place in range(self.reply_bytes):
            words = words << 8 | raw[:, :, place]
        columns = np.empty((len(times_s), len(self.columns)))
        for index, (row, lsb, width) in enumerate(self.columns):
            word = words[:, row]
            value = (word >> lsb + 4 & (1 << width) - 1).astype(np.float64)
            value[(word & UNASKED != 0) & ((word & UNASKED == UNASKED) | (lsb >= 8))] = np.nan
            columns[:, index] = value
        return columns


class TaggedTelemetry(RowTelemetry):
    """The channels of the axis, over datagrams on SPI."""

    def __init__(self, link: RegisterLink, memory: TaggedMemory) -> None:
        super().__init__(link.session, [QUANTITIES])
        self._link = link
        self._memory = memory

    def sample_plan(self, channels: Sequence[str]) -> SamplePlan:
        chosen = self.chosen(channels)
        rows: list[Register] = []
        columns = []
        for channel in chosen:
            row, name = self._place(channel)
            if row not in rows:
                rows.append(row)
            part = row.field_named(name)
            lsb, width = (0, len(FLAG_BITS)) if part is None else (part.lsb, part.width)
            columns.append((rows.index(row), lsb, width))
        access = self._link.access
        frames = (bytes(access.frame_bytes),) * (2 * len(rows))
        return StatusPlan(frames, chosen, access.reply_bytes, tuple(rows), tuple(columns))

    def _place(self, channel: Channel) -> tuple[Register, str]:
        rows = self._memory.rows
        return {
            "load_value": (rows.load, "SG_RESULT"),
            "actual_current_scale": (rows.scale, "SE"),
            "mscnt": (rows.place, "MSTEP"),
            "driver_flags": (rows.scale, ""),
        }[channel.quantity]

    async def take_samples(self, plan: SamplePlan, rows: int = 1) -> Taken:
        assert isinstance(plan, StatusPlan)
        assert isinstance(self._link.access, TaggedAccess)
        queue = self._session.queue
        if not self._memory.answers:
            nothing = bytes([0xFF]) * plan.row_bytes
            return Taken([self._session.device_time_s()], [nothing], 0.0)
        async with queue.turn(Priority.SAMPLE) as turn:
            replies = await turn.exchange_many(self._link.access.read_frames([row.address for row in plan.rows]))
            first_s, last_s = turn.span_s
        return Taken([(first_s + last_s) / 2], [b"".join(replies)], last_s - first_s)
