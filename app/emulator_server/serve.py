"""Running emulated devices in this process: what `stepscope emulate` calls. It needs nothing of the dashboard."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import socket
import threading
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from ..clock import WallClock
from ..emulators.board.options import MODEL as BOARD
from ..emulators.core.pace import Pace
from ..emulators.line.can_end import CanEnd
from ..emulators.line.can_message import CanModule
from ..emulators.line.ends import End
from ..emulators.line.framing import Fixed
from ..emulators.line.line import Line
from ..emulators.line.raw import RawChip
from ..emulators.line.server import LineServer
from ..emulators.line.tcp import TcpEnd
from ..emulators.server import Served, serve_tcp
from ..errors import UsageError
from ..links.can_bus import SOCKETCAN, check_bus, require_python_can
from ..links.spi_datagram import frame_bytes_of
from ..listening import CannotListen, host_and_port, listen, url_of, why
from ..registers.catalog import find_model, is_known, is_model
from .compiling import compiled_behind, serve_plain
from .line import LineMaker, LineOptions

if TYPE_CHECKING:
    from fastapi import FastAPI

__all__ = ["BOARD", "LineOptions", "emulate", "emulate_line", "is_line", "is_module", "named_or_mapped", "shows_uart"]

MAP_SUFFIXES = (".toml", ".csv", ".tsv")
GRACE_S = 0.3
"""How long requests of the control port may take to end after Ctrl-C [s]."""


def named_or_mapped(model: str) -> str:
    """`model`; of the file of a register map the name of the model that it makes here. Raises UnreadableMap, UsageError
    for a file whose name can be none, OSError."""
    file = Path(model)
    if file.suffix.casefold() not in MAP_SUFFIXES:
        return model
    from ..registers.maps.files import name_of, read_file
    from ..registers.maps.models import MAPS, entry

    name = name_of(file)
    if is_known(name):
        raise UsageError(f"{name} is a model already: give the register map another name")
    MAPS[name] = entry(read_file(file))
    return name


def is_module(model: str) -> bool:
    """Whether `model` speaks TMCL by itself: then it hangs on a line, alone or with others."""
    return is_model(model) and find_model(model).kind == "module"


def is_line(model: str) -> bool:
    """Whether `model` always hangs on a serial line; all others are chips, with raw frames or on a UART."""
    return model == BOARD or is_module(model)


def shows_uart(model: str, *, asked: bool) -> bool:
    """Whether an emulated `model` is to be reached by its UART: where that was `asked` for, or it has nothing else."""
    return is_model(model) and find_model(model).uart != "" and (asked or find_model(model).uart_alone)


def emulate(
    model: str,
    options: Mapping[str, object],
    time_scale: float,
    announce: Callable[[str], None],
    *,
    tcp: str | None = None,
    pty: Path | None = None,
    baud: int | None = None,
) -> None:
    """Serve the raw frames of one emulated chip until Ctrl-C or SIGTERM: at a TCP port, or at a `pty` at `baud`.

    A chip with a UART shows that at a pty instead: `emulate_line`. Raises ValueError for options that cannot be, and
    CannotListen.
    """
    if (tcp is None) == (pty is None):
        raise ValueError("say where: --tcp HOST:PORT, or --pty PATH")
    if baud is not None and pty is None:
        raise ValueError("--baud is for a line: use it with --pty")
    if is_model(model) and not find_model(model).datagram_bits:
        if find_model(model).tier == "map":
            raise ValueError(
                f"{model} has no [spi]" + (", only a UART: say --pty, or --uart" if find_model(model).uart else "")
            )
        raise ValueError(f"the datagrams of a {model} are not known: emulate {BOARD} --chip {model}")
    where = None if tcp is None else host_and_port("--tcp", tcp)
    with _killed_by_signals():
        from ..emulators.build import build_emulator, options_of

        missing = serve_plain(model)
        chip = build_emulator(model, WallClock(), options_of(model).model_validate(options))
        chip.clock.scale = time_scale
        chip.pace = Pace(chip.clock.base.now, share=1.0)
        chip.catch_up(0.0)  # loads what is on disk: whoever is told that we listen gets answers at once
    with contextlib.ExitStack() as stack:
        stack.enter_context(compiled_behind(missing))
        if where is not None:
            asyncio.run(_emulate(chip, *where, announce))
        elif pty is not None:
            line = Line([RawChip(chip)], WallClock(), baud=baud, framing=Fixed(frame_bytes_of(model)))
            try:
                server = stack.enter_context(LineServer(line, _ends(None, pty)))
            except OSError as error:
                raise CannotListen(str(error)) from error
            stack.enter_context(_ended_by_signals(server.stop))
            announce(f"emulated {model} at {server.ends[0].name}  (Ctrl-C ends it)")
            server.run()


async def _emulate(chip: Served, host: str, port: int, announce: Callable[[str], None]) -> None:
    ended, loop = asyncio.Event(), asyncio.get_running_loop()
    with _ended_by_signals(lambda: loop.call_soon_threadsafe(ended.set)):
        try:
            server = await serve_tcp(chip, host, port)
        except OSError as error:
            raise CannotListen(why(error, host, port, "--tcp")) from error
        bound = server.sockets[0].getsockname()
        announce(f"emulated {chip.model} listens on tcp {bound[0]}:{bound[1]}  (Ctrl-C ends it)")
        await ended.wait()
        server.close()  # clients that are still there are cut off as the loop ends


def emulate_line(options: LineOptions, announce: Callable[[str], None]) -> None:
    """Serve modules, an evaluation board, or the UART of chips, on one line until Ctrl-C or SIGTERM.

    Raises ValueError for options that cannot be, CannotListen for an address or a path that cannot be had.
    """
    if options.pty is None and options.tcp is None and options.can is None:
        raise ValueError("say where: --pty PATH, --tcp HOST:PORT, --can CHANNEL, or several")
    can_bus = None if options.can is None else _bus_of(options.can)
    if len(set(options.addresses)) != len(options.addresses):
        raise ValueError("whoever is on a line needs an address of its own")
    if is_model(options.model) and find_model(options.model).uart == "plain" and tuple(options.addresses) != (0,):
        raise ValueError(f"a {options.model} has no node address, and is alone on its line")
    with _killed_by_signals():  # loading the emulators takes its time
        missing = serve_plain(options.model, options.chip)
        far = _maker_of(options.model)(WallClock(), options)
    can_end = None if can_bus is None else CanEnd(*can_bus, _can_bit_rate(options.model, far.line))
    with contextlib.ExitStack() as stack:
        stack.enter_context(compiled_behind(missing))
        # The control port first: a client may set a fault as soon as the line is there.
        control = listen(*host_and_port("--control", options.control), "--control") if options.control else None
        if control is not None:
            stack.callback(control.close)
            control.listen()  # whoever calls before the server behind it runs just waits
        try:
            server = stack.enter_context(LineServer(far.line, _ends(options.tcp, options.pty, can_end)))
        except OSError as error:
            raise CannotListen(str(error)) from error
        said = [f"emulated {options.model} at {', '.join(end.name for end in server.ends)}"]
        if control is not None:
            stack.enter_context(_controlling(far.make_control(server), control))
            said.append(f"control at {url_of(*control.getsockname()[:2])}")
        stack.enter_context(_ended_by_signals(server.stop))
        announce(f"{'; '.join(said)}  (Ctrl-C ends it)")
        server.run()


def _maker_of(model: str) -> LineMaker:
    """What puts `model` on a line. Raises UnknownThing."""
    if model == BOARD:
        from .board import make_line

        return make_line
    from .families import line_maker_of

    return line_maker_of(model)


def _bus_of(can: str) -> tuple[str, str]:
    """Interface and channel of `INTERFACE:CHANNEL`, of socketcan by its channel alone. Raises UsageError."""
    require_python_can()
    interface, colon, channel = can.partition(":")
    bus = (interface, channel) if colon else (SOCKETCAN, can)
    check_bus(*bus)
    return bus


def _can_bit_rate(model: str, line: Line) -> int:
    """Of the modules on `line` [bit/s]. Raises ValueError for those without CAN, and where they differ."""
    rates = {module.can_bit_rate if isinstance(module, CanModule) else None for module in line.modules}
    rate = rates.pop()
    if rate is None:
        raise ValueError(f"--can is not for a {model}: its emulator has no CAN interface")
    if rates:
        raise ValueError(
            "the modules' EEPROMs hold different CAN bit rates (global parameter 69), so they cannot share a bus"
        )
    return rate


def _ends(tcp: str | None, pty: Path | None, can: End | None = None) -> list[End]:
    ends: list[End] = []
    if tcp is not None:
        ends.append(TcpEnd(listen(*host_and_port("--tcp", tcp), "--tcp")))
    if pty is not None:
        from ..emulators.line.pty import PtyEnd  # not every system has such terminals

        ends.append(PtyEnd(pty))
    if can is not None:
        ends.append(can)
    return ends


@contextlib.contextmanager
def _ended_by_signals(stop: Callable[[], object]) -> Iterator[None]:
    """Ctrl-C and SIGTERM call `stop`, and end nothing in the middle of a frame.

    Also where we were started to ignore Ctrl-C, as a shell starts what is to run in the background.
    """
    with _handling(lambda *_: stop()):
        yield


@contextlib.contextmanager
def _killed_by_signals() -> Iterator[None]:
    """Ctrl-C and SIGTERM end the process at once: while machine code is compiled, no handler of Python's would run."""
    with _handling(signal.SIG_DFL):
        yield


