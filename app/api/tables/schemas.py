"""Shapes of the tables in a chip's RAM."""

from __future__ import annotations

from typing import Annotated

from pydantic import Discriminator, Field, StringConstraints, Tag

from ...calc.microsteps.mslut import ENTRIES as MSLUT_ENTRIES
from ..schemas import Answer, Body, Flag, Int
from .mslut_schemas import MslutHeld, MslutWrite

TableValue = Annotated[int, Field(strict=True, ge=0, le=63)]


class MicrostepTable(Body):
    values: Annotated[list[TableValue], Field(min_length=64, max_length=64)]


def _which(body: object) -> str:
    if isinstance(body, dict):
        values = body.get("values")
        mslut = "registers" in body or "mirror" in body or (isinstance(values, list) and len(values) == MSLUT_ENTRIES)
    else:
        mslut = isinstance(body, MslutWrite | MslutHeld)
    return "mslut" if mslut else "quarter"


AnyTableIn = Annotated[
    Annotated[MicrostepTable, Tag("quarter")] | Annotated[MslutWrite, Tag("mslut")], Discriminator(_which)
]
"""64 values of 0..63 for a TMC428; 256 values or the registers for a chip with an MSLUT."""
AnyTable = Annotated[
    Annotated[MicrostepTable, Tag("quarter")] | Annotated[MslutHeld, Tag("mslut")], Discriminator(_which)
]


class DriverSpecIn(Body):
    driver: Annotated[str, StringConstraints(max_length=40)]
    fast_decay: Flag = False
    signals: list[str | Int] | None = Field(default=None, description="for driver 'custom': signal names or codes")
    bit_names: list[str] | None = None


class DriverChain(Body):
    drivers: Annotated[list[str | DriverSpecIn], Field(min_length=1, max_length=3)]


class ChainBit(Answer):
    position: int
    motor: int
    signal: str
    code: int
    next_motor: bool
    ram_address: int
    ram_data: int
    bit_name: str


class ChainTable(Answer):
    """A driver chain configuration, readable."""

    bits: list[ChainBit]
    ram_words: list[int] = Field(description="64 cells of 6 bits")
    lsmd: int
    length_bits: int | None = Field(description="null where the datagram never ends")
    findings: list[str]


class ChainDesign(ChainTable):
    datagrams: list[str] = Field(description="hex, to the chip")
    spi_clock_hz: float
    datagram_hz: float
    continuous_update_hz: float | None
    full_step_hz_max: float
