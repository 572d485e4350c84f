"""How often a driver chain can be told something: SPI clock, datagrams, continuous updates, full steps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from .ram_words import whole_number

CLK2_DIV_LOWEST = 7
"""The chip's internal work allows no faster clock; smaller values only make it asymmetric (DS-TMC428 9.7)."""
CLK2_DIV_MAX = 255
RAMP_DIV_MAX = 13
AXES = 3
CONTINUOUS_UPDATE_CLOCKS = 32_768


class SendsBits(Protocol):
    """Whatever knows how long a chain's datagram is: a built chain or a decoded one."""

    @property
    def lsmd(self) -> int: ...

    @property
    def length_bits(self) -> int | None: ...


@dataclass(frozen=True, slots=True)
class ChainFrequencies:
    """Frequencies of a chain [Hz]. `nxm_clocks` is what each NxM bit costs in SPI clocks: 1 or 1.5.

    `datagram_hz` is the sheet's upper limit. `full_step_max_hz` is 2.1's: one datagram per full
    step, gaps not counted. `continuous_update_hz` is None where no ramp_div was given.
    """

    clk2_div_effective: int
    spi_clock_hz: float
    nxm_clocks: float
    datagram_clocks: float
    datagram_hz: float
    full_step_max_hz: float
    continuous_update_hz: float | None
    warnings: tuple[str, ...]


def chain_frequencies(
    chain: SendsBits, clock_hz: float, clk2_div: int, ramp_divs: Sequence[int] | None = None
) -> ChainFrequencies:
    """Frequencies of `chain` with the chip at `clock_hz` [Hz].

    `clk2_div` is 0..255, of which 0..6 act as 7. `ramp_divs` are the ramp_div (0..13) of all three
    axes: their ramp clocks pace the continuous updates, wired motors or not.

    - SPI clock: f_clk / (2 * (clk2_div + 1));
    - datagram: f_spi / (1 + length + drivers * n + 1), n = 1 for clk2_div = 7, else 1.5;
    - continuous update: f_clk * (2^-ramp_div_0 + 2^-ramp_div_1 + 2^-ramp_div_2) / 32768;
    - full step: f_spi / length, which at clk2_div = 7 is f_clk / 16 / length.

    Source: DS-TMC428 9.7 and 2.1. Raises ValueError for a chain that sends endlessly, and out of range.
    """
    if not (math.isfinite(clock_hz) and clock_hz > 0):
        raise ValueError(f"clock_hz is {clock_hz}, but has to be a frequency above 0 Hz")
    if chain.length_bits is None:
        raise ValueError("the chain never ends its datagram (no NxM bit): it has no frequencies")
    divider = max(whole_number("clk2_div", clk2_div, 0, CLK2_DIV_MAX), CLK2_DIV_LOWEST)
    spi_hz = clock_hz / (2 * (divider + 1))
    nxm_clocks = 1.0 if divider == CLK2_DIV_LOWEST else 1.5
    clocks = 1 + chain.length_bits + (chain.lsmd + 1) * nxm_clocks + 1
    datagram_hz = spi_hz / clocks
    update_hz = None if ramp_divs is None else _continuous_update_hz(clock_hz, ramp_divs)
    warnings: list[str] = []
    if clk2_div < CLK2_DIV_LOWEST:
        warnings.append(f"clk2_div {clk2_div} clocks no faster than 7 and makes the SPI clock asymmetric; use 7")
    if update_hz is not None and update_hz > datagram_hz:
        warnings.append(f"continuous updates would come at {update_hz:.0f} Hz, the chain takes {datagram_hz:.0f} Hz")
    return ChainFrequencies(
        clk2_div_effective=divider,
        spi_clock_hz=spi_hz,
        nxm_clocks=nxm_clocks,
        datagram_clocks=clocks,
        datagram_hz=datagram_hz,
        full_step_max_hz=spi_hz / chain.length_bits,
        continuous_update_hz=update_hz,
        warnings=tuple(warnings),
    )


def _continuous_update_hz(clock_hz: float, ramp_divs: Sequence[int]) -> float:
    if len(ramp_divs) != AXES:
        raise ValueError(f"ramp_divs are those of all {AXES} axes, these are {len(ramp_divs)}")
    checked = [whole_number(f"ramp_div of axis {axis}", value, 0, RAMP_DIV_MAX) for axis, value in enumerate(ramp_divs)]
    return clock_hz * sum(2.0**-ramp_div for ramp_div in checked) / CONTINUOUS_UPDATE_CLOCKS
