"""The page while the program behind it is still being imported, which is most of what a start takes.

A browser fetches and runs its script for a second or so. Here it gets that script at once, and its calls wait until
the program is there, instead of being refused.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import AsyncExitStack, suppress
from typing import TYPE_CHECKING

from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocketClose

from .api.http.guard import Guard, is_loopback
from .api.http.page import BuiltFiles, WebUi
from .api.http.problem_document import Kind, problem_answer
from .settings import Settings

if TYPE_CHECKING:  # it takes 0.2 s to import, and is part of what the page does not wait for
    from fastapi import FastAPI

STARTED_WITHIN_S = 60.0
"""How long a call may wait for the program [s]; a start from an SD card without byte code takes 20 s."""
STARTING = Kind(503, "/problems/starting", "The server is still starting", "try again in a few seconds")


class PageFirst:
    """ASGI application: the page's own files from the first moment on, all else by what `make` returns.

    make : imports and builds the program; called in a thread, since it keeps a core for two seconds
    over : called when the lifespan of what it made has begun, or when one of both has failed: `failure` says how

    A server that asks for a token shows nothing before it can check one.
    """

    def __init__(self, make: Callable[[], FastAPI], settings: Settings, over: Callable[[], None]) -> None:
        self.app: FastAPI | None = None
        """The program, once it is there."""
        self.failure: Exception | None = None
        self._make, self._tell = make, over
        self._over = asyncio.Event()
        self._files = BuiltFiles(settings.web_dir)
        self._page: ASGIApp | None = None
        if settings.token is None and is_loopback(settings.host):
            page = WebUi(settings.web_dir, settings.help_dir)
            self._page = Guard(page, settings.allowed_hosts, settings.body_limit_bytes, local=True)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._lifespan(receive, send)
        elif self.app is None and self._page is not None and self._is_of_the_page(scope):
            await self._page(scope, receive, send)
        else:
            await (await self._program(scope))(scope, receive, send)

    @property
    def shows_page(self) -> bool:
        """Whether a browser gets the page from the first moment on."""
        return self._page is not None

    def _is_of_the_page(self, scope: Scope) -> bool:
        """Whether it asks for a file that was built for the browser. Queries log in: that is the program's business."""
        if scope["type"] != "http" or scope["method"] not in ("GET", "HEAD") or scope["query_string"]:
            return False
        return scope["path"] == "/" or self._files.find(scope["path"]) is not None

    async def _program(self, scope: Scope) -> ASGIApp:
        if self.app is None:
            with suppress(TimeoutError):
                async with asyncio.timeout(STARTED_WITHIN_S):
                    await self._over.wait()
        if self.app is not None:
            return self.app
        if scope["type"] == "websocket":
            return WebSocketClose(1013, STARTING.title)  # "try again later"
        return problem_answer(STARTING, "it imports its modules and opens its files", scope["path"])

    async def _lifespan(self, receive: Receive, send: Send) -> None:
        """The server's: it begins to listen at once, and waits at its end until the program has ended."""
        await receive()
        async with AsyncExitStack() as running:
            starting = asyncio.create_task(self._start(running))
            await send({"type": "lifespan.startup.complete"})
            await receive()
            await starting  # what has begun ends properly
        await send({"type": "lifespan.shutdown.complete"})

    async def _start(self, running: AsyncExitStack) -> None:
        try:
            app = await asyncio.to_thread(self._make)
            await running.enter_async_context(app.router.lifespan_context(app))
            self.app = app
        except Exception as failure:  # whoever runs the server tells of it
            self.failure = failure
        self._tell()
        self._over.set()
