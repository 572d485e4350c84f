"""What each role may do: the one place that every request passes, whichever credential it came in with.

look: whatever changes nothing: GET, the sockets of telemetry and conditions, calculators and comparisons; and stops.
drive: everything but tokens. administer: all. What nobody has thought of needs `drive`, also addresses that somebody
adds later: forgetting one cannot open it. Stopping needs nothing but to be in.
"""

from __future__ import annotations

import re

from starlette.types import ASGIApp, Receive, Scope, Send

from ...errors import WrongState
from ...store.tokens import Role
from .identity import identity_of
from .lease_gate import CHANGING_METHODS, STOPS, template
from .problems import error_answer

LOOKS = STOPS | {
    ("POST", "/access/log-out"),
    ("POST", "/calc/{subject}"),
    ("POST", "/recordings/compare"),
    ("POST", "/profiles/compare"),
}
"""What changes nothing although it is asked by POST, what stops a motor, and the way out."""
LOOKING_SOCKETS = frozenset({"/devices/{device}/telemetry", "/conditions"})
ADMINISTERS = frozenset({("GET", "/tokens"), ("POST", "/tokens"), ("DELETE", "/tokens/{name}")})


class Policy:
    """Which role a call needs, of the API under the address `base`."""

    def __init__(self, base: str) -> None:
        def any_of(calls: frozenset[tuple[str, str]]) -> re.Pattern[str]:
            return re.compile("|".join(f"{method} {re.escape(base)}{template(path)}" for method, path in sorted(calls)))

        self._looks, self._administers = any_of(LOOKS), any_of(ADMINISTERS)
        self._sockets = re.compile("|".join(re.escape(base) + template(path) for path in sorted(LOOKING_SOCKETS)))
        self._tokens = f"{base}/tokens"

    def needs(self, method: str, path: str) -> Role:
        """The least role for that call."""
        call = f"{method} {path}"
        if self._administers.fullmatch(call) or path.startswith(self._tokens):
            return "administer"
        changes = method in CHANGING_METHODS and not self._looks.fullmatch(call)
        return "drive" if changes else "look"

    def needs_of_socket(self, path: str) -> Role:
        """The least role for that WebSocket."""
        return "look" if self._sockets.fullmatch(path) else "drive"


class RoleGate:
    """ASGI middleware: 403 for what is beyond the role of who asks. The identity is known already."""

    def __init__(self, app: ASGIApp, policy: Policy) -> None:
        self._app = app
        self._policy = policy

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] in ("http", "websocket"):
            path = scope["path"]
            if scope["type"] == "http":
                needed, what = self._policy.needs(scope["method"], path), f"{scope['method']} {path}"
            else:
                needed, what = self._policy.needs_of_socket(path), f"the socket {path}"
            try:
                identity_of(scope).require(needed, what)
            except WrongState as error:
                await error_answer(error, path)(scope, receive, send)
                return
        await self._app(scope, receive, send)
