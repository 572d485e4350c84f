"""Drivers on the single wire of a UART, each at the node of its pins."""

from __future__ import annotations

from ...clock import Clock
from ...emulators.tmcdrivers.family import FAMILY
from ..line import Far, LineOptions
from ..uart_chips import line_of_chips


def make_line(clock: Clock, options: LineOptions) -> Far:
    """The wire with its drivers."""
    return line_of_chips(FAMILY, clock, options, lambda node: {"node": node})
