"""Where the lease is enforced: the one place that every request which may change something passes.

Whatever is not known to be free needs the bench, also addresses that are added later: forgetting one cannot open
it. Routes declare what is free (`policy`): what stops a motor, what only calculates or looks although it is asked by
POST, what keeps or shows data and moves nothing, and the lease itself.
"""

from __future__ import annotations

from starlette.routing import Match
from starlette.types import ASGIApp, Receive, Scope, Send

from ...devices.core.actor import actor
from ...errors import WrongState
from ...lease.calls import CallsUnderWay
from ...lease.lease import Lease
from .policies import Policies
from .problems import error_answer


class LeaseGate:
    """ASGI middleware: 409 for a change by one who has not got the bench. `actor` is set already."""

    def __init__(self, app: ASGIApp, lease: Lease, calls: CallsUnderWay, policies: Policies) -> None:
        self._app = app
        self._lease = lease
        self._calls = calls
        self._policies = policies

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        session = actor.get().session
        if session is not None:
            self._lease.seen(session)
        if self._policies.needs_no_lease(scope["method"], scope["path"], scope["query_string"]):
            await self._app(scope, receive, send)
            return
        try:
            self._lease.require(session)
        except WrongState as error:
            if not _is_a_call(scope):
                await self._app(scope, receive, send)  # to be told that there is no such call, whoever has the bench
                return
            await error_answer(error, scope["path"])(scope, receive, send)
            return
        call = self._calls.begin()
        try:
            await self._app(scope, receive, send)
        finally:
            self._calls.end(call)


def _is_a_call(scope: Scope) -> bool:
    """Whether the program has a route for it: this address by this method."""
    return any(route.matches(scope)[0] is Match.FULL for route in scope["app"].routes)
