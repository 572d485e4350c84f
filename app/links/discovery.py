"""Who is on a line: every address is asked for its version, at every baud rate.

Nothing else is sent; an evaluation board is also asked what is in its slots, and chips on a UART what keeps the line
in step.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack, aclosing
from dataclasses import dataclass

from ..errors import BadReply, LinkTimeout, UnreadableModel, WrongState
from ..registers import catalog
from ..registers.catalog import MODELS
from ..registers.evaluation_board import ADDRESS as BOARD_ADDRESS
from ..registers.listed.chips import tells_version
from ..registers.tmcl.commands import Opcode
from .datagram_uart import UartForm
from .evaluation_board import Board, board_name, identify
from .queue import LinkQueue, Priority
from .serial_address import port_url
from .serial_line import BAUDS, SOCKET, Line, LinePort, line_of, serial_port
from .tmcl import Reply, Request, module_version, version_string
from .uart_line import BAUD as UART_BAUD
from .uart_line import UartPort, uart_line_of, uart_port

USUAL_BAUDS = (9600, 115200, *(baud for baud in BAUDS if baud not in (9600, 115200)))
"""Factory setting first, then the rate that most people change to."""
USUAL_ADDRESSES = tuple(range(1, 9))
USUAL_NODES = tuple(range(4))
USUAL_UART_BAUDS = (UART_BAUD, 57_600, 9600)
"""Chips measure the rate, so one would do; a long wire may be too slow for the first."""
INPUTS = tuple(dict.fromkeys(model.version_address for model in MODELS.values() if model.uart))
"""IOIN, INPUT: bits 31..24 are the version of the chip. Which register that is differs."""
WAIT_S = 0.06
"""For an answer, beyond its time on the wire [s]: adapters collect bytes for up to 16 ms, modules take 5."""
SOCKET_WAIT_S = 0.3


@dataclass(frozen=True, slots=True)
class FoundModule:
    """One that answered. `number` is what it calls itself (1241; of a chip its version), `version` that in words."""

    port: str
    baud: int | None
    """None where the line has no baud rate."""
    address: int
    number: int
    version: str
    board: str = ""
    """What it is where it is an evaluation board: "Landungsbrücke with TMC4361A and TMC2660"."""
    chip: str = ""
    """The motion controller on that board, "TMC4361A"; or the chip that answered on a UART, "" where none is known by
    that version."""
    node: int | None = None
    """The node of a chip on a UART; None also of one that has none."""
    uart: bool = False
    """Whether it is a chip on a UART."""
    candidates: tuple[str, ...] = ()
    """Models that it may be as well, or one of which it is where none is known by that version: sisters with the same
    version, and those of lists and register maps that have a version at that place, and do not tell which."""


@dataclass(frozen=True, slots=True)
class ProbeProgress:
    """Questions `done` of `total`, what was found so far, and what is asked next (or "" at the end)."""

    done: int
    total: int
    found: tuple[FoundModule, ...]
    asking: str


async def probe(
    port: str,
    bauds: Sequence[int] | None = None,
    addresses: Sequence[int] | None = None,
    progress: Callable[[ProbeProgress], None] | None = None,
) -> list[FoundModule]:
    """Ask every address at every baud rate; None means the usual ones. Cancel the task to end it.

    A line that devices have open is asked as it is, at its baud rate, and their commands and stops go first. Any
    other is opened, and closed at the end.

    Raises UsageError for what can be no port, WrongState where the line is open at another baud rate than asked for,
    LinkDown where it cannot be opened.
    """
    url = port_url(port.strip())
    rates = _rates(url, line_of(url), bauds, USUAL_BAUDS)
    asked = list(dict.fromkeys(addresses or USUAL_ADDRESSES))
    found: list[FoundModule] = []
    total = len(rates) * len(asked)

    def tell(done: int, asking: str) -> None:
        if progress is not None:
            progress(ProbeProgress(done, total, tuple(found), asking))

    done = 0
    for baud in rates:
        async with AsyncExitStack() as closing:  # all at once at the end: the line stays open until then
            for address in asked:
                tell(done, f"address {address}" if baud is None else f"address {address} at {baud} baud")
                module = serial_port(
                    url,
                    baud=baud or USUAL_BAUDS[0],
                    address=address,
                    timeout_s=SOCKET_WAIT_S if baud is None else WAIT_S,
                )
                closing.push_async_callback(module.aclose)
                answer = await _ask(module)
                if answer is not None:
                    number, version, board = answer
                    text, chip = ("", "") if board is None else (str(board), board.motion_controller)
                    found.append(FoundModule(port, baud, address, number, version, text, chip))
                done += 1
    tell(done, "")
    return found


async def probe_chips(
    port: str,
    bauds: Sequence[int] | None = None,
    nodes: Sequence[int] | None = None,
    progress: Callable[[ProbeProgress], None] | None = None,
) -> list[FoundModule]:
    """Ask every node for its chip's version, and then whether a chip without a node is there, at every baud rate.

    Ends with the first rate at which a device answers: chips answer at any. Otherwise as `probe`.
    """
    url = port_url(port.strip())
    line = uart_line_of(url)
    rates = _rates(url, line, bauds, USUAL_UART_BAUDS)
    asked: list[int | None] = list(dict.fromkeys(nodes or USUAL_NODES))
    if not line.is_open:  # one without a node would be alone on it
        asked.append(None)
    found: list[FoundModule] = []
    done, total = 0, len(rates) * len(asked)

    def tell(asking: str) -> None:
        if progress is not None:
            progress(ProbeProgress(done, total, tuple(found), asking))

    for baud in rates:
        for node in asked:
            who = "a chip without a node" if node is None else f"node {node}"
            tell(who if baud is None else f"{who} at {baud} baud")
            port_of_chip = uart_port(
                url,
                UartForm(node),
                baud=baud or UART_BAUD,
                echo=line.echo or "auto",
                timeout_s=SOCKET_WAIT_S if baud is None else WAIT_S,
            )
            async with aclosing(port_of_chip):
                answer = await _ask_chip(port_of_chip, node)
            done += 1
            if answer is not None:
                text = f"version {answer.version:#04x}"
                may_be = await asyncio.to_thread(
                    _candidates, answer, node
                )  # reading lists takes some tenths of a second
                found.append(
                    FoundModule(port, baud, node or 0, answer.version, text, "", answer.chip, node, True, may_be)
                )
        if found:
            break
    done = total
    tell("")
    return found


@dataclass(frozen=True, slots=True)
class _Version:
    """What a chip showed for a version, where that may be, and who is known by that."""

    addresses: tuple[int, ...]
    version: int
    chip: str = ""


def _candidates(seen: _Version, node: int | None) -> tuple[str, ...]:
    """Models that may show that beside the one that is named: sisters of the same version, those of lists and of
    register maps."""
    uart = "plain" if node is None else "node"
    found = [
        known.name
        for known in MODELS.values()
        if (known.uart, known.version) == (uart, seen.version)
        and known.version_address in seen.addresses
        and known.title != seen.chip
    ]
    for listed in (*catalog.maps(), *catalog.listings()):
        if listed.uart == uart and listed.kind == "chip":
            with contextlib.suppress(UnreadableModel):
                table = catalog.find_model(listed.name).table
                if any(tells_version(table, address, seen.version) for address in seen.addresses):
                    found.append(listed.name)
    return tuple(found)


def _chip_of(version: int, address: int, node: int | None) -> str:
    """The chip with a UART of that kind whose VERSION it is, read at `address`; empty where there is none."""
    uart = "plain" if node is None else "node"
    found = (
        known.title
        for known in MODELS.values()
        if (known.uart, known.version_address, known.version) == (uart, address, version)
    )
    return next(found, "")


def _rates(url: str, line: Line, bauds: Sequence[int] | None, usual: Sequence[int]) -> Sequence[int | None]:
    """At which rates to ask; None where there is none. Raises WrongState where a device has the line at another."""
    if url.startswith(SOCKET):
        return [None]
    if not line.is_open:
        return list(dict.fromkeys(bauds or usual))
    if bauds and line.baud not in bauds:
        raise WrongState(f"{url} is open at {line.baud} baud for a device", "disconnect that, or ask at its rate")
    return [line.baud]


async def _ask_chip(chip: UartPort, node: int | None) -> _Version | None:
    """The version of the chip, and its model where one is known by that; None where nobody answers."""
    seen: _Version | None = None
    for address in INPUTS:
        try:
            reply = await LinkQueue(chip).exchange(chip.form.read(address), Priority.SAMPLE)
            version = chip.form.data_of(address, reply) >> 24
        except (LinkTimeout, BadReply):
            break
        if known := _chip_of(version, address, node):
            return _Version((address,), version, known)
        if seen is None or (version and not seen.version):  # what has no version there reads 0
            seen = _Version((address,) if version else INPUTS, version)
    return seen


async def _ask(module: LinePort) -> tuple[int, str, Board | None] | None:
    """(number, version, evaluation board if it is one) of the module; None where nobody answers."""
    queue = LinkQueue(module)
    try:
        try:
            reply = await _version(queue, module.address, 1)
        except BadReply:
            # A device is there, and may have half a frame left of what was sent at another baud rate.
            reply = await _version(queue, module.address, 1)
        number, version = module_version(Reply.decode(reply).value)
    except (LinkTimeout, BadReply):
        return None
    text = f"{number}V{version.replace('.', '')}"
    with contextlib.suppress(LinkTimeout, BadReply):
        text = version_string(await _version(queue, module.address, 0))
        if module.address == BOARD_ADDRESS and board_name(text) is not None:
            return number, text, await identify(queue, Priority.SAMPLE)
    return number, text, None


async def _version(queue: LinkQueue, address: int, form: int) -> bytes:
    return await queue.exchange(Request(address, Opcode.GET_VERSION, form).encode(), Priority.SAMPLE)
