"""The microstep table of the MSLUT family: a quarter wave of 256 values as one-bit differences, and back.

TMC4361 has it, and TMC2130 and TMC5xxx at other addresses. Bit i says by which of two neighbouring amounts entry i
differs from entry i - 1; MSLUTSEL says which two, in up to four segments; MSLUTSTART holds where both phases begin.
The rule was read from public drivers and holds for register dumps of real chips (the tests have them); the TMC4361
data sheet that we had (DS-TMC4361) ends before its chapter 11.2, which describes the table.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..driver_chain.ram_words import whole_number

ENTRIES = 256
POSITIONS = 1024
"""Microsteps of an electrical period: what MSCNT counts."""
SEGMENTS = 4
VALUE_MAX = 255
STEP_MIN, STEP_MAX = -1, 3
MIRROR_DEFAULT = -1
CURRENT_MIN, CURRENT_MAX = -256, 255
"""The current registers hold 9 bits with a sign."""

Reason = Literal["value", "zero_crossing", "difference", "segments", "negative_half", "asymmetric"]


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a wave cannot be encoded, and where: `index` is the entry 0..255 of the quarter wave."""

    index: int
    reason: Reason
    detail: str


class NotEncodable(ValueError):
    """A wave that no register values make; the first place and its reason."""

    def __init__(self, refusal: Refusal) -> None:
        super().__init__(f"entry {refusal.index}: {refusal.detail}")
        self.refusal = refusal


@dataclass(frozen=True, slots=True)
class Segment:
    """Entries `first` to `last`, both included, each `low` or `low` + 1 above the one before it."""

    first: int
    last: int
    low: int

    @property
    def width(self) -> int:
        """W of MSLUTSEL, 0..3."""
        return self.low - STEP_MIN


@dataclass(frozen=True, slots=True)
class MslutRegisters:
    """`words` MSLUT[0..7], `select` MSLUTSEL, `start` MSLUTSTART (START_SIN 7:0, START_SIN90 23:16, DAC_OFFSET 31:24).

    Raises ValueError for any other number of words, and for one that is not 32 bits.
    """

    words: tuple[int, ...]
    select: int
    start: int

    def __post_init__(self) -> None:
        if len(self.words) != 8:
            raise ValueError(f"a table has 8 words MSLUT[0..7], these are {len(self.words)}")
        for index, word in enumerate(self.words):
            whole_number(f"MSLUT[{index}]", word, 0, 0xFFFF_FFFF)
        whole_number("MSLUTSEL", self.select, 0, 0xFFFF_FFFF)
        whole_number("MSLUTSTART", self.start, 0, 0xFFFF_FFFF)

    @property
    def start_sin(self) -> int:
        return self.start & 0xFF

    def with_dac_offset(self, offset: int) -> MslutRegisters:
        """The same wave beside another DAC_OFFSET, which shares MSLUTSTART in the TMC4361."""
        return MslutRegisters(self.words, self.select, self.start & 0x00FF_FFFF | (offset & 0xFF) << 24)


POWER_ON = MslutRegisters(
    (0xAAAAB554, 0x4A9554AA, 0x24492929, 0x10104222, 0xFBFFFFFF, 0xB5BB777D, 0x49295556, 0x00404222),
    0xFFFF8056,
    0x00F70000,
)
"""What every chip of the family holds after power-on."""


@dataclass(frozen=True, slots=True)
class Wave:
    """A quarter wave as the chip runs it: `values` (256), and `mirror`, so that the negative half is mirror - value.

    -1 makes the negative half the bitwise complement, as in the power-on wave; 0 makes it the exact opposite.
    """

    values: tuple[int, ...]
    mirror: int = MIRROR_DEFAULT

    @property
    def zero_step(self) -> int:
        """What the wave drops by from position 511 to 512, where it crosses zero: difference 0 of the table."""
        return 2 * self.values[0] - self.mirror

    def period(self) -> NDArray[np.int64]:
        """Current of phase A at MSCNT 0..1023, shape (1024,) [counts]; phase B is 256 positions ahead."""
        quarter = np.asarray(self.values, dtype=np.int64)
        half = np.concatenate([quarter, quarter[::-1]])
        return np.concatenate([half, self.mirror - half])

    def currents(self, position: int) -> tuple[int, int]:
        """Phases A and B at a position of MSCNT, any whole number [counts]."""
        return self._current(position), self._current(position + ENTRIES)

    def _current(self, position: int) -> int:
        half, within = divmod(position % POSITIONS, 2 * ENTRIES)
        value = self.values[within if within < ENTRIES else 2 * ENTRIES - 1 - within]
        return self.mirror - value if half else value


def segments_of(select: int) -> tuple[Segment, ...]:
    """The segments that hold entries, from MSLUTSEL: X1..X3 are where segments 1..3 begin.

    Neighbours of the same pair are one: what is left over repeats the last one.
    """
    borders = [0, *sorted(_borders(select)), ENTRIES]
    found: list[Segment] = []
    for number in range(SEGMENTS):
        first, last = borders[number], borders[number + 1] - 1
        low = (select >> 2 * number & 3) + STEP_MIN
        if first <= last and found and found[-1].low == low:
            found[-1] = Segment(found[-1].first, last, low)
        elif first <= last:
            found.append(Segment(first, last, low))
    return tuple(found)


