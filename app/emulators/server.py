"""An emulated device on a TCP port: raw 4-byte frames both ways, nothing around them.

A client sends four bytes and gets four back, or none while the device is silent; the device hears one
frame at a time however many clients there are. A client that leaves half a frame lying loses it after
`HALF_FRAME_S`, so that the next four bytes are a frame again. While nobody asks, the server keeps the
device up to date, so that the first question after hours is answered at once.
"""

from __future__ import annotations

import asyncio
import contextlib
import socket

from app.emulators.device import EmulatedDevice
from app.links.datagram32 import FRAME_BYTES

HALF_FRAME_S = 0.5
_KEEP_UP_EVERY_S = 0.5
_KEEP_UP_SLICE_S = 1.0
"""Chip time computed in one go: some 10 ms at worst."""
_keepers: set[asyncio.Task[None]] = set()
"""The event loop holds its tasks only weakly."""


async def serve_tcp(device: EmulatedDevice, host: str, port: int, half_frame_s: float = HALF_FRAME_S) -> asyncio.Server:
    """Serve `device` on `host`:`port` (0 picks a free one). Closing the server is the caller's.

    `half_frame_s` is how long the rest of a frame may take [s]. An unplugged device hangs up.
    """

    async def client(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        connection: socket.socket = writer.get_extra_info("socket")
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            await _answer(device, reader, writer, half_frame_s)
        except (ConnectionError, asyncio.IncompleteReadError):
            pass  # the client left, or the device was unplugged: either way this line is dead
        finally:
            writer.close()
            with contextlib.suppress(ConnectionError):
                await writer.wait_closed()

    server = await asyncio.start_server(client, host, port)
    keeper = asyncio.create_task(_keep_up(device, server))
    _keepers.add(keeper)
    keeper.add_done_callback(_keepers.discard)
    return server


async def _keep_up(device: EmulatedDevice, server: asyncio.Server) -> None:
    """Until the server closes, let the device never fall far behind its clock."""
    while server.is_serving():
        up_to_date = device.catch_up(_KEEP_UP_SLICE_S)
        await asyncio.sleep(_KEEP_UP_EVERY_S if up_to_date else 0)


async def _answer(
    device: EmulatedDevice, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, half_frame_s: float
) -> None:
    """Answer frames until the client leaves. Raises ConnectionError or IncompleteReadError at the end."""
    while True:
        frame = await reader.readexactly(1)
        try:
            async with asyncio.timeout(half_frame_s):
                while len(frame) < FRAME_BYTES:
                    more = await reader.read(FRAME_BYTES - len(frame))
                    if not more:
                        raise asyncio.IncompleteReadError(frame, FRAME_BYTES)
                    frame += more
        except TimeoutError:
            continue
        try:
            # No thread and no lock: an exchange takes microseconds and nothing else runs meanwhile.
            reply = device.exchange(frame)
        except TimeoutError:
            continue
        writer.write(reply)
        await writer.drain()
