"""STEP and DIR of an emulated driver, as an input that is wired to a controller's step output, and DIAG."""

from __future__ import annotations

from typing import Protocol

from ..core.pins import DIAG, STEPS, Cells, WiredChip
from ..drive import TICK_CLOCKS


class SteppedChip(Protocol):
    """What a driver does with steps that come one by one."""

    stepped: bool

    @property
    def diag_high(self) -> bool:
        """The level of DIAG."""
        ...

    @property
    def clock(self) -> int: ...

    @property
    def quiet(self) -> bool: ...

    def advance(self, clock: int) -> None: ...

    def advance_by_steps(self, clocks: Cells, counts: Cells) -> None: ...


class Wires(WiredChip):
    """`WiredChip` of one driver."""

    tick_clocks = TICK_CLOCKS
    inputs = STEPS[:1]
    signals = (DIAG,)

    def __init__(self, chip: SteppedChip, clock_hz: float) -> None:
        self._chip = chip
        self.clock_hz = clock_hz

    @property
    def clock(self) -> int:
        return self._chip.clock

    @property
    def quiet(self) -> bool:
        return self._chip.quiet

    def advance(self, clock: int) -> int:
        self._chip.advance(clock)
        return clock

    def signal(self, pin: str) -> bool:
        del pin
        return self._chip.diag_high

    def connect(self, pin: str, connected: bool) -> None:
        del pin
        self._chip.stepped = connected

    def take(self, pin: str, clocks: Cells, counts: Cells) -> None:
        del pin
        self._chip.advance_by_steps(clocks, counts)
