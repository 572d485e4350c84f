"""The driver chain: which bits leave for the drivers, how long that takes, and what comes back.

The configuration RAM lists signal codes in the order of the bits; a set NxM bit ends a driver's part
(DS-TMC428 10 and 11). The board has three drivers of the TMC236 family, 12 bits each, daisy-chained.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from . import kernel
from .sequencer import Coils, coils

DRIVERS_ON_BOARD = 3
DRIVER_BITS = 12
DRIVER_STATUS_HEALTHY = 0x100
"""Reply of a TMC236-family driver, first bit at the top: LD2 LD1 LD0 1 OT OTPW UV OCHS OLB OLA OCB OCA.

Bit 8 is constant 1. No load reading, no error (TMC236/TMC239/TMC246/TMC249 data sheets, SPI protocol).
"""

CELLS = 64
NXM = 0x20
SHORTEST_DIVIDER = 7
"""Smaller clk2_div give the same frequency (DS-TMC428 9.7)."""


@dataclass(frozen=True, slots=True)
class Polarity:
    """The signal polarity bits of the global parameter register (DS-TMC428 9.7)."""

    ph: int = 0
    fd: int = 0
    dac: int = 0


class Place(NamedTuple):
    """One bit of the datagram: its RAM cell, the driver it is for (0 first) and its signal code."""

    cell: int
    driver: int
    code: int


class Signals(NamedTuple):
    """What the microstep unit holds ready for one motor when a datagram starts."""

    wave: int
    width: int
    scale: int
    step: int
    direction: int


class Datagram(NamedTuple):
    """A datagram as it left: its bits in order, where each came from, and the coils behind it."""

    bits: tuple[int, ...]
    places: tuple[Place, ...]
    coils: tuple[Coils, ...]


def walk(ram: Sequence[int], lsmd: int) -> tuple[Place, ...] | None:
    """The bits of one datagram in order, or None if it never ends: no NxM bit in the whole RAM.

    With fewer NxM bits than drivers the reading wraps round and meets them again. `lsmd` 3 is not
    allowed on the chip; here it asks for a fourth driver that has no motor.
    """
    if not any(word & NXM for word in ram[:CELLS]):
        return None
    places: list[Place] = []
    cell = driver = 0
    while driver <= lsmd:
        places.append(Place(cell, driver, ram[cell] & 0x1F))
        driver += ram[cell] >> 5 & 1
        cell = (cell + 1) % CELLS
    return tuple(places)


def duration_clocks(places: tuple[Place, ...] | None, clk2_div: int) -> int:
    """Clocks that a datagram takes: 1 + bits + 1 SPI clocks and 1 for each NxM (1.5 if clk2_div > 7).

    DS-TMC428 9.7. An SPI clock is 2 * (clk2_div + 1) clocks. `kernel.NEVER` for an unbounded datagram.
    """
    if places is None:
        return kernel.NEVER
    drivers = places[-1].driver + 1
    halves = 2 * (1 + len(places) + 1) + drivers * (3 if clk2_div > SHORTEST_DIVIDER else 2)
    return halves * (max(clk2_div, SHORTEST_DIVIDER) + 1)


def _signal(code: int, signals: Signals, state: Coils, polarity: Polarity) -> int:
    if code < 0x10:
        dac, phase, decay = (state.dac_b, state.ph_b, state.fd_b) if code & 8 else (state.dac_a, state.ph_a, state.fd_a)
        if code & 7 == 6:
            return phase ^ polarity.ph
        return decay ^ polarity.fd if code & 7 == 7 else (dac >> (code & 7) & 1) ^ polarity.dac
    if code == 0x10:
        return 0
    if code == 0x12:
        return signals.direction
    return signals.step if code == 0x13 else 1  # 0x11 is One, and so are the unused codes (Table 11-1)


def compose(
    places: tuple[Place, ...] | None,
    motors: Sequence[Signals],
    table: Sequence[int],
    polarity: Polarity,
    cover: tuple[int, int, int] | None,
) -> Datagram:
    """The datagram that `motors` make: RAM places filled with signals, then covered.

    `cover` is (first bit, length, bits) or None; bit length-1 of the cover comes first (DS-TMC428 9.2). An
    unbounded datagram is shown as empty.
    """
    idle = Signals(0, 1, 0, 0, 0)
    driven = [*motors, idle]
    states = tuple(coils(motor.wave, motor.width, motor.scale, table) for motor in motors)
    with_none = [*states, Coils(0, 0, 0, 0, 0, 0)]
    bits = [_signal(place.code, driven[place.driver], with_none[place.driver], polarity) for place in places or ()]
    if cover is not None:
        first, length, data = cover
        for offset in range(length):
            if 0 <= first + offset < len(bits):
                bits[first + offset] = data >> (length - 1 - offset) & 1
    return Datagram(tuple(bits), places or (), states)


def reply_bits(sent: Sequence[int], statuses: Sequence[int]) -> list[int]:
    """What comes back at SDI_S while `sent` goes out: the drivers' statuses, then `sent` itself.

    The chain is one long shift register. Driver 1 stands next to SDI_S, because the first bits sent are
    its own, and so its status comes first.
    """
    stored = [status >> bit & 1 for status in statuses for bit in range(DRIVER_BITS - 1, -1, -1)]
    return [*stored, *sent][: len(sent)]


@dataclass(frozen=True, slots=True)
class Selects:
    """Chip selects: what the chip is set to (csCommonIndividual), and how the board is wired.

    Individual: nSCS_S, nSCS2 and nSCS3 each go low for the bits of one driver, all of whose data pins are in parallel
    (DS-TMC428 9.7). What comes of a board that is wired otherwise is inferred: a chain is selected for the bits of
    driver 1 alone; of drivers with selects of their own only the first is ever selected, and for all bits.
    """

    chip: bool
    board: bool

    @property
    def fit(self) -> bool:
        """Whether each driver gets its own bits."""
        return self.chip == self.board

    def reply(self, parts: Sequence[Sequence[int]], statuses: Sequence[int]) -> list[int]:
        """What comes back at SDI_S while `parts` go out, the bits of one driver after the other."""
        sent = [bit for part in parts for bit in part]
        if not self.chip:
            return reply_bits(sent, statuses[:1] if self.board else statuses)
        if self.board:
            back: list[int] = []
            for driver, part in enumerate(parts):
                back += reply_bits(part, statuses[driver : driver + 1])
            return back
        first = list(parts[0]) if parts else []
        return [*reply_bits(first, statuses), *[0] * (len(sent) - len(first))]
