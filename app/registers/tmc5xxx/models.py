"""The chips of this family, as the catalog lists them."""

from __future__ import annotations

from typing import Literal

from ..capabilities import Capability
from ..entry import Model
from ..wires import Wire
from . import table, tmc5240

FAMILY = "tmc5xxx"
_COMMON: frozenset[Capability] = frozenset(
    {
        "registers",
        "motion",
        "ramp.sixpoint",
        "microsteps.mslut",
        "chopper",
        "current",
        "stallguard",
        "events",
        "flags",
        "position_compare",
        "position_latch",
    }
)
_WIRES: frozenset[Wire] = frozenset({"emulator", "tcp", "spidev", "landungsbruecke"})


def _model(
    number: int,
    version: int,
    summary: str,
    uart: Literal["", "plain", "node"],
    *more: Capability,
    clock_hz: float = table.CLOCK_HZ_DEFAULT,
    current_scale: Literal["sense_resistor", "full_scale"] = "sense_resistor",
) -> Model:
    """version: of the first silicon, by the data sheet. A later one may show another, but not that of another chip."""
    name = f"tmc{number}"
    return Model(
        name,
        FAMILY,
        name.upper(),
        summary,
        "a chip with SixPoint ramps",
        table.AXES[name],
        table.TABLES[name],
        clock_hz_default=clock_hz,
        clock_hz_min=table.CLOCK_HZ_MIN,
        clock_hz_max=table.CLOCK_HZ_MAX,
        capabilities=_COMMON | frozenset(more),
        wires=_WIRES | ({"uart"} if uart else set()),
        current_scale=current_scale,
        datagram_bits=40,
        uart=uart,
        board=name.upper(),
        version=version,
    )


MODELS = (
    _model(5031, 0x01, "two axes, SixPoint ramps and drivers to 1.1 A; SPI", ""),
    _model(5062, 0x01, "two axes, SixPoint ramps, drivers to 1.1 A and encoders; SPI, UART", "plain", "encoder"),
    _model(
        5072,
        0x10,
        "two axes, SixPoint ramps, drivers to 1.1 A with StealthChop, encoders; SPI, UART",
        "node",
        "encoder",
    ),
    _model(
        5130, 0x11, "one axis, SixPoint ramp, driver to 2 A with StealthChop, encoder; SPI, UART", "node", "encoder"
    ),
    _model(5160, 0x30, "one axis, SixPoint ramp, gate driver with StealthChop, encoder; SPI, UART", "node", "encoder"),
    _model(
        5240,
        tmc5240.VERSION,
        "one axis, ramp of eight points, driver to 2.1 A with StealthChop and StallGuard4, encoder, ADC; SPI, UART",
        "node",
        "encoder",
        clock_hz=12.5e6,
        current_scale="full_scale",
    ),
)
