"""Running the dashboard in this process: what `stepscope serve` calls."""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import re
import signal
import socket
from collections.abc import Callable, MutableMapping
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING
from urllib.parse import urlencode

import uvicorn
from pydantic import SecretStr
from uvicorn.supervisors import ChangeReload

from .api.http.stops_first import is_stop
from .certificate import require_certificate
from .connections import (
    MESSAGE_BYTES_MAX,
    Door,
    Limits,
    Listener,
    descriptor_limit,
    limited_http,
    limited_websocket,
    raise_descriptor_limit,
)
from .listening import listen, url_of
from .page_first import PageFirst
from .settings import Settings
from .store.files import kept_token, make_private, one_server

if TYPE_CHECKING:  # the program takes two seconds to import: the page is served meanwhile
    from fastapi import FastAPI

    from .api.server_state import ServerState

log = logging.getLogger("stepscope")

YOUNG_OBJECTS = 5000
"""Objects that come before the garbage collector looks. By default it is 700, less than one answer makes: what only
lives for a request then counts as old, and all that is old is looked through every few requests, 0.1 s with many
devices."""
IDLE_S = 15
"""How long a connection without a call is kept [s]: longer than clients do (httpx: 5 s), else a call meets its end."""
HSTS = ("strict-transport-security", "max-age=31536000")
"""Sent with https alone: for a year browsers come to this name by https, whatever is typed."""
GRACE_S = 0.3
"""How long open requests may take to end after Ctrl-C [s]; sockets are closed at once."""


def serve(settings: Settings, announce: Callable[[str], None]) -> None:
    """Serve until Ctrl-C.

    Raises CannotListen, DirectoryInUse, BadTokenFile, BadCertificate before anything has started.
    """
    logging.basicConfig(format="%(levelname)s %(name)s: %(message)s", level=settings.log_level.upper())
    logging.getLogger("alembic").setLevel(logging.WARNING)  # its plugins and its plans are nobody's business here
    logging.getLogger("uvicorn.access").addFilter(_without_token)
    if settings.tls_cert is not None and settings.tls_key is not None:
        require_certificate(settings.tls_cert, settings.tls_key)
    if hasattr(os, "umask"):
        os.umask(0o077)  # whatever this process writes is its owner's alone
    for told in make_private(settings.data_dir):
        log.warning("%s", told)
    listener = listen(settings.host, settings.port)
    port = listener.getsockname()[1]
    address = url_of(settings.host, port, "http" if settings.tls_cert is None else "https")
    with listener, one_server(settings.data_dir, address):
        if settings.token is None and settings.token_file is not None:
            from .api.http.access import new_token

            token = SecretStr(kept_token(settings.token_file, new_token()))
            settings = Settings.model_validate({**settings.model_dump(), "token": token})
        _serve(settings, listener, announce)


def _serve(settings: Settings, listener: socket.socket, announce: Callable[[str], None]) -> None:
    port = listener.getsockname()[1]
    raise_descriptor_limit()

    def tell(app: FastAPI | None) -> None:
        announce(f"stepscope is at {_address(app, settings, port)}  (Ctrl-C stops the motors and ends it)")

    def over() -> None:
        if first.app is None:
            server.should_exit = True
            return
        server.serves(first.app)
        keep_out_of_collections()
        if not first.shows_page:
            tell(first.app)

    first = PageFirst(lambda: make_program(settings), settings, over)
    server = BenchServer(first, settings, on_ready=lambda: tell(None) if first.shows_page else None)
    end_with_the_terminal(server)
    with contextlib.suppress(KeyboardInterrupt):  # uvicorn ends properly, then raises the signal once more
        server.run(sockets=[listener])
    if first.failure is not None:
        raise first.failure


def make_program(settings: Settings) -> FastAPI:
    """All there is behind the page, its modules imported now."""
    from .main import create_app

    return create_app(settings)


def keep_out_of_collections() -> None:
    """Spare the garbage collector what is there for good: looking through all modules takes 0.2 s.

    Not even once: of 390 000 objects that a start makes, 2 000 are garbage.
    """
    gc.freeze()
    gc.enable()  # a start goes without it
    gc.set_threshold(YOUNG_OBJECTS, *gc.get_threshold()[1:])


def _without_token(record: logging.LogRecord) -> bool:
    """The access log of `--log-level debug` shows whole addresses: not the token in one."""
    if isinstance(record.args, tuple):
        record.args = tuple(
            re.sub(r"([?&]token=)[^&\s]*", r"\1***", part) if isinstance(part, str) else part for part in record.args
        )
    return True


