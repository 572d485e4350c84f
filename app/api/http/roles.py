"""What each role may do: the one place that every request passes, whichever credential it came in with.

look: whatever changes nothing: GET, the sockets of telemetry and conditions, calculators and comparisons; and stops.
drive: everything but tokens. administer: all. Routes declare which they need (`policy`); what nobody has thought of
needs `drive`, also addresses that are added later: forgetting one cannot open it. Stopping needs nothing but to be
in.
"""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send

from ...errors import WrongState
from .identity import identity_of
from .policies import Policies
from .problems import error_answer


class RoleGate:
    """ASGI middleware: 403 for what is beyond the role of who asks. The identity is known already."""

    def __init__(self, app: ASGIApp, policies: Policies) -> None:
        self._app = app
        self._policies = policies

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] in ("http", "websocket"):
            path = scope["path"]
            if scope["type"] == "http":
                needed, what = self._policies.role(scope["method"], path), f"{scope['method']} {path}"
            else:
                needed, what = self._policies.role_of_socket(path), f"the socket {path}"
            try:
                identity_of(scope).require(needed, what)
            except WrongState as error:
                await error_answer(error, path)(scope, receive, send)
                return
        await self._app(scope, receive, send)
