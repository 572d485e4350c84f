"""Every open WebSocket: how many there are, whose they are, and their end when who opened them may not be here."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from typing import Any, cast

from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect

from .identity import Identity, identity_of

ENDED = 4401
"""Close code: who opened this socket has logged out, or the token was revoked."""


async def accepted(socket: WebSocket, subprotocol: str) -> bool:
    """Accept a socket whose client offers this subprotocol or none; else close it."""
    offered = socket.scope.get("subprotocols", [])
    if offered and subprotocol not in offered:
        await socket.close(1002, f"this server speaks {subprotocol}")
        return False
    await socket.accept(subprotocol if offered else None)
    return True


async def until_one_ends(*sides: Coroutine[Any, Any, None], name: str) -> None:
    """Serve a socket both ways until one way ends, or the client has gone. Raises what ended it otherwise."""
    tasks = [asyncio.create_task(side, name=name) for side in sides]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        ends = await asyncio.gather(*tasks, return_exceptions=True)
    for end in ends:
        if isinstance(end, Exception) and not isinstance(end, WebSocketDisconnect):
            raise end


@dataclass(eq=False, slots=True)
class _Open:
    identity: Identity
    end: asyncio.Event
    cut: bool = False
    """Whether something was to be sent after the end, and was not: then whoever served it has ended for that."""


class Sockets:
    """The open WebSockets of one server."""

    def __init__(self) -> None:
        self._open: set[_Open] = set()

    @property
    def open(self) -> int:
        """How many there are."""
        return len(self._open)

    def end(self, whose: Callable[[Identity], bool]) -> None:
        """Close those of whom `whose` says so."""
        for each in self._open:
            if whose(each.identity):
                each.end.set()

    def middleware(self, app: ASGIApp) -> ASGIApp:
        """ASGI middleware that keeps them. The identity is known already."""

        async def kept(scope: Scope, receive: Receive, send: Send) -> None:
            if scope["type"] != "websocket":
                await app(scope, receive, send)
                return
            socket = _Open(identity_of(scope), asyncio.Event())
            self._open.add(socket)
            work = cast("Coroutine[Any, Any, None]", app(scope, receive, _only_until(socket, send)))
            serving = asyncio.create_task(work, name=f"socket {scope['path']}")
            ending = asyncio.create_task(socket.end.wait(), name="end of a socket")
            try:
                await asyncio.wait({serving, ending}, return_when=asyncio.FIRST_COMPLETED)
                if socket.cut or not serving.done():
                    await send({"type": "websocket.close", "code": ENDED, "reason": "logged out, or revoked"})
            finally:
                self._open.discard(socket)
                ending.cancel()
                serving.cancel()
                await asyncio.wait({serving, ending})
            if not serving.cancelled():
                serving.result()  # what it raised is the server's to know

        return kept


def _only_until(socket: _Open, send: Send) -> Send:
    async def send_on(message: Message) -> None:
        if socket.end.is_set():
            socket.cut = True
            raise OSError("the socket is closed")  # as of one whose peer has gone
        await send(message)

    return send_on
