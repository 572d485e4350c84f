"""Chips on the single wire of a UART, each at its node."""

from __future__ import annotations

from ...clock import Clock
from ...emulators.tmc5xxx.family import FAMILY
from ...registers.catalog import MODELS
from ..line import Far, LineOptions
from ..uart_chips import line_of_chips


def make_line(clock: Clock, options: LineOptions) -> Far:
    """The wire with its chips, which have been told their nodes."""
    named = MODELS[options.model].uart == "node"
    return line_of_chips(FAMILY, clock, options, lambda node: {}, lambda node: node if named else 0)
