"""Register words to what the compiled code works with: ENC_CONST, a circular range, the microstep wave."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ...drive.table import decode
from ...drive.units import bits, signed

BINARY, DECIMAL = 1 << 16, 10_000
"""What a fraction of ENC_CONST is divided by, without and with enc_sel_decimal."""
_MANUAL = 1 << 31


@dataclass(frozen=True, slots=True)
class EncoderScale:
    """Microsteps a count: numerator / denominator, and the word that says so."""

    numerator: int
    denominator: int
    word: int
    """ENC_CONST: 15 bits, then 16 bits of fraction."""


def encoder_scale(resolution_word: int, microsteps_a_turn: int, decimal: bool) -> EncoderScale:
    """ENC_CONST out of ENC_IN_RES (0x54, as written) and the microsteps of a turn.

    The written constant itself where bit 31 (manual_enc_const) is set, 0 where no resolution was written. The quotient
    is rounded to its last bit or decimal, and cut to 15 bits before the point.
    Source: NOTES-TMC4361-ENCODER 2.
    """
    one = DECIMAL if decimal else BINARY
    resolution = resolution_word & (_MANUAL - 1)
    if resolution_word & _MANUAL:
        numerator = (resolution >> 16) * one + (resolution & 0xFFFF)
    elif resolution == 0:
        numerator = 0
    else:
        numerator = (2 * microsteps_a_turn * one + resolution) // (2 * resolution) % (one << 15)
    return EncoderScale(numerator, one, numerator // one << 16 | numerator % one)


def microsteps_a_turn(step_conf: int) -> int:
    """Microsteps of a revolution by STEP_CONF: 256 >> MSTEP_PER_FS times FS_PER_REV."""
    return (256 >> min(bits(step_conf, 0, 4), 8)) * bits(step_conf, 4, 12)


def circular_period(word: Callable[[int], int]) -> float:
    """Microsteps after which a circular encoder's ENC_POS begins again; 0 without circular_enc_en.

    2 X_RANGE + CIRCULAR_DEC / 2^31, or a revolution with use_usteps_instead_of_xrange.
    """
    if not bits(word(0x01), 31, 1):
        return 0.0
    if bits(word(0x07), 15, 1):
        return float(microsteps_a_turn(word(0x0A)))
    return 2.0 * bits(word(0x36), 0, 31) + word(0x7C) / 2**31


def wave(word: Callable[[int], int]) -> tuple[int, ...]:
    """The 1024 currents that MSLUT, MSLUTSEL and START_SIN say."""
    return decode([word(0x70 + i) for i in range(8)], word(0x78), word(0x7E))


def signed32(word: int) -> int:
    """A register word as two's complement."""
    return signed(word, 32)
