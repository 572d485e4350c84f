"""Running emulated devices in this process: what `stepscope emulate` calls. It needs nothing of the dashboard."""

from __future__ import annotations

import asyncio
import contextlib
import math
import signal
import socket
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, cast

from ..clock import Clock, WallClock
from ..emulators.line.ends import End
from ..emulators.line.framing import TMCL, Fixed, Framing
from ..emulators.line.line import Line
from ..emulators.line.module import LineModule
from ..emulators.line.raw import RawChip
from ..emulators.line.server import LineServer
from ..emulators.line.tcp import TcpEnd
from ..emulators.line.uart import uart_line
from ..emulators.server import Served, frame_bytes_of, serve_tcp
from ..emulators.tmcl.module import EmulatedModule
from ..emulators.tmcl.options import Pd42Options
from ..links.datagram_uart import MODELS as UART_MODELS
from ..links.datagram_uart import NODE_MODELS
from ..listening import CannotListen, host_and_port, listen, url_of, why

if TYPE_CHECKING:
    from fastapi import FastAPI

    from ..emulators.tmc5xxx import Tmc5xxxModel

MODULE, BOARD = "pd42-1241", "landungsbruecke"
LINES = (MODULE, BOARD)
"""What always hangs on a serial line; all other models are chips, with raw frames or on a UART."""
NODECONF, SEVERAL = 0x03, 2 << 8
"""Where a chip has its node address; and SENDDELAY of three times eight bit times, which chips on one line need to have
(TMC5160A data sheet 1.14, 5.4)."""
GRACE_S = 0.3
"""How long requests of the control port may take to end after Ctrl-C [s]."""


def shows_uart(model: str, *, asked: bool) -> bool:
    """Whether an emulated `model` is to be reached by its UART, where that was `asked` for; else by raw frames."""
    return asked and model in UART_MODELS


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
    where = None if tcp is None else host_and_port("--tcp", tcp)
    with _killed_by_signals():
        from ..emulators.build import build_emulator, options_of

        chip = build_emulator(model, WallClock(), options_of(model).model_validate(options))
        assert not isinstance(chip, EmulatedModule)  # those hang on lines
        chip.clock.scale = time_scale
        chip.catch_up(0.0)  # compiles: whoever is told that we listen gets answers at once
    if where is not None:
        asyncio.run(_emulate(chip, *where, announce))
    elif pty is not None:
        line = Line([RawChip(chip)], WallClock(), baud=baud, framing=Fixed(frame_bytes_of(model)))
        with contextlib.ExitStack() as stack:
            try:
                server = stack.enter_context(LineServer(line, _ends(LineOptions(pty=pty))))
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
            raise CannotListen(why(error, host, port)) from error
        bound = server.sockets[0].getsockname()
        announce(f"emulated {chip.model} listens on tcp {bound[0]}:{bound[1]}  (Ctrl-C ends it)")
        await ended.wait()
        server.close()  # clients that are still there are cut off as the loop ends


@dataclass(frozen=True)
class LineOptions:
    """An emulated line as the command line describes it. `addresses` are those of its modules, or nodes of its chips.

    `model` is what hangs on it: pd42-1241, one landungsbruecke with a `chip` that has `clock_hz`, or chips with a UART,
    whose line may give back what is said to it (`echo`).
    """

    model: str = MODULE
    chip: str = "tmc4361"
    clock_hz: float | None = None
    pty: Path | None = None
    tcp: str | None = None
    addresses: Sequence[int] = (1,)
    baud: int | None = None
    shared_bus: bool = False
    echo: bool = False
    data_dir: Path | None = None
    control: str | None = None
    seed: int = 1241
    time_scale: float = 1.0


