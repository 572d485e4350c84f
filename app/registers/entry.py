"""An entry of the catalog: a chip or module, what it is and what it can."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .capabilities import Capability
from .evaluation_board import ADDRESS, REGISTER_ADDRESS_BITS
from .model import RegisterTable
from .spi_format import Spi
from .wires import Wire

Tier = Literal["full", "names", "map"]


@dataclass(frozen=True, slots=True)
class Slot:
    """How the maker's evaluation board leads to a chip.

    side : whether it stands in the slot of the motion controller or in that of the driver
    module : the TMCL address that answers
    address_bits : of a register's address; the rest of the type and motor bytes is the chip's block of registers
    blocks : whether it has several, whose number stands above these bits in the addresses of its table
    """

    side: Literal["controller", "driver"] = "controller"
    module: int = ADDRESS
    address_bits: int = REGISTER_ADDRESS_BITS
    blocks: bool = False


@dataclass(frozen=True, slots=True)
class Model:
    """A chip or module: its name on the API, what it is, and its registers or parameters."""

    name: str
    family: str
    """Whose driver, emulator and tables it has: the name of its folder in each layer."""
    title: str
    summary: str
    description: str
    """What it is among all devices: "a chip with SixPoint ramps"."""
    axes: int
    table: RegisterTable
    clock_hz_default: float
    clock_hz_max: float
    capabilities: frozenset[Capability]
    wires: frozenset[Wire]
    """The kinds of links that lead to it."""
    clock_hz_min: float = 0.0
    """0: the sources name no lowest clock."""
    current_scale: Literal["", "sense_resistor", "full_scale"] = ""
    """What makes amperes of its current settings; empty where it sets no current."""
    kind: Literal["chip", "module"] = "chip"
    """A chip has registers; a module speaks TMCL and has parameters."""
    datagram_bits: int = 32
    """Length of one datagram on the SPI of a chip; 0 for a module, whose frames TMCL tells, and for a chip whose
    datagrams are not known or that has no SPI."""
    spi: Spi | None = None
    """How a datagram of it says a register, where that is told; None for those that its family knows by itself."""
    fetch_address: int = 0
    """What is read to fetch the answer to the datagram before, where answers come one later: reading it clears
    nothing."""
    uart: Literal["", "plain", "node"] = ""
    """A chip's UART besides SPI: none, datagrams of one chip on a line, or with the address of one of several."""
    board: str = ""
    """What the maker's evaluation board calls the chip in its slot; empty where it takes none."""
    slot: Slot = Slot()
    """How that board leads to it."""
    tier: Tier = "full"
    """How deep it is known: with calculators and a physical emulator, by the names of its parameters alone,
    or by a register map that the user brought along."""
    driver: str = ""
    """The driver chip in a module, by its name here: parameters with a `driver` place are registers of it."""
    nodes: int = 0
    """How many addresses its UART has, from 0 on; 0: as many as a datagram can say."""
    version: int | None = None
    """What a chip with a VERSION shows there; None for those that have none."""
    version_address: int = 0x04
    """The register that has VERSION, in bits 31..24."""

    @property
    def uart_alone(self) -> bool:
        """Whether it is a chip that nothing but its UART leads to, whose emulator has that."""
        return self.tier == "full" and self.uart != "" and not self.datagram_bits

    @property
    def counts_position(self) -> bool:
        """Whether it knows where the motor is beyond an electrical turn: what is stepped from outside does not."""
        return not self.can("step_input")

    def can(self, capability: Capability) -> bool:
        return capability in self.capabilities
