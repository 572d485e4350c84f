"""Register maps as the catalog has them: whoever reads their files puts them here."""

from __future__ import annotations

from dataclasses import replace

from ..entry import Model
from ..listed import chips
from .reader import RegisterMap, format_of

MAPS: dict[str, Model] = {}
"""By name: those that can be used now."""


def entry(found: RegisterMap) -> Model:
    """The catalog's entry."""
    head = found.head
    model = chips.chip(
        found.name,
        head.title,
        head.summary or "from a register map of this server",
        found.table,
        spi=format_of(head.spi),
        uart="" if head.uart is None else "node" if head.uart.node else "plain",
    )
    clock_hz = float(head.clock_hz)
    return replace(model, clock_hz_default=clock_hz, clock_hz_max=clock_hz, tier="map")
