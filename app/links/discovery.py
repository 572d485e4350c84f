"""Which modules are on a line: every address is asked for its version, at every baud rate.

Nothing else is sent; an evaluation board is also asked what is in its slots.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack
from dataclasses import dataclass

from app.links.errors import BadReply, LinkTimeout, WrongState
from app.links.landungsbruecke import Board, board_name, identify
from app.links.queue import LinkQueue, Priority
from app.links.registry import port_url
from app.links.serial_line import BAUDS, SOCKET, LinePort, line_of, serial_port
from app.links.tmcl import Reply, Request, module_version, version_string
from app.registers.landungsbruecke import ADDRESS as BOARD_ADDRESS
from app.registers.tmcl import Opcode

USUAL_BAUDS = (9600, 115200, *(baud for baud in BAUDS if baud not in (9600, 115200)))
"""Factory setting first, then the rate that most people change to."""
USUAL_ADDRESSES = tuple(range(1, 9))
WAIT_S = 0.06
"""For an answer, beyond its time on the wire [s]: adapters collect bytes for up to 16 ms, modules take 5."""
SOCKET_WAIT_S = 0.3


@dataclass(frozen=True, slots=True)
class FoundModule:
    """One that answered. `number` is what it calls itself (1241), `version` its string ("1241V144")."""

    port: str
    baud: int | None
    """None where the line has no baud rate."""
    address: int
    number: int
    version: str
    board: str = ""
    """What it is where it is an evaluation board: "Landungsbrücke with TMC4361A and TMC2660"."""
    chip: str = ""
    """The motion controller on that board: "TMC4361A"."""


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
    line = line_of(url)
    rates: Sequence[int | None] = list(dict.fromkeys(bauds or USUAL_BAUDS))
    if url.startswith(SOCKET):
        rates = [None]
    elif line.is_open:
        if bauds and line.baud not in bauds:
            raise WrongState(f"{port} is open at {line.baud} baud for a device", "disconnect that, or ask at its rate")
        rates = [line.baud]
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


async def _ask(module: LinePort) -> tuple[int, str, Board | None] | None:
    """(number, version, evaluation board if it is one) of the module; None where nobody answers."""
    queue = LinkQueue(module)
    try:
        try:
            reply = await _version(queue, module.address, 1)
        except BadReply:
            # Somebody is there, and may have half a frame left of what was sent at another baud rate.
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