def emulate_line(options: LineOptions, announce: Callable[[str], None]) -> None:
    """Serve PD42-1241 modules, an evaluation board, or the UART of chips, on one line until Ctrl-C or SIGTERM.

    Raises ValueError for options that cannot be, CannotListen for an address or a path that cannot be had.
    """
    if options.pty is None and options.tcp is None:
        raise ValueError("say where: --pty PATH, --tcp HOST:PORT, or both")
    if len(set(options.addresses)) != len(options.addresses):
        raise ValueError("whoever is on a line needs an address of its own")
    if options.model in UART_MODELS - NODE_MODELS and tuple(options.addresses) != (0,):
        raise ValueError(f"a {options.model} has no node address, and is alone on its line")
    make = {MODULE: _modules, BOARD: _board}.get(options.model, _chips)
    with _killed_by_signals():  # loading the emulators, or compiling them, takes its time
        far = make(WallClock(), options)
    with contextlib.ExitStack() as stack:
        # The control port first: a client may set a fault as soon as the line is there.
        control = listen(*host_and_port("--control", options.control)) if options.control else None
        if control is not None:
            stack.callback(control.close)
            control.listen()  # whoever calls before the server behind it runs just waits
        try:
            server = stack.enter_context(LineServer(far.line, _ends(options)))
        except OSError as error:
            raise CannotListen(str(error)) from error
        said = [f"emulated {options.model} at {', '.join(end.name for end in server.ends)}"]
        if control is not None:
            stack.enter_context(_controlling(far.make_control(server), control))
            said.append(f"control at {url_of(*control.getsockname()[:2])}")
        stack.enter_context(_ended_by_signals(server.stop))
        announce(f"{'; '.join(said)}  (Ctrl-C ends it)")
        server.run()


@dataclass(frozen=True)
class _Far:
    """The line with what hangs on it, and the control port for it (an import of its own: most lines need none)."""

    line: Line
    make_control: Callable[[LineServer], FastAPI]


def _line(modules: Sequence[LineModule], clock: Clock, options: LineOptions, framing: Framing) -> Line:
    return Line(
        modules,
        clock,
        baud=options.baud,
        shared_bus=options.shared_bus,
        addresses=options.addresses,
        seed=options.seed,
        framing=framing,
    )


def _modules(clock: Clock, options: LineOptions) -> _Far:
    modules = {address: _module(address, clock, options) for address in options.addresses}

    def make_control(server: LineServer) -> FastAPI:
        from .line_control import Controlled, make_control_app

        return make_control_app(Controlled(server, modules))

    return _Far(_line(list(modules.values()), clock, options, TMCL), make_control)


def _module(address: int, clock: Clock, options: LineOptions) -> EmulatedModule:
    # Modules that made the same noise would be one module twice.
    named = {"address": address, "time_scale": options.time_scale, "seed": options.seed + address}
    eeprom = None if options.data_dir is None else options.data_dir / "emulators" / f"pd42-1241-{address}.json"
    return EmulatedModule(clock, Pd42Options.model_validate(named), eeprom)


def _board(clock: Clock, options: LineOptions) -> _Far:
    from ..emulators.board.build import build_board

    board = build_board(options.chip, clock, {**_of_chip(options), "seed": options.seed})

    def make_control(server: LineServer) -> FastAPI:
        from .board_control import make_board_control_app

        return make_board_control_app(server, board)

    # Its firmware waits for nine bytes however long it takes.
    return _Far(_line([board], clock, options, replace(TMCL, pause_s=math.inf)), make_control)


def _chips(clock: Clock, options: LineOptions) -> _Far:
    from ..emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxOptions

    chips = {}
    for node in options.addresses:
        # Chips that made the same noise would be one chip twice.
        named = Tmc5xxxOptions.model_validate({**_of_chip(options), "seed": options.seed + node})
        chip = chips[node] = EmulatedTmc5xxx(cast("Tmc5xxxModel", options.model), clock, named)
        if options.model in NODE_MODELS:
            chip.write(NODECONF, node | (SEVERAL if len(options.addresses) > 1 else 0))
        chip.catch_up(0.0)  # compiles: whoever is told that we are there gets answers at once

    def make_control(server: LineServer) -> FastAPI:
        from .chip_control import make_chip_control_app

        return make_chip_control_app(server, chips)

    return _Far(
        uart_line(
            list(chips.values()),
            clock,
            nodes=options.addresses,
            baud=options.baud,
            echo=options.echo,
            shared_bus=options.shared_bus,
            seed=options.seed,
        ),
        make_control,
    )


def _of_chip(options: LineOptions) -> dict[str, object]:
    given: dict[str, object] = {"time_scale": options.time_scale}
    return given if options.clock_hz is None else {**given, "clock_hz": options.clock_hz}


def _ends(options: LineOptions) -> list[End]:
    ends: list[End] = []
    if options.tcp is not None:
        ends.append(TcpEnd(listen(*host_and_port("--tcp", options.tcp))))
    if options.pty is not None:
        from ..emulators.line.pty import PtyEnd  # not every system has such terminals

        ends.append(PtyEnd(options.pty))
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

    from ..connections import Door, Limits, Listener, descriptor_limit, limited_http

    door = Door(Limits.of_descriptors(descriptor_limit()))
    web = uvicorn.Server(
        uvicorn.Config(
            app,
            http=limited_http(door, lambda method, path: False),
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
