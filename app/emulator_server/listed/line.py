"""Plain emulated chips on the single wire of a UART, or one on its board; modules as others are."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, cast

from ...clock import Clock
from ...emulators.core.pace import Pace
from ...emulators.line.framing import TMCL
from ...emulators.line.line import Line
from ...emulators.line.server import LineServer
from ...emulators.line.uart import uart_line
from ...emulators.listed.board import PlainBoard
from ...emulators.listed.chip import PlainChip
from ...emulators.listed.family import FAMILY
from ...errors import UnknownThing
from ...registers.catalog import find_model
from .. import modules
from ..line import Far, LineOptions, line_of

if TYPE_CHECKING:
    from fastapi import FastAPI


def make_line(clock: Clock, options: LineOptions) -> Far:
    """The line with its modules, or the wire with its chips."""
    if find_model(options.model).kind == "module":
        return modules.make_line(clock, options)
    chips = {node: _made(options.model, clock, options, node) for node in options.addresses}
    line = uart_line(
        list(chips.values()),
        clock,
        nodes=options.addresses,
        baud=options.baud,
        echo=options.echo,
        shared_bus=options.shared_bus,
        seed=options.seed,
    )
    return _far(line, chips)


def make_board_line(clock: Clock, options: LineOptions) -> Far:
    """A chip on its board, alone on its line. Raises UnknownThing for one that no board leads to."""
    model = find_model(options.chip)
    if not model.board:
        raise UnknownThing("chip on a board", options.chip, [])
    chip = _made(options.chip, clock, options, 0)
    # Its firmware waits for nine bytes however long it takes.
    line = line_of([PlainBoard(chip)], clock, options, replace(TMCL, pause_s=math.inf))
    return _far(line, {model.slot.module: chip})


def _made(model: str, clock: Clock, options: LineOptions, node: int) -> PlainChip:
    # Chips that made the same noise would be one chip twice.
    named = {"node": node, "time_scale": options.time_scale, "seed": options.seed + node}
    chip = cast("PlainChip", FAMILY.make(model, clock, FAMILY.options.model_validate(named)))
    chip.pace = Pace(clock.now, share=1.0)
    return chip


def _far(line: Line, chips: Mapping[int, PlainChip]) -> Far:
    def make_control(server: LineServer) -> FastAPI:
        from ..line_control import Several, make_control_app

        return make_control_app(Several(server, FAMILY, chips, "chip", range(255)))

    return Far(line, make_control)
