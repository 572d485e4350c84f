"""Shapes of the catalog: every model with its registers (of a module: parameters) and commands as rows."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...registers.capabilities import Capability
from ...registers.entry import Tier
from ...registers.model import Untold
from ...registers.wires import Wire
from ..schemas import Answer, Space


class FieldRow(Answer):
    name: str
    lsb: int
    width: int
    access: str
    signed: bool
    minimum: int
    maximum: int
    reset: int | None
    unit: str
    help: str
    values: dict[str, str] = Field(description="names of enumerated values, by value")
    when: str = Field(default="", description="of a second meaning of the same bits: when it holds")
    behaviour: str = Field(
        default="", description="readable and writable, but not acted on by the emulator, and why; empty: acted on"
    )


class DriverPlaceRow(Answer):
    """What a module's parameter is in its driver chip: `raw` there is `raw * step + offset` here."""

    name: str = Field(description="of the register")
    field: str = Field(description="empty where the whole register is one value")
    step: int
    offset: int


class RegisterRow(Answer):
    name: str
    address: int
    space: Space = Field(default="register", description="which set of numbers the address counts in")
    alias: str = Field(default="", description='what the manual calls it, e.g. "AP 4"; empty for registers')
    axis: int | None
    group: str
    access: str
    width: int
    signed: bool
    minimum: int
    maximum: int
    reset: int | None
    unit: str
    help: str
    write_note: str
    volatile: bool
    untold: list[Untold] = Field(default=[], description="what no source tells of it")
    stored: Literal["", "auto", "on request", "unknown"] = Field(
        default="", description="whether an EEPROM keeps it: with every write, when told to store it, or not at all"
    )
    internal_range: list[int] | None = Field(
        default=None, description="of a parameter in pps: lowest and highest in units of the TMC5160 (AP 255 = 0)"
    )
    driver: DriverPlaceRow | None = Field(
        default=None, description="of a module's parameter: the register of its driver chip that it sets"
    )
    read_clears: bool = Field(default=False, description="reading it sets it to zero")
    source: str
    values: dict[str, str]
    when: str = Field(default="", description="of a second name of the same word: when it holds")
    behaviour: str = Field(
        default="", description="readable and writable, but not acted on by the emulator, and why; empty: acted on"
    )
    fields: list[FieldRow]


class CommandRow(Answer):
    """One TMCL command."""

    opcode: int
    mnemonic: str = Field(description="empty for control commands, which have only numbers")
    name: str
    types: dict[str, int] = Field(description="names of the values of the type byte, where they have names")
    type: str = Field(description="what the type byte means; empty where it has to be 0")
    motor: str = Field(description="what the field motor/bank means")
    value: str = Field(description="what the field value means")
    reply: str = Field(description="what the value of the reply means")
    direct: bool = Field(description="works when sent by a host; others only inside of a program")
    moves: bool = Field(description="may set a motor in motion or stop one")
    reads: bool = Field(description="only reads: asking twice does no harm")
    help: str
    source: str


class WireRow(Answer):
    """A kind of link that leads to a model."""

    kind: Wire
    title: str
    frames: Literal["datagram", "uart", "board", "tmcl"] = Field(
        description="what goes over it: the chip's SPI datagrams, those of its UART, commands of an evaluation board, "
        "or TMCL"
    )


class SpiFormatRow(Answer):
    """How a datagram on SPI says a register: whole bytes with the address and the write bit, then the data."""

    data_bits: int
    address_bits: int
    write_bit: Literal["high", "low"] = Field(
        description="the highest bit of the head, or the lowest, below the address"
    )
    write_is: int = Field(description="what that bit is in a write")
    byte_order: Literal["big", "little"] = Field(description="of the data; the head goes highest byte first")
    answer: Literal["next", "same"] = Field(description="whether the answer comes with the next datagram or the same")


class TaggedFormatRow(Answer):
    """Datagrams whose uppermost bits say which register they write; each is answered by a status."""

    written: int = Field(description="what addresses of registers have that are written; the others are statuses")
    tag_lsb: int = Field(description="where in a datagram the rest of the address begins")


class CatalogEntry(Answer):
    name: str
    kind: Literal["chip", "module"] = Field(default="chip", description="a module speaks TMCL and has parameters")
    family: str = Field(description="chips and modules of one family are driven, emulated and designed for alike")
    title: str
    summary: str
    description: str = Field(description='what it is among all devices: "a chip with SixPoint ramps"')
    axes: int
    registers: int | None = Field(description="null: of a listed model nobody has asked for them yet")
    tier: Tier = Field(
        default="full",
        description="full: with calculators and a physical emulator; names: an installed package lists its registers "
        "or parameters; map: a register map of this server does. Of the last two there are no calculators, and the "
        "emulator holds what was written and moves by it",
    )
    unreadable: str = Field(default="", description="why the package's list of its parameters cannot be read")
    clock_hz_default: float
    clock_hz_min: float = Field(description="0: no lowest clock is known; it is above 0")
    clock_hz_max: float
    capabilities: list[Capability] = Field(description="what it can, by the words of `GET /catalog/capabilities`")
    wires: list[WireRow]
    datagram_bits: int = Field(description="length of a chip's datagram on SPI; 0 for a module, and a chip without SPI")
    spi: SpiFormatRow | None = Field(default=None, description="of a chip whose datagrams a table tells")
    tagged: TaggedFormatRow | None = Field(default=None, description="of a chip of which nothing but a status is read")
    uart: Literal["", "plain", "node"] = Field(
        description="of a chip's UART: none, datagrams of one chip on a line, or with the address of one of several"
    )
    nodes: int = Field(description="how many node addresses its UART has; 0: as many as a datagram can say")
    driver: str = Field(default="", description="the driver chip in a module, as calculators name it")
    current_scale: Literal["", "sense_resistor", "full_scale"] = Field(
        description="what a soft limit of its current needs beside it; empty where it sets no current"
    )


class CatalogModel(CatalogEntry):
    rows: list[RegisterRow]
    commands: list[CommandRow] = Field(description="TMCL commands; none for chips")


class CapabilityTitle(Answer):
    """A word of the vocabulary that the catalog says by what a model can."""

    name: Capability
    title: str = Field(description='those that can, in the plural: "chips with S-ramps"')
