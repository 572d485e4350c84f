"""Sessions of browsers: a cookie each, which ends by time, by log-out, or with the token that began it."""

from __future__ import annotations

import secrets
from collections import OrderedDict
from dataclasses import dataclass

from starlette.types import Scope

from ...clock import Clock

SESSIONS_MAX = 1000
"""The oldest session ends where there are more."""
SESSION_S = 30 * 24 * 3600


@dataclass(frozen=True, slots=True)
class _Session:
    hash: str
    ends_s: float


class Sessions:
    """All of one server; they end with it."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._open: OrderedDict[str, _Session] = OrderedDict()

    def begin(self, token_hash: str) -> str:
        """Begin one by the token of that hash, and return its secret."""
        session = secrets.token_urlsafe(32)
        self._open[session] = _Session(token_hash, self._clock.now() + SESSION_S)
        while len(self._open) > SESSIONS_MAX:
            self._open.popitem(last=False)
        return session

    def token_of(self, session: str) -> str | None:
        """The hash of the token that began it; None where there is no such session any more."""
        found = self._open.get(session)
        return found.hash if found is not None and found.ends_s > self._clock.now() else None

    def of_token(self, token_hash: str) -> int:
        """How many that token has begun which have not ended."""
        now_s = self._clock.now()
        return sum(each.hash == token_hash and each.ends_s > now_s for each in self._open.values())

    def end(self, session: str) -> None:
        """Log-out."""
        self._open.pop(session, None)

    def end_of_token(self, token_hash: str) -> None:
        """Its token is revoked."""
        for session in [name for name, each in self._open.items() if each.hash == token_hash]:
            del self._open[session]


def cookie_name(scope: Scope) -> str:
    """What the cookie of a session is called."""
    # Browsers give a cookie to every port of a machine, and there may be two benches on one.
    server = scope.get("server")
    return f"stepscope_{server[1]}" if server and server[1] else "stepscope"
