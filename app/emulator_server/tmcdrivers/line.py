"""Drivers on the single wire of a UART, each at its node."""

from __future__ import annotations

from ...clock import Clock
from ...emulators.tmcdrivers.family import FAMILY
from ...registers.catalog import MODELS
from ..line import Far, LineOptions
from ..uart_chips import line_of_chips


def make_line(clock: Clock, options: LineOptions) -> Far:
    """The wire with its drivers, which are told their nodes where they have more than their pins say."""
    if MODELS[options.model].nodes:
        return line_of_chips(FAMILY, clock, options, lambda node: {"node": node})
    return line_of_chips(FAMILY, clock, options, lambda node: {}, lambda node: node)
