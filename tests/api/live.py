"""A real server in the test's own loop: the one that `stepscope serve` runs, on a free port."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from app.listening import listen
from app.main import create_app
from app.serving import BenchServer
from app.settings import Settings


@asynccontextmanager
async def live_server(data_dir: Path, send_buffer_bytes: int = 0, **changes: object) -> AsyncIterator[str]:
    """`http://127.0.0.1:port` while the block runs; `send_buffer_bytes` makes the kernel keep less than it likes."""
    settings = Settings.model_validate({"data_dir": data_dir, "web_dir": data_dir / "no-web", "port": 0, **changes})
    listener = listen(settings.host, settings.port)
    if send_buffer_bytes:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, send_buffer_bytes)
    ready = asyncio.Event()
    server = BenchServer(create_app(settings), settings, on_ready=ready.set)
    running = asyncio.create_task(server.serve(sockets=[listener]))
    await ready.wait()
    try:
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"
    finally:
        server.should_exit = True
        await running
