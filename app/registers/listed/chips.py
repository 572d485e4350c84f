"""A chip of which a table of registers is known and nothing else, as the catalog has it: whatever the table came from.

What it can, and which links lead to it, its registers tell: a ramp generator by its names (`ramp`), a UART by the
counter of its writes, its datagrams on SPI by what addresses and words they hold.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Literal

from ..capabilities import Capability
from ..entry import Model, Slot
from ..model import Register, RegisterTable, Space
from ..spi_format import USUAL, WORD_BITS_MAX, Spi, SpiFormat
from ..wires import BOARD, Wire
from .ramp import ramps_of, with_meaning

FAMILY = "listed"
CLOCK_HZ = 16e6
"""Nothing is computed from it [Hz]."""
ADDRESS_MAX = 0x7F
"""What a datagram of the UART can ask for."""
UART_BITS = 32
VERSION = 24, 8
"""Lowest bit and width of a chip's version in its register of inputs."""
_VERSION = re.compile(r"(?:^|_)version$", re.IGNORECASE)
DESCRIPTION = "a chip whose registers are known by name"


def table_of(name: str, rows: Iterable[Register]) -> RegisterTable:
    """A table of these rows, those of a ramp generator with what their names mean. Raises ValueError for rows that make
    none."""
    return RegisterTable(name, with_meaning(rows))


def chip(
    name: str,
    title: str,
    summary: str,
    table: RegisterTable,
    *,
    spi: Spi | None = USUAL,
    uart: Literal["", "plain", "node"] = "",
    board: str = "",
    slot: Slot | None = None,
) -> Model:
    """The catalog's entry of a chip with these registers.

    spi : its datagrams on SPI; None where it has none, or nobody knows them
    board : what the maker's evaluation board calls it; `slot` how that leads to it; "" and None where there is none

    Raises ValueError where a datagram cannot hold an address or a word of the table.
    """
    highest = max((row.address for row in table), default=0)
    most = spi.address_max if isinstance(spi, SpiFormat) else highest
    if highest > min(most, ADDRESS_MAX if uart else highest):
        raise ValueError(f"{title}: a datagram holds addresses to {min(most, ADDRESS_MAX if uart else most):#04x}")
    bits = word_bits(spi, uart=bool(uart) or slot is not None)
    if any(row.width > bits or row.space is not Space.REGISTER for row in table):
        raise ValueError(f"{title}: its registers do not fit words of {bits} bits")
    ramps = ramps_of(table)
    capabilities: set[Capability] = {"registers"}
    capabilities |= {"motion"} if ramps else set()
    wires: set[Wire] = {"emulator"}
    wires |= {"tcp", "spidev"} if spi is not None else set()
    wires |= {"uart"} if uart else set()
    wires |= {BOARD} if slot is not None else set()
    return Model(
        name,
        FAMILY,
        title,
        summary,
        DESCRIPTION,
        len(ramps),
        table,
        clock_hz_default=CLOCK_HZ,
        clock_hz_max=CLOCK_HZ,
        capabilities=frozenset(capabilities),
        wires=frozenset(wires),
        datagram_bits=0 if spi is None else 8 * spi.frame_bytes if isinstance(spi, SpiFormat) else spi.word_bits,
        spi=None if spi == USUAL else spi,
        fetch_address=harmless(table),
        uart=uart,
        board=board,
        slot=slot or Slot(),
        tier="names",
    )


def word_bits(spi: Spi | None, *, uart: bool) -> int:
    """How many bits a register can have, by what leads to it; `uart`: also a UART, or a board."""
    if spi is None:
        return UART_BITS
    return min(spi.word_bits, UART_BITS if uart else WORD_BITS_MAX)


def tells_version(table: RegisterTable, address: int, version: int) -> bool:
    """Whether a chip of this table may show `version` in bits 31..24 of the register at `address`: it names them so,
    and does not say that they are another number."""
    row = table.at(address)
    if row is None:
        return False
    part = next((part for part in row.fields if (part.lsb, part.width) == VERSION and _VERSION.search(part.name)), None)
    return part is not None and (row.reset is None or part.unpack(row.reset) == version)


def harmless(table: RegisterTable) -> int:
    """The address of a register that can be read and that nothing says a reading clears; 0 where there is none."""
    return next((row.address for row in table if row.access.readable and not row.read_clears), 0)
