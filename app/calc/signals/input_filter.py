"""Digital filter at the input pins of the TMC4361: what of a waveform gets through, clock by clock.

Four groups of pins have a filter each. It looks at its pin every 2^SR clocks, and takes a new level over when
FILT_L + 1 samples in a row have it. So a pulse of up to FILT_L sample periods never passes, one of FILT_L + 1 always
does, and what lies between depends on where the samples fall; an edge comes FILT_L to FILT_L + 1 periods late.

The data sheet does not say on which clocks samples fall after a reset, nor whether the new level counts in the clock
of the sample or in the next: here samples fall on clock 0 and every 2^SR after it (`phase` shifts them), and a level
counts from the clock of the sample that decides. The oracle in the tests says the same in another way.

Source: DS-TMC4361 6, 6.1, 6.1.1, 6.1.2, 6.1.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

Levels = NDArray[np.uint8]

SAMPLE_RATE_MAX: Final = 7
LENGTH_MAX: Final = 7
CLOCKS_MAX: Final = 1 << 20
"""Longest waveform that is worked on: 65 ms at 16 MHz, a thousand times the slowest filter."""


@dataclass(frozen=True, slots=True)
class Group:
    """One of the four filters as INPUT_FILT_CONF sets it."""

    suffix: str
    """As the register's fields end: enc_in, ref, s, enc_out."""
    pins: tuple[str, ...]
    sample_rate: int
    """SR, 0..7: a sample every 2^SR clocks."""
    length: int
    """FILT_L, 0..7: FILT_L + 1 equal samples make a level."""
    step_input: bool
    """Whether it also filters STPIN and DIRIN."""


GROUP_PINS: Final[tuple[tuple[str, tuple[str, ...]], ...]] = (
    ("enc_in", ("A_SCLK", "B_SDI", "N", "ANEG_NSCLK", "BNEG_NSDI", "NNEG")),
    ("ref", ("STOPL", "HOME_REF", "STOPR")),
    ("s", ("START",)),
    ("enc_out", ("SDODRV_SCLK", "SDIDRV_NSCLK")),
)
"""(suffix, pins) by byte of INPUT_FILT_CONF, lowest first."""


def groups(input_filt_conf: int) -> tuple[Group, ...]:
    """The four filters of a word of INPUT_FILT_CONF, lowest byte first. Raises ValueError beyond 32 bits."""
    if not 0 <= input_filt_conf < 1 << 32:
        raise ValueError(f"INPUT_FILT_CONF has 32 bits, got {input_filt_conf:#x}")
    found = []
    for number, (suffix, pins) in enumerate(GROUP_PINS):
        byte = input_filt_conf >> 8 * number & 0xFF
        found.append(Group(suffix, pins, byte & 7, byte >> 4 & 7, bool(byte >> 7)))
    return tuple(found)


@dataclass(frozen=True, slots=True)
class Bounds:
    """What a filter does to edges and pulses, in clocks; `seconds` turns them into time.

    The real edge lies between two clocks, so in continuous time each number may be one clock more.
    """

    period_clocks: int
    """Between two samples."""
    delay_min_clocks: int
    delay_max_clocks: int
    """From the first clock with a new level to the clock from which it counts."""
    stopped_clocks: int
    """Pulses up to here never pass."""
    passed_clocks: int
    """Pulses from here on always pass."""
    clock_hz: float

    def seconds(self, clocks: int) -> float:
        """So many clocks as time [s]."""
        return clocks / self.clock_hz


def bounds(sample_rate: int, length: int, clock_hz: float = 16e6) -> Bounds:
    """What the filter SR = `sample_rate`, FILT_L = `length` does at `clock_hz` [Hz].

    Raises ValueError unless both are 0..7 and the clock is finite and above 0.
    """
    period = 1 << _setting("sample_rate", sample_rate, SAMPLE_RATE_MAX)
    _setting("length", length, LENGTH_MAX)
    if not 0 < clock_hz < float("inf"):
        raise ValueError("clock_hz is a finite frequency above 0 Hz")
    return Bounds(
        period_clocks=period,
        delay_min_clocks=length * period,
        delay_max_clocks=(length + 1) * period - 1,
        stopped_clocks=length * period,
        passed_clocks=(length + 1) * period,
        clock_hz=clock_hz,
    )


@dataclass(frozen=True, slots=True)
class Filtered:
    """A waveform before and after the filter, with the places where it was looked at."""

    input: Levels
    """0 or 1 for each clock."""
    output: Levels
    """The level that the chip works with, 0 or 1 for each clock."""
    sample_clocks: NDArray[np.int64]
    """Clocks on which a sample was taken."""
    samples: Levels
    """The level of each sample."""


