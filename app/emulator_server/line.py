"""An emulated line as the command line describes it, and what every family puts on one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..clock import Clock
from ..emulators.line.framing import Framing
from ..emulators.line.line import SEED, Line
from ..emulators.line.module import LineModule
from ..emulators.line.server import LineServer

if TYPE_CHECKING:
    from fastapi import FastAPI


@dataclass(frozen=True)
class LineOptions:
    """An emulated line as the command line describes it. `addresses` are those of its modules, or nodes of its chips.

    `model` is what hangs on it: modules, one board with a `chip` ("": its usual one) that has `clock_hz`, or chips with
    a UART, whose line may give back what is said to it (`echo`). `can` is a bus of python-can, `INTERFACE:CHANNEL`.
    """

    model: str
    chip: str = ""
    clock_hz: float | None = None
    pty: Path | None = None
    tcp: str | None = None
    can: str | None = None
    addresses: Sequence[int] = (1,)
    baud: int | None = None
    shared_bus: bool = False
    echo: bool = False
    data_dir: Path | None = None
    control: str | None = None
    seed: int = SEED
    time_scale: float = 1.0


@dataclass(frozen=True)
class Far:
    """The line with what hangs on it, and the control port for it (an import of its own: most lines need none)."""

    line: Line
    make_control: Callable[[LineServer], FastAPI]


LineMaker = Callable[[Clock, LineOptions], Far]


def line_of(modules: Sequence[LineModule], clock: Clock, options: LineOptions, framing: Framing) -> Line:
    """Modules on a line as the options have it."""
    return Line(
        modules,
        clock,
        baud=options.baud,
        shared_bus=options.shared_bus,
        addresses=options.addresses,
        seed=options.seed,
        framing=framing,
    )


def of_chip(options: LineOptions) -> dict[str, object]:
    """What the options say of a chip."""
    given: dict[str, object] = {"time_scale": options.time_scale}
    return given if options.clock_hz is None else {**given, "clock_hz": options.clock_hz}
