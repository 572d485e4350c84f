"""What may stand in a register map: its keys, their types and bounds.

The document itself says the same to people: docs/register-maps.md.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

FORMAT = 1
AXES_MAX = 8
REGISTERS_MAX = 1000
VALUES_MAX = 256
DATA_BITS = 32
ADDRESS_MAX = 0x7F

Word = Annotated[str, StringConstraints(strict=True, pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,39}$")]
Line = Annotated[str, StringConstraints(strict=True, max_length=80, pattern=r"^[^\x00-\x1f\x7f]*$")]
Text = Annotated[str, StringConstraints(strict=True, max_length=1000)]
Whole = Annotated[int, Field(strict=True, ge=-(1 << 63), lt=1 << 63)]
Access = Literal["R", "W", "RW", "R+WC"]


class Shape(BaseModel):
    """A table of the file: only the keys that are known."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class BitsShape(Shape):
    """What registers and fields have alike."""

    name: Word
    width: int
    signed: bool = False
    unit: Annotated[str, StringConstraints(strict=True, max_length=20, pattern=r"^[^\x00-\x1f\x7f]*$")] = ""
    range: Annotated[list[Whole], Field(min_length=2, max_length=2)] | None = None
    values: Annotated[dict[str, Line], Field(max_length=VALUES_MAX)] = {}
    help: Text = ""


class FieldShape(BitsShape):
    """Some bits of a register with a name of their own."""

    lsb: Annotated[int, Field(strict=True, ge=0, lt=DATA_BITS)]
    width: Annotated[int, Field(strict=True, ge=1, le=DATA_BITS)] = 1
    access: Literal["R", "RW"] = "RW"


class RegisterShape(BitsShape):
    """One register."""

    address: Annotated[int, Field(strict=True, ge=0, le=ADDRESS_MAX)]
    axis: Annotated[int, Field(strict=True, ge=0, lt=AXES_MAX)] | None = None
    width: Annotated[int, Field(strict=True, ge=1, le=DATA_BITS)] = DATA_BITS
    access: Access = "RW"
    reset: Whole | None = None
    group: Line = ""
    volatile: bool = False
    read_clears: bool = False
    field: Annotated[list[FieldShape], Field(max_length=DATA_BITS)] = []


class SpiShape(Shape):
    """Datagrams of 40 bits: a write bit, seven address bits, 32 data bits; the answer comes with the next one."""

    datagram_bits: Literal[40] = 40


class UartShape(Shape):
    """The single-wire UART with its CRC; `node`: several chips share a line, each with an address."""

    node: bool = True


class HeadShape(Shape):
    """The file without its registers."""

    format: Literal[1]
    title: Annotated[Line, Field(min_length=1)]
    summary: Line = ""
    axes: Annotated[int, Field(strict=True, ge=0, le=AXES_MAX)] = 0
    clock_hz: Annotated[int, Field(strict=True, ge=1, le=1_000_000_000)] = 16_000_000
    spi: SpiShape | None = None
    uart: UartShape | None = None
    registers: Annotated[list[object], Field(alias="register", min_length=1, max_length=REGISTERS_MAX)]
