"""What samples of register chips are made of: the words of a row, each asked once, and columns out of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...links.register_access import RegisterAccess
from ...registers.model import Field, Register
from .prediction import wrapped
from .sample_plan import Channel, Decoder, FloatArray, SamplePlan, Seen, WordsPlan, form_of


class Asked:
    """The registers of one row: each once."""

    def __init__(self) -> None:
        self.registers: list[Register] = []

    def column(self, register: Register) -> int:
        """Which word of a row holds `register`."""
        if register not in self.registers:
            self.registers.append(register)
        return self.registers.index(register)


def words_plan(
    access: RegisterAccess,
    asked: Asked,
    channels: tuple[Channel, ...],
    decoders: tuple[Decoder, ...],
    seen: Seen | None = None,
) -> SamplePlan:
    """The plan that asks for these registers over whatever link there is."""
    frames = access.read_frames([register.address for register in asked.registers])
    return WordsPlan(frames, channels, access.reply_bytes, decoders, form_of(access), seen)


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
