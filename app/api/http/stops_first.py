"""Holds back what is done in the background while a stop is under way."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import AbstractContextManager

from starlette.types import ASGIApp, Receive, Scope, Send

STOP = re.compile(r"/api/v1/(devices/[^/]+/axes/[^/]+/)?stop")
"""Where motors are stopped."""


def is_stop(method: str, path: str) -> bool:
    """Whether that request stops motors."""
    return method == "POST" and STOP.fullmatch(path) is not None


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
