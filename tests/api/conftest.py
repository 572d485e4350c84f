"""The whole program behind httpx: real drivers, real emulators, the clock of the test, no socket."""

from __future__ import annotations

import threading
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from app.api.schemas import Port
from app.clock import VirtualClock, WallClock
from app.emulators.build import build_emulator
from app.emulators.line.line import Line
from app.emulators.line.pty import PtyEnd
from app.emulators.line.server import LineServer
from app.emulators.server import serve_tcp
from app.emulators.tmcl.module import EmulatedModule
from app.emulators.tmcl.options import TmclOptions
from app.main import create_app
from app.settings import Settings

PORTS = [Port(kind="serial", name="/dev/ttyUSB0", description="USB serial", usb_vid=0x0403, usb_pid=0x6001)]


@pytest.fixture
def clock() -> VirtualClock:
    return VirtualClock(1000.0)


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    web = tmp_path / "web"
    (web / "assets").mkdir(parents=True)
    (web / "index.html").write_text("<!doctype html><title>the page</title>")
    (web / "assets" / "index-abc123.js").write_text("// script")
    (web / "favicon.svg").write_text("<svg/>")
    help_site = tmp_path / "help"
    (help_site / "how").mkdir(parents=True)
    (help_site / "index.html").write_text("<!doctype html><title>the help</title>")
    (help_site / "how" / "ramp.html").write_text("<!doctype html><title>ramps</title>")
    return Settings(data_dir=tmp_path / "data", web_dir=web, help_dir=help_site, body_limit_bytes=100_000)


@pytest.fixture
async def app(settings: Settings, clock: VirtualClock) -> AsyncIterator[FastAPI]:
    app = create_app(settings, clock, lambda: list(PORTS))
    async with app.router.lifespan_context(app):
        yield app


@pytest.fixture
async def far_chip() -> AsyncIterator[int]:
    """An emulated TMC428 behind a TCP socket, on the wall clock: its port. Ask for it before the client."""
    server = await serve_tcp(build_emulator("tmc428", WallClock()), "127.0.0.1", 0)
    yield server.sockets[0].getsockname()[1]
    server.close()
    await server.wait_closed()


@pytest.fixture
async def client(app: FastAPI) -> AsyncIterator[httpx.AsyncClient]:
    """A script that talks to the demo bench: paths are relative to /api/v1."""
    transport = httpx.ASGITransport(app)
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000/api/v1/") as client:
        yield client


@pytest.fixture
async def motor(client: httpx.AsyncClient) -> str:
    """An emulated PD42-1241 beside the demo's chips: the address of its device."""
    answer = await client.post("devices", json={"name": "Motor", "model": "pd42-1241", "link": {"kind": "emulator"}})
    assert answer.status_code == 201, answer.text
    assert answer.json()["state"] == "connected"
    return "devices/motor"


@pytest.fixture
def far_line(tmp_path: Path) -> Iterator[str]:
    """A serial line at 115200 baud with emulated modules at address 1 and 2, on the wall clock: its port."""
    clock, port = WallClock(), tmp_path / "tty"
    modules = [EmulatedModule("pd42-1241", clock, TmclOptions(address=address, baud_code=7)) for address in (1, 2)]
    with LineServer(Line(modules, clock, baud=115_200, addresses=(1, 2)), [PtyEnd(port)]) as server:
        serving = threading.Thread(target=server.run)
        serving.start()
        yield str(port)
        server.stop()
        serving.join()


@pytest.fixture
async def pages(app: FastAPI) -> AsyncIterator[httpx.AsyncClient]:
    """The same server from its root: what a browser asks."""
    transport = httpx.ASGITransport(app, raise_app_exceptions=False)
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000") as client:
        yield client
