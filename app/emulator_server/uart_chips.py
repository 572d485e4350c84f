"""Chips on the single wire of a UART, each at its node."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..clock import Clock
from ..emulators.core.family import EmulatorFamily
from ..emulators.core.pace import Pace
from ..emulators.line.server import LineServer
from ..emulators.line.uart import uart_line
from ..links.datagram_uart import node_max
from .line import Far, LineOptions, of_chip

if TYPE_CHECKING:
    from fastapi import FastAPI

NODECONF, SEVERAL = 0x03, 2 << 8
"""Where a chip has SENDDELAY; and that of three times eight bit times, which chips on one line need to have (TMC5160A
data sheet 1.14, 5.4)."""


def line_of_chips(
    family: EmulatorFamily[Any, Any],
    clock: Clock,
    options: LineOptions,
    placed: Callable[[int], dict[str, object]],
    told: Callable[[int], int] = lambda node: 0,
) -> Far:
    """The wire with its chips. `placed` are options that put one at its node, `told` what it is written in NODECONF.

    Raises ValueError for a node that the chip cannot have.
    """
    most = node_max(options.model)
    if not all(0 <= node <= most for node in options.addresses):
        raise ValueError(f"a {options.model} has a node address of 0 to {most}")
    chips = {}
    pace = Pace(clock.now, share=1.0)
    for node in options.addresses:
        # Chips that made the same noise would be one chip twice.
        given = {**of_chip(options), "seed": options.seed + node, **placed(node)}
        chip = chips[node] = family.make(options.model, clock, family.options.model_validate(given))
        chip.pace = pace
        chip.write(NODECONF, told(node) | (SEVERAL if len(options.addresses) > 1 else 0))
        chip.catch_up(0.0)  # loads what is on disk: whoever is told that we are there gets answers at once

    def make_control(server: LineServer) -> FastAPI:
        from .line_control import Several, make_control_app

        return make_control_app(Several(server, family, chips, "chip", range(most + 1)))

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