def _address(app: FastAPI | None, settings: Settings, port: int) -> str:
    """What to open in a browser; with the token where `app` asks for one, since nobody could guess it."""
    address = url_of(settings.host, port, "http" if settings.tls_cert is None else "https")
    token: str | None = app.state.token if app is not None else None
    return address if token is None else f"{address}/?{urlencode({'token': token})}"


class BenchServer(uvicorn.Server):
    """uvicorn that stops the motors before it says goodbye to anybody."""

    def __init__(self, app: FastAPI | PageFirst, settings: Settings, on_ready: Callable[[], None]) -> None:
        self.door = Door(Limits.of_descriptors(descriptor_limit()))
        protocols = {"http": limited_http(self.door, is_stop), "ws": limited_websocket(self.door)}
        options = {**_options(settings), **protocols}
        super().__init__(uvicorn.Config(app, **options))  # type: ignore[arg-type]  # a table of options
        self._bench: ServerState | None = None
        self._on_ready = on_ready
        if not isinstance(app, PageFirst):
            self.serves(app)

    def serves(self, app: FastAPI) -> None:
        """The program is there: its health tells of this server's connections, and its motors end with it."""
        self._bench = app.state.bench
        self._bench.vitals.door = self.door

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup([Listener.over(each, self.door) for each in sockets or ()])
        self._on_ready()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        if self._bench is not None:
            from .main import stop_motors

            await stop_motors(self._bench)
        await super().shutdown(sockets)


def end_with_the_terminal(server: uvicorn.Server) -> None:
    """A terminal that is closed, or whose connection broke, ends the server as Ctrl-C does: with its motors stopped.

    Without this it would die on the spot. Under nohup it goes on.
    """
    hang_up = getattr(signal, "SIGHUP", None)  # not on Windows
    if hang_up is not None and signal.getsignal(hang_up) is not signal.SIG_IGN:

        def end(number: int, frame: FrameType | None) -> None:
            del number, frame
            server.should_exit = True

        signal.signal(hang_up, end)


def serve_with_reload(settings: Settings, environment: MutableMapping[str, str]) -> None:
    """Serve in a child process that starts again when a source file changes; it takes its settings from variables."""
    apart = {"allowed_hosts", "allowed_ports", "token"}
    for name, value in settings.model_dump(mode="json", exclude_none=True, exclude=apart).items():
        environment[f"STEPSCOPE_{name.upper()}"] = str(value)
    if settings.token is not None:  # dumped, it would be asterisks
        environment["STEPSCOPE_TOKEN"] = settings.token.get_secret_value()
    # The UI comes from Vite on another port of this machine, whose pages are ours here.
    environment["STEPSCOPE_ALLOWED_HOSTS"] = ",".join({*settings.allowed_hosts, "localhost", "127.0.0.1", "::1"})
    environment["STEPSCOPE_ALLOWED_PORTS"] = ",".join(settings.allowed_ports)
    sources = [str(Path(__file__).parent)]
    config = uvicorn.Config(f"{__package__}.main:create_app", reload=True, reload_dirs=sources, **_options(settings))  # type: ignore[arg-type]
    with listen(settings.host, settings.port) as listener:
        ChangeReload(config, target=serve_reloaded, sockets=[listener]).run()


def serve_reloaded(sockets: list[socket.socket] | None = None) -> None:
    """Serve in this process, which was started for it, with settings from variables."""
    settings = Settings()
    BenchServer(make_program(settings), settings, on_ready=lambda: None).run(sockets)


def _options(settings: Settings) -> dict[str, object]:
    return {
        "host": settings.host,
        "port": settings.port,
        "http": "httptools",
        "loop": "asyncio",  # others accept by themselves: `Listener` would not be asked
        "ws": "websockets-sansio",
        "ws_max_size": MESSAGE_BYTES_MAX,
        "ws_per_message_deflate": False,  # float64 noise hardly shrinks, and compressing costs more than the wire
        "log_level": "warning" if settings.log_level == "info" else settings.log_level,
        "access_log": settings.log_level == "debug",
        "timeout_graceful_shutdown": GRACE_S,
        "timeout_keep_alive": IDLE_S,
        "server_header": False,
        "headers": [] if settings.tls_cert is None else [HSTS],
        "ssl_certfile": settings.tls_cert,
        "ssl_keyfile": settings.tls_key,
    }