@contextlib.contextmanager
def _handling(handler: Callable[[int, FrameType | None], object] | signal.Handlers) -> Iterator[None]:
    before = {number: signal.signal(number, handler) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)


@contextlib.contextmanager
def _controlling(app: FastAPI, listener: socket.socket) -> Iterator[None]:
    """The control port, in a thread of its own, as long as the block runs. The line's server has to run meanwhile."""
    import uvicorn  # a quarter of a second that most lines need not wait for

    from ..connections import (
        MESSAGE_BYTES_MAX,
        Door,
        Limits,
        Listener,
        descriptor_limit,
        limited_http,
        limited_websocket,
    )

    door = Door(Limits.of_descriptors(descriptor_limit()))
    web = uvicorn.Server(
        uvicorn.Config(
            app,
            http=limited_http(door, lambda method, path: False),
            ws=limited_websocket(door),
            ws_max_size=MESSAGE_BYTES_MAX,
            loop="asyncio",
            log_level="warning",
            access_log=False,
            lifespan="off",
            server_header=False,
            timeout_graceful_shutdown=1,
        )
    )
    thread = threading.Thread(
        target=web.run, kwargs={"sockets": [Listener.over(listener, door)]}, name="control", daemon=True
    )
    thread.start()
    try:
        yield
    finally:
        web.should_exit = True
        thread.join(timeout=GRACE_S)
