"""What may stand in a register map: its keys, their types and bounds.

The document itself says the same to people: docs/register-maps.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import ConfigDict, Field, StringConstraints, ValidationInfo, field_validator
from pydantic_core import PydanticKnownError

from ...deferred import DeferredModel
from ..spi_format import WORD_BITS_MAX

FORMAT = 1
AXES_MAX = 8
REGISTERS_MAX = 1000
VALUES_MAX = 256
ADDRESS_MAX = 0x7FFF

Word = Annotated[str, StringConstraints(strict=True, pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,39}$")]
Line = Annotated[str, StringConstraints(strict=True, max_length=80, pattern=r"^[^\x00-\x1f\x7f]*$")]
Text = Annotated[str, StringConstraints(strict=True, max_length=1000)]
Whole = Annotated[int, Field(strict=True, ge=-(1 << 63), lt=1 << 63)]
Access = Literal["R", "W", "RW", "R+WC"]


@dataclass(frozen=True, slots=True)
class Limits:
    """What the datagrams of a file hold."""

    address_max: int
    word_bits: int


class Shape(DeferredModel):
    """A table of the file: only the keys that are known."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class BitsShape(Shape):
    """What registers and fields have alike."""

    name: Word
    signed: bool = False
    unit: Annotated[str, StringConstraints(strict=True, max_length=20, pattern=r"^[^\x00-\x1f\x7f]*$")] = ""
    range: Annotated[list[Whole], Field(min_length=2, max_length=2)] | None = None
    values: Annotated[dict[str, Line], Field(max_length=VALUES_MAX)] = Field(default_factory=dict)
    help: Text = ""


class FieldShape(BitsShape):
    """Some bits of a register with a name of their own."""

    lsb: Annotated[int, Field(strict=True, ge=0, lt=WORD_BITS_MAX)]
    width: Annotated[int, Field(strict=True, ge=1, le=WORD_BITS_MAX)] = 1
    access: Literal["R", "RW"] = "RW"
    role: Literal["mode"] | None = None


class RegisterShape(BitsShape):
    """One register."""

    address: Annotated[int, Field(strict=True, ge=0, le=ADDRESS_MAX)]
    axis: Annotated[int, Field(strict=True, ge=0, lt=AXES_MAX)] | None = None
    width: Annotated[int, Field(strict=True, ge=1)] | None = None
    """None: as many as a datagram has, 32 at most."""
    access: Access = "RW"
    role: (
        Literal["mode", "target", "position", "velocity", "max_velocity", "acceleration", "deceleration", "status"]
        | None
    ) = None
    reset: Whole | None = None
    group: Line = ""
    volatile: bool = False
    read_clears: bool = False
    field: Annotated[list[FieldShape], Field(max_length=WORD_BITS_MAX)] = Field(default_factory=list)

    @field_validator("address", "width")
    @classmethod
    def _fits(cls, value: int | None, info: ValidationInfo) -> int | None:
        """Whether a datagram of this file (`Limits`, the context) holds it."""
        limits = info.context
        assert isinstance(limits, Limits)
        most = limits.address_max if info.field_name == "address" else limits.word_bits
        if value is not None and value > most:
            raise PydanticKnownError("less_than_equal", {"le": most})
        return value


class SpiShape(Shape):
    """Its datagrams: `SpiFormat` tells what the keys mean. As they are, a write bit, seven address bits, 32 data bits,
    and the answer comes with the next one."""

    data_bits: Literal[8, 16, 24, 32, 40, 48, 56, 64] = 32
    address_bits: Annotated[int, Field(strict=True, ge=1, le=15)] = 7
    write_bit: Literal["high", "low"] = "high"
    write_is: Literal[0, 1] = 1
    byte_order: Literal["big", "little"] = "big"
    answer: Literal["next", "same"] = "next"
    datagram_bits: Annotated[int, Field(strict=True, ge=16, le=80)] | None = None
    """Of all of a datagram: what the others make, said once more."""


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
