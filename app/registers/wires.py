"""The kinds of links that lead to a chip or module, as a closed vocabulary: what each is called, and says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Wire = Literal["emulator", "serial", "uart", "landungsbruecke", "tcp", "can", "spidev", "cover"]

BOARD: Wire = "landungsbruecke"
"""The maker's evaluation board, whose firmware says the registers."""


@dataclass(frozen=True, slots=True)
class WireKind:
    """A kind of link."""

    title: str
    frames: Literal["datagram", "uart", "board", "tmcl"]
    """What goes over it to a chip: its SPI datagrams, those of its UART, or commands of an evaluation board. A module
    is sent TMCL over all of its links."""


WIRES: dict[Wire, WireKind] = {
    "emulator": WireKind("Emulated here", "datagram"),
    "serial": WireKind("Serial", "tmcl"),
    "uart": WireKind("UART", "uart"),
    BOARD: WireKind("Eval board", "board"),
    "tcp": WireKind("TCP", "datagram"),
    "can": WireKind("CAN", "tmcl"),
    "spidev": WireKind("SPI bus", "datagram"),
    "cover": WireKind("Behind a controller", "datagram"),
}
"""In the order in which one chooses."""
