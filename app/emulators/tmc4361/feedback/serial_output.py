"""The serial encoder output: what a listener gets who clocks at SDODRV_SCLK while serial_enc_out_enable is set.

Facts: the pins (DS-TMC4361 2), the fields (API), and that ssi_out_mtime is the time after the last clock during which
the data stay the same. Read like this where the documents we have are silent: what is given is ENC_POS, as ENC_OUT_RES
counts a turn; turns come first where multi_turn_out_en is set, and both are cut to their bits; the value is taken with
the first clock of an answer; further clocks than bits get zeros; clocks whose halves are shorter than the filter of the
group ENC_OUT lets through are not seen, so the line stays high.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from .words import microsteps_a_turn

GENERAL_CONF, FILTERS, SPI_OUT_CONF, ENC_IN_CONF, ENC_OUT_DATA, STEP_CONF, ENC_OUT_RES = 0, 3, 4, 7, 9, 0xA, 0x55
ENABLE = 24
"""Bit of GENERAL_CONF."""
MULTI_OUT, GRAY_OUT = 14, 30
"""Bits of ENC_IN_CONF."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What the listener got: `bits` first to last, whether they are the `repeated` ones of the answer before."""

    bits: tuple[int, ...]
    repeated: bool


class SerialOutput:
    """One output. `word` gives a register as it was written."""

    def __init__(self, word: Callable[[int], int]) -> None:
        self._word = word
        self._value: int | None = None
        self._held_until = 0.0

    def reset(self) -> None:
        """As after power-on: nothing is held."""
        self._value = None

    @property
    def enabled(self) -> bool:
        """Whether the driver's pins give encoder data."""
        return bool(self._word(GENERAL_CONF) >> ENABLE & 1)

    @property
    def length(self) -> int:
        """Bits of an answer."""
        data = self._word(ENC_OUT_DATA)
        turns = (data >> 5 & 31) + 1 if self._word(ENC_IN_CONF) >> MULTI_OUT & 1 else 0
        return (data & 31) + 1 + turns

    def value_at(self, position: int) -> int:
        """The bits for ENC_POS `position`, the first one highest."""
        data, conf = self._word(ENC_OUT_DATA), self._word(ENC_IN_CONF)
        single = (data & 31) + 1
        turn = microsteps_a_turn(self._word(STEP_CONF))
        turns, within = divmod(position, turn) if turn else (0, 0)
        angle = within * (self._word(ENC_OUT_RES) & 0x7FFFFFFF) // turn if turn else 0
        value = angle & (1 << single) - 1
        if conf >> MULTI_OUT & 1:
            value |= (turns & (1 << (data >> 5 & 31) + 1) - 1) << single
        return value ^ value >> 1 if conf >> GRAY_OUT & 1 else value

    def listen(self, position: int, clock: float, clocks: int, bit_clocks: float) -> Answer:
        """`clocks` clocks that begin at `clock`, each `bit_clocks` of the chip's own long, ENC_POS being `position`."""
        if not self.enabled or bit_clocks / 2 < self._shortest_half:
            return Answer((1,) * clocks, False)
        repeated = self._value is not None and clock < self._held_until
        if self._value is None or not repeated:
            self._value = self.value_at(position)
        length = self.length
        bits = tuple(self._value >> (length - 1 - place) & 1 if place < length else 0 for place in range(clocks))
        self._held_until = clock + clocks * bit_clocks + (self._word(SPI_OUT_CONF) >> 4 & 0xFFFFF)
        return Answer(bits, repeated)

    @property
    def _shortest_half(self) -> int:
        """Clocks that a level of the listener's clock has to last (DS-TMC4361 6)."""
        group = self._word(FILTERS) >> 24
        return ((group >> 4 & 7) + 1) << (group & 7)
