"""What samples of register chips are made of: the words of a row, each asked once, and columns out of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...errors import UnknownThing, UsageError
from ...links.register_access import UartAccess
from ...registers.model import Field, Register
from .prediction import wrapped
from .sample_plan import (
    BoardPlan,
    Channel,
    Decoder,
    FloatArray,
    PipelinedPlan,
    PlainUartPlan,
    SamplePlan,
    Seen,
    UartPlan,
    WordsPlan,
)
from .shadow_registers import KeepingChip

IntArray = NDArray[np.int64]

ROW_RATE_MAX_HZ = 1000.0
FRAMES_EMULATED_HZ = 15_000.0
"""Datagrams a second asked of an emulated chip in this process: a share of a core that leaves room for all else."""
FRAMES_WIRE_HZ = 10_000.0
"""The same for a wire that sets no limit of its own (spidev, a socket)."""


class Asked:
    """The registers of one row: each once."""

    def __init__(self) -> None:
        self.registers: list[Register] = []

    def column(self, register: Register) -> int:
        """Which word of a row holds `register`."""
        if register not in self.registers:
            self.registers.append(register)
        return self.registers.index(register)


class WordSamples(KeepingChip):
    """A register chip with telemetry."""

    @property
    def rate_max_hz(self) -> float:
        return self._row_rate(2)

    def sample_rate_max_hz(self, plan: SamplePlan) -> float:
        return self._row_rate(len(plan.frames))

    def _row_rate(self, frames: int) -> float:
        """Rows a second of so many frames each."""
        possible = FRAMES_EMULATED_HZ if self.chip_timed else self.calls_per_s_possible or FRAMES_WIRE_HZ
        return min(ROW_RATE_MAX_HZ, possible / frames)

    @property
    def shares_rows(self) -> bool:
        return not self.chip_timed

    def chosen(self, channels: Sequence[str]) -> tuple[Channel, ...]:
        """Channels by name. Raises UnknownThing, and UsageError for none."""
        if not channels:
            raise UsageError("a sample of no channel")
        known = {channel.name: channel for channel in self.channels()}
        unknown = next((name for name in channels if name not in known), None)
        if unknown is not None:
            raise UnknownThing("channel", unknown, list(known))
        return tuple(known[name] for name in channels)

    def words_plan(
        self, asked: Sequence[Register], channels: tuple[Channel, ...], decoders: tuple[Decoder, ...], seen: Seen | None
    ) -> SamplePlan:
        """The plan that asks for these registers over whatever link there is."""
        frames = self.access.read_frames([register.address for register in asked])
        kind: type[WordsPlan] = PipelinedPlan if len(frames) > len(asked) else BoardPlan
        if isinstance(self.access, UartAccess):
            kind = PlainUartPlan if self.access.form.node is None else UartPlan
        return kind(frames, channels, decoders, seen)


def number(column: int, register: Register, unit: float = 1.0) -> Decoder:
    """The register's value, signed where it is, times `unit`."""
    mask = (1 << register.width) - 1
    sign = 1 << (register.width - 1) if register.signed else 0
    return lambda _, words, __: np.asarray((((words[:, column] & mask) ^ sign) - sign) * unit, dtype=np.float64)


def field(column: int, part: Field) -> Decoder:
    """A field's value, signed where it is."""
    mask = (1 << part.width) - 1
    sign = 1 << (part.width - 1) if part.signed else 0
    return lambda _, words, __: (((words[:, column] >> part.lsb & mask) ^ sign) - sign).astype(np.float64)


def residual(position: Decoder, expected: Callable[[FloatArray], tuple[FloatArray, FloatArray]], bits: int) -> Decoder:
    """Measured less expected position, the shorter way round."""
    return lambda times_s, words, status: wrapped(position(times_s, words, status) - expected(times_s)[0], bits)


def channels_of(quantities: Mapping[str, str], axis: int) -> tuple[Channel, ...]:
    """Channels of one axis by quantity and unit."""
    return tuple(Channel(f"{name}.{axis}", name, axis, unit) for name, unit in quantities.items())
