"""A chip of which a table of registers is known and nothing else, as the catalog has it: whatever the table came from.

What it can, and which links lead to it, its registers tell: a ramp generator by its names (`ramp`), a UART by the
counter of its writes, 40-bit datagrams by what addresses and words they hold.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from ..capabilities import Capability
from ..entry import Model, Slot
from ..model import Register, RegisterTable, Space
from ..wires import BOARD, Wire
from .ramp import ramps_of, with_meaning

FAMILY = "listed"
CLOCK_HZ = 16e6
"""Nothing is computed from it [Hz]."""
ADDRESS_MAX = 0x7F
"""What a datagram of 40 bits, or one of the UART, can ask for."""
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
    spi40: bool = True,
    uart: Literal["", "plain", "node"] = "",
    board: str = "",
    slot: Slot | None = None,
) -> Model:
    """The catalog's entry of a chip with these registers.

    spi40 : whether it speaks datagrams of 40 bits whose answers come one later
    board : what the maker's evaluation board calls it; `slot` how that leads to it; "" and None where there is none

    Raises ValueError where a datagram cannot hold an address or a word of the table.
    """
    wide = max((row.address for row in table), default=0) > ADDRESS_MAX
    if wide and (spi40 or uart):
        raise ValueError(f"{title}: a datagram holds addresses to {ADDRESS_MAX:#04x}")
    if any(row.width > 32 or row.space is not Space.REGISTER for row in table):
        raise ValueError(f"{title}: its registers do not fit words of 32 bits")
    ramps = ramps_of(table)
    capabilities: set[Capability] = {"registers"}
    capabilities |= {"motion"} if ramps else set()
    wires: set[Wire] = {"emulator"}
    wires |= {"tcp", "spidev"} if spi40 else set()
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
        datagram_bits=40 if spi40 else 0,
        fetch_address=harmless(table),
        uart=uart,
        board=board,
        slot=slot or Slot(),
        tier="names",
    )


def harmless(table: RegisterTable) -> int:
    """The address of a register that can be read and that nothing says a reading clears; 0 where there is none."""
    return next((row.address for row in table if row.access.readable and not row.read_clears), 0)
