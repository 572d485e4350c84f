"""A real TCP server on the loopback that misbehaves on request: what an emulator never does on its own."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

Behaviour = Callable[[bytes, asyncio.StreamWriter], Awaitable[None]]
"""Takes one frame and answers it, or not."""


async def echo(frame: bytes, writer: asyncio.StreamWriter) -> None:
    writer.write(frame)


class Server:
    """`behave` may be changed at any time; `connections` counts those ever made, `ended` those that are over."""

    def __init__(self, behave: Behaviour, frame_bytes: int) -> None:
        self.behave = behave
        self.frame_bytes = frame_bytes
        self.connections = self.ended = 0
        self.writers: list[asyncio.StreamWriter] = []
        self.port = 0

    async def serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.connections += 1
        self.writers.append(writer)
        with contextlib.suppress(ConnectionError, asyncio.IncompleteReadError):
            while True:
                frame = await reader.readexactly(self.frame_bytes)
                await self.behave(frame, writer)
        self.ended += 1
        writer.close()


@asynccontextmanager
async def serving(behave: Behaviour = echo, frame_bytes: int = 4) -> AsyncIterator[Server]:
    server = Server(behave, frame_bytes)
    listener = await asyncio.start_server(server.serve, "127.0.0.1", 0)
    server.port = listener.sockets[0].getsockname()[1]
    try:
        yield server
    finally:
        listener.close()
        for writer in server.writers:
            writer.transport.abort()
        await listener.wait_closed()
