"""Having the bench for a while: `with bench.lease("tuning"):` for both clients.

The server gives it to one session at a time and expects a sign every few seconds. A script that dies gives none: the
server then does with its motors what it is set to (`on_vanish`).
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import secrets
import threading
import time
from collections.abc import Awaitable, Callable, MutableMapping
from types import TracebackType
from typing import Any, Literal, Self
from urllib.parse import quote

from . import calls
from .calls import Call
from .errors import BenchTaken, ClientError, Refused

SESSION_HEADER, NAME_HEADER = "Stepscope-Session", "Stepscope-Name"
SESSION_VARIABLE = "STEPSCOPE_SESSION"
"""What `stepscope lease run` gives to the program that it runs: all of it has the same lease."""
KEEP_EVERY_S = 5.0
ASK_EVERY_S = 1.0

OnVanish = Literal["nothing", "stop", "hold"]


def session_headers() -> dict[str, str]:
    """What a client sends that was started under a lease."""
    session = os.environ.get(SESSION_VARIABLE)
    return {SESSION_HEADER: session} if session else {}


class _Headers:
    """The session in the headers of a client, while it has one."""

    def __init__(self, headers: MutableMapping[str, str], name: str) -> None:
        self._headers = headers
        self._name = name
        self.outer = SESSION_HEADER in headers
        """Whether there is a lease around this one, which keeps it and gives it back."""

    def set(self) -> None:
        if not self.outer:
            self._headers[SESSION_HEADER] = secrets.token_urlsafe(24)
            self._headers[NAME_HEADER] = quote(self._name)

    def clear(self) -> None:
        if not self.outer:
            self._headers.pop(SESSION_HEADER, None)
            self._headers.pop(NAME_HEADER, None)


class Lease:
    """The bench, from `with` on until its end. Raises BenchTaken there when it is not free within `wait_s` [s]."""

    def __init__(
        self,
        send: Callable[[Call[Any]], Any],
        headers: MutableMapping[str, str],
        name: str,
        wait_s: float,
        on_vanish: OnVanish | None,
    ) -> None:
        self._send = send
        self.headers = headers
        """What the client sends with every call: within the `with`, the session."""
        self._session: _Headers | None = None
        self._name, self._wait_s, self._on_vanish = name, wait_s, on_vanish
        self._ended = threading.Event()
        self._beat: threading.Thread | None = None
        self.lost: Refused | None = None
        """Why the lease has ended before its `with`, if it has: every change is refused from then on."""

    def __enter__(self) -> Self:
        self._session = _Headers(self.headers, self._name)
        if self._session.outer:
            self._send(calls.lease_keep())
            return self
        self._session.set()
        try:
            self._take()
        except BaseException:
            with contextlib.suppress(ClientError):
                self._send(calls.lease_give_back())  # also the question, if one was asked
            self._session.clear()
            raise
        self._ended.clear()
        self._beat = threading.Thread(target=self._keep, name="stepscope lease", daemon=True)
        self._beat.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if self._session is None or self._session.outer:
            return
        self._ended.set()
        if self._beat is not None:
            self._beat.join()
        with contextlib.suppress(ClientError):  # a server that is gone frees it by itself
            self._send(calls.lease_give_back())
        self._session.clear()

    def _take(self) -> None:
        until_s = time.monotonic() + self._wait_s
        while True:
            try:
                self._send(calls.lease_take(self._name))
                break
            except BenchTaken:
                left_s = until_s - time.monotonic()
                if left_s <= 0:
                    raise
            with contextlib.suppress(Refused):  # handed over between both calls: it has nothing to ask
                self._send(calls.lease_ask(self._name))
            time.sleep(min(ASK_EVERY_S, left_s))
        if self._on_vanish is not None:
            self._send(calls.lease_keep(self._on_vanish))

    def _keep(self) -> None:
        while not self._ended.wait(KEEP_EVERY_S):
            try:
                self._send(calls.lease_keep())
            except Refused as error:
                self.lost = error
                return
            except ClientError:
                continue  # no answer this time; the next may come through before the lease ends


class AsyncLease:
    """The bench, from `async with` on until its end. Raises BenchTaken when it is not free within `wait_s` [s]."""

    def __init__(
        self,
        send: Callable[[Call[Any]], Awaitable[Any]],
        headers: MutableMapping[str, str],
        name: str,
        wait_s: float,
        on_vanish: OnVanish | None,
    ) -> None:
        self._send = send
        self.headers = headers
        """What the client sends with every call: within the `with`, the session."""
        self._session: _Headers | None = None
        self._name, self._wait_s, self._on_vanish = name, wait_s, on_vanish
        self._beat: asyncio.Task[None] | None = None
        self.lost: Refused | None = None
        """Why the lease has ended before its `async with`, if it has: every change is refused from then on."""

    async def __aenter__(self) -> Self:
        self._session = _Headers(self.headers, self._name)
        if self._session.outer:
            await self._send(calls.lease_keep())
            return self
        self._session.set()
        try:
            await self._take()
        except BaseException:
            with contextlib.suppress(ClientError):
                await self._send(calls.lease_give_back())  # also the question, if one was asked
            self._session.clear()
            raise
        self._beat = asyncio.create_task(self._keep(), name="stepscope lease")
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None
    ) -> None:
        if self._session is None or self._session.outer:
            return
        if self._beat is not None:
            self._beat.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._beat
        with contextlib.suppress(ClientError):  # a server that is gone frees it by itself
            await self._send(calls.lease_give_back())
        self._session.clear()

    async def _take(self) -> None:
        until_s = time.monotonic() + self._wait_s
        while True:
            try:
                await self._send(calls.lease_take(self._name))
                break
            except BenchTaken:
                left_s = until_s - time.monotonic()
                if left_s <= 0:
                    raise
            with contextlib.suppress(Refused):  # handed over between both calls: it has nothing to ask
                await self._send(calls.lease_ask(self._name))
            await asyncio.sleep(min(ASK_EVERY_S, left_s))
        if self._on_vanish is not None:
            await self._send(calls.lease_keep(self._on_vanish))

    async def _keep(self) -> None:
        while True:
            await asyncio.sleep(KEEP_EVERY_S)
            try:
                await self._send(calls.lease_keep())
            except Refused as error:
                self.lost = error
                return
            except ClientError:
                continue  # no answer this time; the next may come through before the lease ends
