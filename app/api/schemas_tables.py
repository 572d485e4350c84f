"""Shapes of the tables in a chip's RAM and of the profile."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints

from app.api.schemas import Answer, AxisConfig, Body, Flag, Int, Space

TableValue = Annotated[int, Field(strict=True, ge=0, le=63)]


class MicrostepTable(Body):
    values: Annotated[list[TableValue], Field(min_length=64, max_length=64)]


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


class Profile(Answer):
    """A device's whole configuration as a document."""

    format: Literal["stepscope-profile"] = "stepscope-profile"
    version: Literal[1] = 1
    name: str
    model: str
    clock_hz: float
    axes: list[AxisConfig]
    registers: list[ProfileRegister]
    microstep_table: list[int] | None
    driver_chain: list[int] | None


class ProfileRegister(Answer):
    name: str
    space: Space = "register"
    axis: int | None
    raw: int
    value: int
    fields: dict[str, int]


Profile.model_rebuild()
