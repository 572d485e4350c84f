"""The end of a WebSocket whose owner may not be here any more: always told by its close code."""

from __future__ import annotations

import asyncio
import contextlib

from starlette.types import Message, Receive, Scope, Send

from app.api.http.identity import ANYBODY, identify
from app.api.http.sockets import ENDED, Sockets


async def never() -> Message:
    await asyncio.Event().wait()
    raise AssertionError


async def test_a_socket_that_sends_while_it_is_ended_is_told_why() -> None:
    sockets, sent = Sockets(), list[Message]()

    async def ended_between_two_frames(scope: Scope, receive: Receive, send: Send) -> None:
        del scope, receive
        await send({"type": "websocket.accept"})
        sockets.end(lambda who: who is ANYBODY)
        with contextlib.suppress(OSError):  # as Starlette's sockets take it: the peer has gone
            await send({"type": "websocket.send", "text": "too late"})

    async def keep(message: Message) -> None:
        sent.append(message)

    scope: Scope = {"type": "websocket", "path": "/"}
    identify(scope, ANYBODY)
    await sockets.middleware(ended_between_two_frames)(scope, never, keep)
    assert [(message["type"], message.get("code")) for message in sent] == [
        ("websocket.accept", None),
        ("websocket.close", ENDED),
    ]
    assert sockets.open == 0