def decode(registers: MslutRegisters) -> Wave:
    """The wave that register values make, whatever they are; its values may leave 0..255 if they were not encoded."""
    # an entry is in the segment of as many borders as it has passed, also where they are out of order (a reading)
    borders = _borders(registers.select)
    lows = [(registers.select >> 2 * segment & 3) + STEP_MIN for segment in range(SEGMENTS)]
    values = [registers.start_sin]
    for index in range(1, ENTRIES):
        values.append(values[-1] + lows[sum(index >= border for border in borders)] + _bit(registers, index))
    zero_step = lows[sum(border == 0 for border in borders)] + _bit(registers, 0)
    return Wave(tuple(values), 2 * registers.start_sin - zero_step)


def encode(values: Sequence[int], mirror: int = MIRROR_DEFAULT) -> MslutRegisters:
    """The registers of a quarter wave of 256 values of 0..255, in as few segments as there can be.

    Raises NotEncodable for the first place that cannot be, and ValueError for any other number of values.
    """
    wave = checked(values, mirror)
    for refusal in refusals(wave):
        raise NotEncodable(refusal)
    return encode_in(wave, _segments(wave))


def encode_in(wave: Wave, segments: Sequence[Segment]) -> MslutRegisters:
    """The registers of a wave in given segments: they decide nothing but where the differences change their pair.

    Raises NotEncodable where a difference is not of its segment's pair.
    """
    steps = _steps(wave)
    words = [0] * 8
    for segment in segments:
        for index in range(segment.first, segment.last + 1):
            bit = steps[index] - segment.low
            if bit not in (0, 1):
                raise NotEncodable(
                    Refusal(index, "difference", f"its difference is {steps[index]}, that of the segment {segment.low}")
                )
            words[index >> 5] |= bit << (index & 31)
    # What is left over repeats the last one: a border of 255 alone would still give entry 255 to the last segment.
    padded = [*segments, *[Segment(255, 255, segments[-1].low)] * (SEGMENTS - len(segments))]
    select = sum(segment.width << 2 * number for number, segment in enumerate(padded))
    select |= sum(segment.first << 8 * number for number, segment in enumerate(padded) if number)
    return MslutRegisters(tuple(words), select, wave.values[0] | wave.values[-1] << 16)


def refusals(wave: Wave) -> Iterator[Refusal]:
    """Every place at which a wave cannot be encoded, from left to right; none for an encodable one."""
    low = high = 0
    begun = 0
    for index, step in enumerate(_steps(wave)):
        value = wave.values[index]
        if not 0 <= value <= VALUE_MAX:
            yield Refusal(index, "value", f"its value is {value}, allowed is 0..{VALUE_MAX}")
        elif not CURRENT_MIN <= wave.mirror - value <= CURRENT_MAX:
            told = f"its negative half is {wave.mirror - value}, allowed is {CURRENT_MIN}..{CURRENT_MAX}"
            yield Refusal(index, "negative_half", told)
        if not STEP_MIN <= step <= STEP_MAX:
            allowed = f"allowed is {STEP_MIN}..+{STEP_MAX}"
            if index:
                yield Refusal(index, "difference", f"it differs by {step:+d} from the one before, {allowed}")
            else:
                yield Refusal(0, "zero_crossing", f"the wave would step by {step:+d} at its zero crossing, {allowed}")
            continue
        if begun and max(high, step) - min(low, step) <= 1:
            low, high = min(low, step), max(high, step)
            continue
        begun += 1
        low = high = step
        if begun > SEGMENTS:
            yield Refusal(
                index,
                "segments",
                f"segment {begun} would begin here, a table has {SEGMENTS} (each holds two neighbouring differences)",
            )


def checked(values: Sequence[int], mirror: int = MIRROR_DEFAULT) -> Wave:
    """A wave of 256 whole numbers, whether it can be encoded or not. Raises ValueError for anything else."""
    if len(values) != ENTRIES:
        raise ValueError(f"a quarter wave has {ENTRIES} values, this one has {len(values)}")
    whole = tuple(whole_number(f"value {index}", value, -0x8000, 0x7FFF) for index, value in enumerate(values))
    return Wave(whole, whole_number("mirror", mirror, -0x8000, 0x7FFF))


def _segments(wave: Wave) -> list[Segment]:
    """As long as each can be: a stretch of an encodable segment is encodable, so no other way has fewer."""
    found: list[Segment] = []
    steps = _steps(wave)
    first, low, high = 0, steps[0], steps[0]
    for index, step in enumerate(steps):
        if max(high, step) - min(low, step) > 1:
            found.append(Segment(first, index - 1, min(low, STEP_MAX - 1)))
            first, low, high = index, step, step
        low, high = min(low, step), max(high, step)
    return [*found, Segment(first, ENTRIES - 1, min(low, STEP_MAX - 1))]


def _steps(wave: Wave) -> list[int]:
    return [wave.zero_step, *(after - before for before, after in pairwise(wave.values))]


def _borders(select: int) -> list[int]:
    return [select >> shift & 0xFF for shift in (8, 16, 24)]


def _bit(registers: MslutRegisters, index: int) -> int:
    return registers.words[index >> 5] >> (index & 31) & 1
