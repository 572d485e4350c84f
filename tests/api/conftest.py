"""The whole program behind httpx: real drivers, real emulators, the clock of the test, no socket."""

from __future__ import annotations

from collections.abc import AsyncIterator
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from app.api.schemas import Port
from app.clock import VirtualClock, WallClock
from app.emulators.build import build_emulator
from app.emulators.server import serve_tcp
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
    return Settings(data_dir=tmp_path / "data", web_dir=web, body_limit_bytes=100_000)


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
async def pages(app: FastAPI) -> AsyncIterator[httpx.AsyncClient]:
    """The same server from its root: what a browser asks."""
    transport = httpx.ASGITransport(app, raise_app_exceptions=False)
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000") as client:
        yield client
