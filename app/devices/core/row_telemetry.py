"""Telemetry in rows: the channels of a family's quantities, and how many rows a second its link is good for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ...errors import UnknownThing, UsageError
from .capabilities import Telemetry
from .sample_plan import Channel, SamplePlan, Taken
from .session import Session


@dataclass(frozen=True, slots=True)
class Pace:
    """How often a family's devices are asked [1/s], where no baud rate says less."""

    rows_emulated_hz: float = 1000.0
    rows_wire_hz: float = 1000.0
    frames_emulated_hz: float = 15_000.0
    """Of a chip in this process: a share of a core that leaves room for all else."""
    frames_wire_hz: float = 10_000.0
    """Of a wire that sets no limit of its own (spidev, USB, a socket)."""
    shares_rows: bool = True
    """Whether over a wire the history has to make do with the rows of readers."""


class RowTelemetry(Telemetry):
    """Takes one row after another; `quantities` are those of each axis, with their units."""

    def __init__(self, session: Session, quantities: Sequence[Mapping[str, str]], pace: Pace | None = None) -> None:
        self._session = session
        self._pace = pace or Pace()
        self._channels = {
            f"{name}.{axis}": Channel(f"{name}.{axis}", name, axis, unit)
            for axis, units in enumerate(quantities)
            for name, unit in units.items()
        }

    def channels(self) -> tuple[Channel, ...]:
        return tuple(self._channels.values())

    def chosen(self, channels: Sequence[str]) -> tuple[Channel, ...]:
        """Channels by name. Raises UnknownThing, and UsageError for none."""
        if not channels:
            raise UsageError("a sample of no channel")
        unknown = next((name for name in channels if name not in self._channels), None)
        if unknown is not None:
            raise UnknownThing("channel", unknown, list(self._channels))
        return tuple(self._channels[name] for name in channels)

    async def take_samples(self, plan: SamplePlan, rows: int = 1) -> Taken:
        del rows
        queue = self._session.queue
        time_s, replies = await queue.sample(plan.frames)
        first_s, last_s = queue.sample_span_s
        return Taken([time_s], [replies], last_s - first_s)

    def rows_at_once(self, plan: SamplePlan, rate_hz: float) -> int:
        del plan, rate_hz
        return 1

    @property
    def rate_max_hz(self) -> float:
        return self._row_rate(1)

    def sample_rate_max_hz(self, plan: SamplePlan) -> float:
        return self._row_rate(len(plan.frames))

    def _row_rate(self, frames: int) -> float:
        """Rows a second of so many frames each."""
        pace = self._pace
        if self._session.chip_timed:
            return min(pace.rows_emulated_hz, pace.frames_emulated_hz / frames)
        return min(pace.rows_wire_hz, (self.calls_per_s_possible or pace.frames_wire_hz) / frames)

    @property
    def shares_rows(self) -> bool:
        return self._pace.shares_rows and not self._session.chip_timed

    @property
    def calls_per_s_possible(self) -> float | None:
        return self._session.calls_per_s_possible

    @property
    def calls_per_s(self) -> float:
        return self._session.calls_per_s
