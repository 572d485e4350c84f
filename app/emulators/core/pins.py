"""Pins of emulated chips that can be wired to each other, and the wires as an emulator's options name them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field

from ...deferred import DeferredModel

Cells = NDArray[np.int64]
NET_PATTERN = r"^[a-z0-9][a-z0-9-]{0,31}$"
NetName = Annotated[str, Field(pattern=NET_PATTERN)]
WIRES_MAX = 8

START = "START"
STEPS = ("STEP1", "STEP2", "STEP3")
"""Step and direction of an axis; a driver has only the first, as an input."""
DIAG = "DIAG"
STOPS = ("STOPL", "STOPR")
REFERENCES = ("REF1", "REF2", "REF3")
"""What a left switch of each axis is wired to otherwise."""


class PinWire(DeferredModel):
    """A pin on a net: all pins of this server's emulators on a net of the same name are wired together."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    pin: Literal["START", "STEP1", "STEP2", "STEP3", "DIAG", "STOPL", "STOPR", "REF1", "REF2", "REF3"] = Field(
        description="STEP1: step and direction of the first axis, of a driver its inputs; DIAG of a driver goes to an "
        "input for a stop switch, in place of that"
    )
    net: NetName = Field(description="small letters, digits and dashes")


@dataclass(frozen=True, slots=True)
class Level:
    """What a chip puts on a pin. `active` is what wins where several drive a net."""

    high: bool
    active: bool


class WiredChip(Protocol):
    """A chip whose pins can be wired, at clocks of its own. `Coupling` alone calls it, with the lock held.

    What stands here as a default is that of a chip that has no such pins.
    """

    clock_hz: float
    tick_clocks: int
    """What it sees of its pins it sees every so many clocks, counted from power-on."""
    outputs: tuple[str, ...] = ()
    """Pins whose steps others may take."""
    inputs: tuple[str, ...] = ()
    """Pins that take steps."""
    levels: tuple[str, ...] = ()
    """Pins that have a level, either way."""
    signals: tuple[str, ...] = ()
    """Pins whose level others may take, and that never take one. They are looked at every `coupling.SIGNAL_S`."""
    senses: tuple[str, ...] = ()
    """Pins that take such a level."""

    @property
    def clock(self) -> int:
        """Clocks since power-on that it has been brought to."""
        ...

    @property
    def quiet(self) -> bool:
        """Nothing happens until something is written or comes in."""
        ...

    @property
    def may_change(self) -> bool:
        """Whether a level that it drives may change before anything is written or comes in."""
        return False

    def advance(self, clock: int) -> int:
        """Run to `clock`, or to the first change of a level that it drives; the clock it is at then."""
        ...

    def level(self, pin: str, /) -> Level | None:
        """What it drives; None: nothing."""
        del pin
        return None

    def receive(self, pin: str, high: bool | None, /) -> None:
        """The level of the net from now on, whoever drives it; None: nobody does."""
        del pin, high

    def signal(self, pin: str, /) -> bool:
        """Whether one of `signals` is high."""
        del pin
        return False

    def sent(self, pin: str, /) -> int:
        """Steps forwards less those backwards that an output has given so far."""
        del pin
        return 0

    def record(self, clocks: Cells, /) -> tuple[int, dict[str, Cells]]:
        """`advance` to the last of `clocks`, which rise; the clock it is at then, and by output what `sent` was at each
        that was reached."""
        return self.advance(int(clocks[-1])), {}

    def connect(self, pin: str, connected: bool, /) -> None:
        """Whether an input is wired, so that steps come by `take`."""
        del pin, connected

    def take(self, pin: str, clocks: Cells, counts: Cells, /) -> None:
        """Run to the last of `clocks`; `counts` steps (signed) come in by each of them."""
        del pin, counts
        self.advance(int(clocks[-1]))
