"""Every open WebSocket: how many there are."""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send


class Sockets:
    """The open WebSockets of one server."""

    def __init__(self) -> None:
        self._open: dict[object, str] = {}
        """The path of each."""

    @property
    def open(self) -> int:
        """How many there are."""
        return len(self._open)

    def middleware(self, app: ASGIApp) -> ASGIApp:
        """ASGI middleware that counts them."""

        async def counted(scope: Scope, receive: Receive, send: Send) -> None:
            if scope["type"] != "websocket":
                await app(scope, receive, send)
                return
            key = object()
            self._open[key] = scope["path"]
            try:
                await app(scope, receive, send)
            finally:
                del self._open[key]

        return counted
