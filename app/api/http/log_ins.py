"""What the audit log is told of those who come in by a browser, and, within a bound, of wrong tokens."""

from __future__ import annotations

from collections import deque
from typing import Literal

from starlette.types import Scope

from ...clock import Clock
from ...store.audit import AuditLog
from .actor import actor_of, stranger_of
from .identity import OWN, identity_of

REFUSED_MAX, REFUSED_S = 10, 3600.0
"""So many wrong tokens are entered in so long [s], whoever said them: guesses push nothing out of the log."""


class LogIns:
    """Enters them. What is beyond the bound is counted, and told with the next entry."""

    def __init__(self, audit: AuditLog, clock: Clock) -> None:
        self._audit, self._clock = audit, clock
        self._entered: deque[float] = deque(maxlen=REFUSED_MAX)
        """When those were that are entered [s]."""
        self._left_out = 0

    def done(self, scope: Scope) -> None:
        """A session has begun; who it is of is known."""
        own = "with the server's own token" if identity_of(scope) == OWN else ""
        self._audit.note("log in", detail=self._with_left_out(own), by=actor_of(scope, lambda _: None))

    def refused(self, scope: Scope, action: Literal["log in", "use token"]) -> None:
        """A wrong token was said."""
        now_s = self._clock.now()
        if len(self._entered) == REFUSED_MAX and now_s < self._entered[0] + REFUSED_S:
            self._left_out += 1
            return
        self._entered.append(now_s)
        outcome, detail = "refused: the token is wrong, or revoked", self._with_left_out("")
        self._audit.note(action, outcome=outcome, detail=detail, by=stranger_of(scope))

    def _with_left_out(self, detail: str) -> str:
        count, self._left_out = self._left_out, 0
        return "; ".join(filter(None, (detail, f"{count:,} wrong tokens before it are not entered" if count else "")))
