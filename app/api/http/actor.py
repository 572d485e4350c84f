"""Whose request this is: sets `app.devices.core.actor.actor` for each one, before anything else of the API runs.

Two headers say it, both from our own page and client: `Stepscope-Session`, a random id that nobody else knows, and
`Stepscope-Name`, percent-encoded. What neither says is guessed from User-Agent. None of it is a proof of anything:
who may come in at all is the business of `access`. A named token is a proof, and its name the one that counts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from urllib.parse import unquote

from starlette.types import ASGIApp, Receive, Scope, Send

from ...devices.core.actor import Actor, ActorKind, actor
from .identity import identity_of

SESSION_HEADER = "Stepscope-Session"
NAME_HEADER = "Stepscope-Name"
NAME_MAX = 60
_SESSION, _NAME = SESSION_HEADER.lower().encode(), NAME_HEADER.lower().encode()


def plain_name(text: str) -> str:
    """A name as it may stand in a log and on a page: one line of printable characters, not too long; else empty."""
    return " ".join("".join(sign if sign.isprintable() else " " for sign in text).split())[:NAME_MAX].rstrip()


def actor_of(scope: Scope, name_of: Callable[[str], str | None]) -> Actor:
    """Who sent that request. `name_of` knows the name that a session took the bench under, if it did."""
    session = name = agent = ""
    for key, value in scope["headers"]:
        if key == _SESSION:
            session = value.decode("latin-1").strip()
        elif key == _NAME:
            name = plain_name(unquote(value.decode("latin-1")))
        elif key == b"user-agent":
            agent = value.decode("latin-1")
    stranger = _stranger(scope, agent)
    known = name_of(session) if session else None
    token = identity_of(scope).name
    return replace(stranger, name=token or known or name or stranger.name, session=session or None, token=token)


def stranger_of(scope: Scope) -> Actor:
    """Who sent that request, where nothing counts of what it says of itself but its program."""
    return _stranger(
        scope, next((value for key, value in scope["headers"] if key == b"user-agent"), b"").decode("latin-1")
    )


def _stranger(scope: Scope, agent: str) -> Actor:
    kind: ActorKind = "browser" if agent.startswith("Mozilla/") else "client"
    program = "browser" if kind == "browser" else plain_name(agent.partition(" ")[0].partition("/")[0]) or "unknown"
    address = (scope.get("client") or ("",))[0]
    return Actor(f"{program}@{address}" if address else program, kind, None, address)


class ActorMiddleware:
    """ASGI middleware: `actor` is set for each request and each socket, and for every task that they start."""

    def __init__(self, app: ASGIApp, name_of: Callable[[str], str | None]) -> None:
        self._app = app
        self._name_of = name_of

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        before = actor.set(actor_of(scope, self._name_of))
        try:
            await self._app(scope, receive, send)
        finally:
            actor.reset(before)  # a server has a task a request, a test does not
