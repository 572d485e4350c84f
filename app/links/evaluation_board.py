"""A chip on one of Trinamic's evaluation boards: registers through TMCL over its USB serial port.

The port is a TMCL line like that of a module, with all that keeps it in step; what is on it is a base board
(Landungsbrücke, Startrampe) with a chip in its slot, whose firmware does the SPI.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..clock import Clock
from ..registers import catalog
from ..registers.evaluation_board import ADDRESS, CHANNEL_1_BOARDS, CHANNEL_2_BOARDS, MODULE_NUMBERS
from ..registers.tmcl.commands import Opcode
from .queue import LinkQueue, Priority
from .serial_line import LinePort, serial_port
from .tmcl import Reply, Request, version_string

BAUD = 115_200
"""Any will do over USB; PyTrinamic opens the port at this one."""
BOARDS_IN_SLOTS = 4
"""The global parameter that tells them. Command 143 tells them too, but looks for them anew, which resets them."""


@dataclass(frozen=True, slots=True)
class Board:
    """Who answers. `motion_controller` and `driver` are what is in the slots: "TMC4361A", "board 99", or ""."""

    name: str
    version: str
    motion_controller: str
    driver: str

    def __str__(self) -> str:
        slots = " and ".join(slot for slot in (self.motion_controller, self.driver) if slot)
        return f"{self.name} with {slots or 'empty slots'}"


def board_port(
    url: str,
    *,
    baud: int = BAUD,
    address: int = ADDRESS,
    timeout_s: float | None = None,
    clock: Clock | None = None,
) -> LinePort:
    """The board on the line behind a device name or a URL of pyserial."""
    return serial_port(url, baud=baud, address=address, timeout_s=timeout_s, clock=clock)


def chip_of(board: str) -> str | None:
    """The chip that stands on what a Landungsbrücke calls `board`; None where there is no driver of it."""
    known = (*catalog.MODELS.values(), *catalog.listings())
    return next((model.name for model in known if board and model.board == board), None)


async def identify(queue: LinkQueue, priority: Priority = Priority.COMMAND) -> Board | None:
    """Who is on the line; None where it is a TMCL module and no such board. Changes nothing, resets nothing.

    Raises what `LinkQueue.exchange` raises.
    """
    version = version_string(await queue.exchange(Request(ADDRESS, Opcode.GET_VERSION, 0).encode(), priority))
    name = board_name(version)
    if name is None:
        return None
    reply = Reply.decode(await queue.exchange(Request(ADDRESS, Opcode.GGP, BOARDS_IN_SLOTS).encode(), priority))
    word = reply.value & 0xFFFF_FFFF if reply.ok else 0
    return Board(name, version, _slot(CHANNEL_1_BOARDS, word & 0xFF), _slot(CHANNEL_2_BOARDS, word >> 16 & 0xFF))


def board_name(version: str) -> str | None:
    """What `0012V312` is the version of; None where it is that of no such board."""
    number = version[:4]
    return MODULE_NUMBERS.get(int(number)) if number.isdecimal() else None


def _slot(known: Mapping[int, str], number: int) -> str:
    return known.get(number, f"board {number}") if number else ""
