"""A chip behind a TCP socket: raw frames both ways, each answered by one as long (docs/tcp-link.md).

The wire has no sequence numbers, so an answer that comes late looks like the answer to the next
question. Hence one rule: after anything unexpected (no answer, half an answer, a byte nobody asked
for) the connection is closed, and the next exchange starts a new one.
"""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from typing import cast

from ..clock import Clock, WallClock
from ..errors import BadReply, LinkDown, LinkTimeout
from .datagram32 import FRAME_BYTES
from .port import PortTraits

TIMEOUT_S = 1.0
CONNECT_TIMEOUT_S = 3.0


class TcpPort:
    """`ChainPort` over one TCP connection, opened when it is first needed.

    `timeout_s` [s] bounds the wait for an answer, `connect_timeout_s` [s] that for a connection. `frame_bytes` is
    the length of a frame; with `pipelined` chains stay together, and cost one round trip.
    """

    def __init__(
        self,
        host: str,
        port: int,
        timeout_s: float = TIMEOUT_S,
        connect_timeout_s: float = CONNECT_TIMEOUT_S,
        clock: Clock | None = None,
        *,
        frame_bytes: int = FRAME_BYTES,
        pipelined: bool = False,
    ) -> None:
        self.host = host
        self.port = port
        self.frame_bytes = frame_bytes
        self.traits = PortTraits(chains=self if pipelined else None)
        self.timeout_s = timeout_s
        self.connect_timeout_s = connect_timeout_s
        self.connections = 0
        self._closings = 0
        self._clock = clock or WallClock()
        self._last_exchange_s = self._clock.now()
        self._stream: _Stream | None = None

    @property
    def name(self) -> str:
        return f"tcp {self.host}:{self.port}"

    @property
    def last_exchange_s(self) -> float:
        return self._last_exchange_s

    def device_time_s(self) -> float:
        return self._clock.now()

    async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
        """Send a frame, return one. Raises ValueError for another length, else as `FramePort` says."""
        return (await self.exchange_chain((frame,), timeout_s))[0]

    async def exchange_chain(self, frames: Sequence[bytes], timeout_s: float | None = None) -> list[bytes]:
        """As `ChainPort` says: all frames go out at once, and all replies have to be there in `timeout_s` [s]."""
        size = self.frame_bytes
        for frame in frames:
            if len(frame) != size:
                raise ValueError(f"a datagram has {size} bytes, not {len(frame)}")
        if not frames:
            return []
        stream = self._stream
        if stream is None or not stream.trusted:
            stream = await self._open()
        wait_s = self.timeout_s if timeout_s is None else timeout_s
        due = size * len(frames)
        sent_s = self._clock.now()
        try:
            replies = await stream.ask(b"".join(frames), due, wait_s)
        except BaseException:  # a cancelled caller too: the answer it left behind belongs to nobody
            self._drop()
            raise
        if len(replies) != due:
            closed = stream.closed
            self._drop()
            if len(replies) % size or len(replies) > due:
                raise BadReply(self.name, f"{len(replies)} bytes instead of {due}", replies)
            if closed is not None:
                raise LinkDown(self.name, closed)
            raise LinkTimeout(self.name, wait_s, f"frame {frames[len(replies) // size].hex(' ')}")
        self._last_exchange_s = (sent_s + self._clock.now()) / 2
        return [replies[at : at + size] for at in range(0, due, size)]

    async def aclose(self) -> None:
        self._closings += 1
        self._drop()

    def _drop(self) -> None:
        stream, self._stream = self._stream, None
        if stream is not None:
            stream.abort()

    async def _open(self) -> _Stream:
        self._drop()
        loop, closings = asyncio.get_running_loop(), self._closings
        try:
            async with asyncio.timeout(self.connect_timeout_s):
                _, stream = await loop.create_connection(lambda: _Stream(loop), self.host, self.port)
        except TimeoutError as error:
            raise LinkDown(self.name, f"no connection in {self.connect_timeout_s:g} s") from error
        except OSError as error:  # refused, unreachable, unknown host
            raise LinkDown(self.name, error.strerror or str(error)) from error
        except ValueError as error:  # a host that no name server could be asked for: too long a label, a NUL
            raise LinkDown(self.name, f"no host can be called that: {error}") from error
        if self._closings != closings:
            stream.abort()
            raise LinkDown(self.name, "closed while it was opened")
        self._stream = stream
        self.connections += 1
        return stream


class _Stream(asyncio.Protocol):
    """One connection. A `Protocol` and not a `StreamReader`, because it must see bytes that nobody asked for."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self.closed: str | None = None
        self.trusted = True
        self._loop = loop
        self._received = b""
        self._due = 0
        self._answer: asyncio.Future[None] | None = None
        self._transport: asyncio.Transport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        # No isinstance: uvloop's transports, which uvicorn takes where it finds them, only look like asyncio's. Both
        # loops send small packets at once (TCP_NODELAY) without being told.
        self._transport = cast("asyncio.Transport", transport)

    def data_received(self, data: bytes) -> None:
        if self._answer is None:
            self.abort()  # and not only mistrusted: what talks on and on would have to be read unbounded
            return
        self._received += data
        if len(self._received) >= self._due and not self._answer.done():
            self._answer.set_result(None)

    def eof_received(self) -> None:
        self._end("closed by the other side")

    def connection_lost(self, error: Exception | None) -> None:
        self._end(str(error) if error else "closed by the other side")

    def _end(self, why: str) -> None:
        self.trusted = False
        self.closed = self.closed or why
        if self._answer is not None and not self._answer.done():
            self._answer.set_result(None)

    async def ask(self, data: bytes, due: int, timeout_s: float) -> bytes:
        """All bytes that came within `timeout_s` [s], or until the other side closed, or `due` bytes were there."""
        assert self._transport is not None
        self._received = b""
        self._due = due
        self._answer = self._loop.create_future()
        timer = self._loop.call_later(timeout_s, self._give_up, self._answer)
        try:
            self._transport.write(data)
            await self._answer
        finally:
            timer.cancel()
            self._answer = None
        if len(self._received) != due:
            self.trusted = False
        return self._received

    @staticmethod
    def _give_up(answer: asyncio.Future[None]) -> None:
        if not answer.done():
            answer.set_result(None)

    def abort(self) -> None:
        """Close without waiting for anything."""
        self.trusted = False
        if self._transport is not None:
            self._transport.abort()
