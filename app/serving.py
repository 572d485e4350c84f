"""Running servers in this process: the dashboard, or one emulated chip. What the command line calls."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import logging
import os
import socket
from collections.abc import Callable, Mapping, MutableMapping

import uvicorn
from fastapi import FastAPI

from app.main import bench_of, create_app, stop_motors
from app.settings import Settings

GRACE_S = 0.3
"""How long open requests may take to end after Ctrl-C [s]; sockets are closed at once."""


class CannotListen(OSError):
    """The address cannot be had; the text says why and what to do."""


def serve(settings: Settings, announce: Callable[[str], None]) -> None:
    """Serve until Ctrl-C. Raises CannotListen before anything has started."""
    logging.basicConfig(format="%(levelname)s %(name)s: %(message)s", level=settings.log_level.upper())
    listener = listen(settings.host, settings.port)
    port = listener.getsockname()[1]
    ready = f"stepscope is at {_url(settings.host, port)}  (Ctrl-C stops the motors and ends it)"
    server = BenchServer(create_app(settings), settings, on_ready=lambda: announce(ready))
    with contextlib.suppress(KeyboardInterrupt):  # uvicorn ends properly, then raises the signal once more
        server.run(sockets=[listener])


class BenchServer(uvicorn.Server):
    """uvicorn that stops the motors before it says goodbye to anybody."""

    def __init__(self, app: FastAPI, settings: Settings, on_ready: Callable[[], None]) -> None:
        super().__init__(uvicorn.Config(app, **_options(settings)))  # type: ignore[arg-type]  # a table of options
        self._bench = bench_of(app)
        self._on_ready = on_ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self._on_ready()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        await stop_motors(self._bench)
        await super().shutdown(sockets)


def serve_with_reload(settings: Settings, environment: MutableMapping[str, str]) -> None:
    """Serve in a child process that starts again when a source file changes; it takes its settings from variables."""
    for name, value in settings.model_dump(mode="json", exclude_none=True, exclude={"allowed_hosts"}).items():
        environment[f"STEPSCOPE_{name.upper()}"] = str(value)
    # The UI comes from Vite on another port of this machine, whose pages are ours here.
    environment["STEPSCOPE_ALLOWED_HOSTS"] = ",".join({*settings.allowed_hosts, "localhost", "127.0.0.1", "::1"})
    listen(settings.host, settings.port).close()
    uvicorn.run("app.main:create_app", factory=True, reload=True, reload_dirs=["app"], **_options(settings))  # type: ignore[arg-type]


def _options(settings: Settings) -> dict[str, object]:
    return {
        "host": settings.host,
        "port": settings.port,
        "http": "httptools",
        "ws": "websockets-sansio",
        "ws_per_message_deflate": False,  # float64 noise hardly shrinks, and compressing costs more than the wire
        "log_level": "warning" if settings.log_level == "info" else settings.log_level,
        "access_log": settings.log_level == "debug",
        "timeout_graceful_shutdown": GRACE_S,
        "server_header": False,
    }


def listen(host: str, port: int) -> socket.socket:
    """A bound socket; port 0 picks a free one. Raises CannotListen."""
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, kind, protocol)
        try:
            if os.name == "posix":  # elsewhere it would let two servers have the same port
                listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind(address)
        except OSError:
            listener.close()
            raise
    except OSError as error:
        raise CannotListen(_why(error, host, port)) from error
    listener.setblocking(False)
    return listener


def _why(error: OSError, host: str, port: int) -> str:
    if error.errno == errno.EADDRINUSE:
        return (
            f"port {port} of {host} is taken; is stepscope running already? Another one: --port {port + 1}, or --port 0"
        )
    if error.errno == errno.EACCES:
        return f"port {port} needs more rights; use one above 1023, e.g. --port 8000"
    return f"cannot listen on {host}:{port}: {error.strerror or error}"


def _url(host: str, port: int) -> str:
    shown = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host)
    return f"http://[{shown}]:{port}" if ":" in shown else f"http://{shown}:{port}"


def emulate(
    model: str, address: str, options: Mapping[str, object], time_scale: float, announce: Callable[[str], None]
) -> None:
    """Serve one emulated chip until Ctrl-C. Raises ValueError for options that cannot be, and CannotListen."""
    host, separator, port_text = address.rpartition(":")
    if not separator or not port_text.isdecimal() or int(port_text) > 65_535:
        raise ValueError(f"--tcp is HOST:PORT, e.g. 127.0.0.1:4280, not {address!r}")
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(_emulate(model, host.strip("[]"), int(port_text), options, time_scale, announce))


async def _emulate(
    model: str,
    host: str,
    port: int,
    options: Mapping[str, object],
    time_scale: float,
    announce: Callable[[str], None],
) -> None:
    from app.clock import WallClock
    from app.emulators.build import build_emulator
    from app.emulators.options import EmulatorOptions
    from app.emulators.server import serve_tcp

    device = build_emulator(model, WallClock(), EmulatorOptions.model_validate(options))
    device.clock.scale = time_scale
    try:
        server = await serve_tcp(device, host, port)
    except OSError as error:
        raise CannotListen(_why(error, host, port)) from error
    async with server:
        bound = server.sockets[0].getsockname()
        announce(f"emulated {model} listens on tcp {bound[0]}:{bound[1]}  (Ctrl-C ends it)")
        await server.serve_forever()
