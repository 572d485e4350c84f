"""Chips on the single wire of a UART, each at its node."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...clock import Clock
from ...emulators.core.pace import Pace
from ...emulators.line.server import LineServer
from ...emulators.line.uart import uart_line
from ...emulators.tmc5xxx.family import FAMILY
from ...registers.catalog import MODELS
from ..line import Far, LineOptions, of_chip

if TYPE_CHECKING:
    from fastapi import FastAPI

NODECONF, SEVERAL = 0x03, 2 << 8
"""Where a chip has its node address; and SENDDELAY of three times eight bit times, which chips on one line need to have
(TMC5160A data sheet 1.14, 5.4)."""


def make_line(clock: Clock, options: LineOptions) -> Far:
    """The wire with its chips, which have been told their nodes."""
    chips = {}
    pace = Pace(clock.now, share=1.0)
    for node in options.addresses:
        # Chips that made the same noise would be one chip twice.
        named = FAMILY.options.model_validate({**of_chip(options), "seed": options.seed + node})
        chip = chips[node] = FAMILY.make(options.model, clock, named)
        chip.pace = pace
        if MODELS[options.model].uart == "node":
            chip.write(NODECONF, node | (SEVERAL if len(options.addresses) > 1 else 0))
        chip.catch_up(0.0)  # compiles: whoever is told that we are there gets answers at once

    def make_control(server: LineServer) -> FastAPI:
        from ..line_control import Several, make_control_app

        return make_control_app(Several(server, FAMILY, chips, "chip", range(255)))

    return Far(
        uart_line(
            list(chips.values()),
            clock,
            nodes=options.addresses,
            baud=options.baud,
            echo=options.echo,
            shared_bus=options.shared_bus,
            seed=options.seed,
        ),
        make_control,
    )
