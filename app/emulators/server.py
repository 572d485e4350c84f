"""An emulated chip on a TCP port: raw frames both ways, nothing around them.

A client sends frames of the chip's length and gets as many back, or none while the chip is silent; the chip
hears one frame at a time however many clients there are. A client that leaves half a frame lying loses it
after `HALF_FRAME_S`, so that the next bytes are a frame again. While nobody asks, the server keeps the
chip up to date, so that the first question after hours is answered at once.

A chip whose answers belong to the frame before would tell one client what another asked. Here each client
sees it as if it were alone, as through a bridge that keeps their answers apart.
"""

from __future__ import annotations

import asyncio
import contextlib
import socket
from collections.abc import Callable
from typing import Protocol

from ..links.port import Wire
from ..links.spi_datagram import frame_bytes_of, head_bytes_of

HALF_FRAME_S = 0.5
READ_BYTES = 4096
_KEEP_UP_EVERY_S = 0.5
_KEEP_UP_SLICE_S = 1.0
"""Chip time computed in one go: some 10 ms at worst."""
_keepers: set[asyncio.Task[None]] = set()
"""The event loop holds its tasks only weakly."""


class Served(Wire, Protocol):
    """An emulated chip that can be kept up to date."""

    def catch_up(self, slice_s: float) -> bool:
        """Live on by at most `slice_s` [s] of its time; True once it is up to date."""
        ...


async def serve_tcp(chip: Served, host: str, port: int, half_frame_s: float = HALF_FRAME_S) -> asyncio.Server:
    """Serve `chip` on `host`:`port` (0 picks a free one). Closing the server is the caller's.

    `half_frame_s` is how long the rest of a frame may take [s]. An unplugged chip hangs up.
    """
    head_bytes = head_bytes_of(chip.model)
    shared = Shared(chip, head_bytes) if head_bytes else None

    async def client(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        connection: socket.socket = writer.get_extra_info("socket")
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        exchange = chip.exchange if shared is None else shared.client()
        try:
            await _answer(exchange, frame_bytes_of(chip.model), reader, writer, half_frame_s)
            writer.close()
            await writer.wait_closed()
        except (ConnectionError, asyncio.CancelledError):
            pass  # the client left, the chip was unplugged, or the loop ends (asyncio would log it): this line is dead
        finally:
            writer.transport.abort()  # nothing after an orderly close; else whoever does not read would hold us up

    server = await asyncio.start_server(client, host, port)
    keeper = asyncio.create_task(_keep_up(chip, server))
    _keepers.add(keeper)
    keeper.add_done_callback(_keepers.discard)
    return server


class Shared:
    """A pipelined chip among several clients: the data that one of them is owed are kept while another asks."""

    def __init__(self, chip: Wire, head_bytes: int = 1) -> None:
        self._chip = chip
        self._head_bytes = head_bytes
        self._last: _Owed | None = None

    def client(self) -> Callable[[bytes], bytes]:
        """`exchange` of one more client. At first it gets what the chip has, like any master that is new on a bus."""
        owed = _Owed()

        def exchange(frame: bytes) -> bytes:
            reply = self._chip.exchange(frame)
            last, self._last = self._last, owed
            if last is not owed:
                if last is not None:
                    last.data = reply[self._head_bytes :]
                reply = reply[: self._head_bytes] + (owed.data or reply[self._head_bytes :])
            return reply

        return exchange


class _Owed:
    """What the chip had for a client when another one came: the data of the reply to its latest frame."""

    __slots__ = ("data",)

    def __init__(self) -> None:
        self.data = b""


async def _keep_up(chip: Served, server: asyncio.Server) -> None:
    """Until the server closes, let the chip never fall far behind its clock."""
    while server.is_serving():
        up_to_date = chip.catch_up(_KEEP_UP_SLICE_S)
        await asyncio.sleep(_KEEP_UP_EVERY_S if up_to_date else 0)


async def _answer(
    exchange: Callable[[bytes], bytes],
    size: int,
    reader: asyncio.StreamReader,
    writer: asyncio.StreamWriter,
    half_frame_s: float,
) -> None:
    """Answer frames of `size` bytes until the client leaves. Raises ConnectionError where the line breaks."""
    held = b""
    while True:
        try:
            async with asyncio.timeout(half_frame_s if held else None):
                data = await reader.read(READ_BYTES)
        except TimeoutError:
            held = b""
            continue
        if not data:
            return
        held += data
        whole = len(held) - len(held) % size
        replies = []
        for at in range(0, whole, size):
            # No thread and no lock: an exchange takes microseconds and nothing else runs meanwhile.
            with contextlib.suppress(TimeoutError):
                replies.append(exchange(held[at : at + size]))
        held = held[whole:]
        if replies:
            writer.write(b"".join(replies))
            await writer.drain()
