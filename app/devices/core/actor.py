"""Who is behind what happens: a page, a script, or stepscope itself.

It stands below everything that wants to know, so that a driver can tell of a register write who asked for it. A task
that is started inside a request inherits it: a procedure's writes are those of whoever began the procedure.
"""

from __future__ import annotations

from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Literal

ActorKind = Literal["browser", "client", "server"]


@dataclass(frozen=True, slots=True)
class Actor:
    """One who may change something."""

    name: str
    """As people know it: the token's name; without one that of the lease, or what a request says of itself, which
    proves nothing."""
    kind: ActorKind
    session: str | None = field(repr=False)
    """The random id of the tab or client. A secret: who knows it holds its lease. It belongs in no log and no answer;
    None for a call that borrows the bench."""
    address: str
    """Where the request came from, without the port; empty for what the server does itself."""
    token: str = ""
    """The name of the token that let it in, which is proven; empty where it came in without a name."""


STEPSCOPE = Actor("stepscope", "server", None, "")
"""The server itself: what it does at its start, at its end, and when a writer has vanished."""

actor: ContextVar[Actor] = ContextVar("actor", default=STEPSCOPE)
"""Who asked for what this task does."""
