"""The pins of an emulated TMC4361 that can be wired to other chips: START, step and direction, and the stop inputs.

START is an output unless START_CONF makes it a trigger (bit 5), and is active from a start on for START_OUT_ADD + 1
clocks. What the bench forces on it (PATCH .../emulator) goes out to the others too.
"""

from __future__ import annotations

from ..core.pins import START, STEPS, STOPS, Cells, Level, WiredChip
from . import layout as c
from .registers import Chip

_INPUT, _POLARITY = 1 << 5, 1 << 9
_TRIGGERS = 7 << 6
_BITS = {START: c.PIN_START, "STOPL": c.PIN_STOPL, "STOPR": c.PIN_STOPR}


class Wires(WiredChip):
    """`WiredChip` of one TMC4361."""

    tick_clocks = c.TICK_CLOCKS
    outputs = STEPS[:1]
    levels = (START,)
    senses = STOPS

    def __init__(self, chip: Chip, clock_hz: float) -> None:
        self._chip = chip
        self.clock_hz = clock_hz

    @property
    def clock(self) -> int:
        return int(self._chip.s[c.CLOCK])

    @property
    def quiet(self) -> bool:
        return self._chip.quiet

    @property
    def may_change(self) -> bool:
        r, s = self._chip.r, self._chip.s
        if r[c.START_CONF] & _INPUT or c.PIN_START in self._chip.forced:
            return False
        under_way = s[c.START_AT] != c.NEVER or s[c.START_OUT] > s[c.TICK]
        return bool(under_way or r[c.START_CONF] & _TRIGGERS)

    def advance(self, clock: int) -> int:
        s = self._chip.s
        s[c.WATCH] = self.may_change
        self._chip.advance(clock)
        s[c.WATCH] = 0
        return int(s[c.CLOCK])

    def sent(self, pin: str) -> int:
        del pin
        return int(self._chip.s[c.NET])

    def record(self, clocks: Cells) -> tuple[int, dict[str, Cells]]:
        s = self._chip.s
        s[c.WATCH] = self.may_change
        sent = self._chip.record(clocks)
        s[c.WATCH] = 0
        return int(s[c.CLOCK]), {STEPS[0]: sent}

    def level(self, pin: str) -> Level | None:
        del pin
        chip = self._chip
        positive, forced = bool(chip.r[c.START_CONF] & _POLARITY), chip.forced.get(c.PIN_START)
        if forced is not None:
            return Level(forced, forced == positive)
        if chip.r[c.START_CONF] & _INPUT:
            return None
        active = bool(chip.s[c.START_OUT] > chip.s[c.TICK])
        return Level(active == positive, active)

    def receive(self, pin: str, high: bool | None) -> None:
        if high is None:
            self._chip.wired.pop(_BITS[pin], None)
        else:
            self._chip.wired[_BITS[pin]] = high
        self._chip.hold_pins()