def filtered(levels: ArrayLike, sample_rate: int, length: int, initial: int | None = None, phase: int = 0) -> Filtered:
    """What the filter makes of a pin's `levels`, one (0 or 1, or bool) for each clock.

    Parameters
    ----------
    levels : array_like, shape (clocks,), 1 to CLOCKS_MAX
        Level of the pin after its Schmitt trigger.
    sample_rate, length : int, 0 to 7
        SR and FILT_L.
    initial : 0 or 1, optional
        Level at the pin, and after the filter, all the time before; the first one of `levels` where not given.
    phase : int, 0 to 2^SR - 1
        Clock of the first sample.

    Raises ValueError outside of these ranges. Source: DS-TMC4361 6.1.1, 6.1.2.
    """
    pin = _levels(levels)
    limits = bounds(sample_rate, length)
    if not 0 <= phase < limits.period_clocks:
        raise ValueError(f"phase is 0 to {limits.period_clocks - 1} clocks with SR = {sample_rate}, not {phase}")
    before = int(pin[0]) if initial is None else _setting("initial", initial, 1)
    sample_clocks = np.arange(phase, pin.size, limits.period_clocks)
    samples = pin[sample_clocks]
    # How many equal samples end here: those before the waveform count as many as are wanted.
    extended = np.concatenate((np.full(length + 1, before, np.uint8), samples))
    changed = np.flatnonzero(np.diff(extended)) + 1
    begin = np.zeros(extended.size, np.int64)
    begin[changed] = changed
    run = np.arange(extended.size) - np.maximum.accumulate(begin) + 1
    decided = np.where(run > length, np.arange(extended.size), 0)
    level_after = extended[np.maximum.accumulate(decided)][length + 1 :]
    # Between samples the level stays; before the first one it is the initial level.
    held = np.concatenate((np.full(1, before, np.uint8), level_after))
    clocks = np.arange(pin.size)
    output = held[np.where(clocks < phase, 0, (clocks - phase) // limits.period_clocks + 1)]
    return Filtered(pin, output, sample_clocks, samples)


def levels_of(edges: Sequence[int], clocks: int, first: int = 0) -> Levels:
    """A waveform of so many `clocks` (1 to CLOCKS_MAX) that begins with level `first` and changes at each edge.

    `edges` are clocks in rising order, each below `clocks`. Raises ValueError otherwise.
    """
    if not 1 <= clocks <= CLOCKS_MAX:
        raise ValueError(f"clocks is 1 to {CLOCKS_MAX}, not {clocks}")
    places = np.asarray(edges, dtype=np.int64)
    if places.size and (places[0] < 0 or places[-1] >= clocks or np.any(np.diff(places) <= 0)):
        raise ValueError(f"edges are clocks in rising order, 0 to {clocks - 1}")
    turns = np.searchsorted(places, np.arange(clocks), side="right")
    return ((turns + _setting("first", first, 1)) % 2).astype(np.uint8)


@dataclass(frozen=True, slots=True)
class Example:
    """A setting that the data sheet draws, with a waveform of ours that shows what it does."""

    figure: str
    group: str
    sample_rate: int
    length: int
    pin: str
    edges: tuple[int, ...]
    clocks: int


EXAMPLES: Final = (
    Example("6.1", "ref", 1, 1, "HOME_REF", (3, 4, 9, 12, 17, 24, 26, 27), 36),
    Example("6.2", "s", 2, 0, "START", (2, 4, 7, 10, 17, 25, 29, 30), 40),
    Example("6.3", "enc_in", 0, 7, "A_SCLK", (4, 11, 14, 26, 28, 29, 40, 47), 56),
)
"""The settings of figures 6.1 to 6.3. Our copy of DS-TMC4361 has lost the drawings, so the waveforms are not theirs."""


def _setting(name: str, value: int, highest: int) -> int:
    if value not in range(highest + 1):
        raise ValueError(f"{name} is 0 to {highest}, not {value}")
    return int(value)


def _levels(levels: ArrayLike) -> Levels:
    array = np.asarray(levels)
    if array.ndim != 1 or not 1 <= array.size <= CLOCKS_MAX:
        raise ValueError(f"levels are one for each of 1 to {CLOCKS_MAX} clocks")
    if not np.all((array == 0) | (array == 1)):
        raise ValueError("levels are 0 or 1")
    return array.astype(np.uint8)
