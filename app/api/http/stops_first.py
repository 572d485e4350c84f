"""Holds back what is done in the background while a stop is under way."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager

from starlette.types import ASGIApp, Receive, Scope, Send

from .access import is_stop


class StopsFirst:
    """ASGI middleware: a request that stops motors is `urgent` until it is answered."""

    def __init__(self, app: ASGIApp, urgent: Callable[[], AbstractContextManager[None]]) -> None:
        self._app = app
        self._urgent = urgent

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http" and is_stop(scope["method"], scope["path"]):
            with self._urgent():
                await self._app(scope, receive, send)
        else:
            await self._app(scope, receive, send)
