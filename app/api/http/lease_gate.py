"""Where the lease is enforced: the one place that every request which may change something passes.

Whatever is not known to be free needs the bench, also addresses that somebody adds later: forgetting one cannot open
it. Free is what stops a motor, what only calculates or looks although it is asked by POST, what keeps or shows data
and moves nothing, and the lease itself.
"""

from __future__ import annotations

import asyncio
import re
from urllib.parse import parse_qsl

from starlette.routing import Match
from starlette.types import ASGIApp, Receive, Scope, Send

from ...devices.core.actor import actor
from ...errors import WrongState
from ..lease.lease import Lease
from .problems import error_answer

AXIS = "/devices/{device}/axes/{axis}"
STOPS = frozenset(
    {
        ("POST", "/stop"),
        ("POST", f"{AXIS}/stop"),
        # Aborting a procedure is one: it ends, and its motor stops.
        ("DELETE", f"{AXIS}/reference-search"),
        ("DELETE", f"{AXIS}/shuttle"),
        ("DELETE", f"{AXIS}/closed-loop-calibration"),
        ("DELETE", f"{AXIS}/step-response"),
        ("DELETE", f"{AXIS}/disturbance"),
    }
)
"""What stops a motor, for everybody who is in."""
FREE = STOPS | frozenset(
    {
        # Who may come in moves no motor.
        ("POST", "/access/log-out"),
        ("POST", "/tokens"),
        ("DELETE", "/tokens/{name}"),
        # The lease.
        ("POST", "/lease"),
        ("PUT", "/lease"),
        ("DELETE", "/lease"),
        ("POST", "/lease/ask"),
        ("POST", "/lease/leave"),
        ("POST", "/lease/hand-over"),
        # Calculators.
        ("POST", "/calc/{subject}"),
        # Recordings touch no motor; only what cannot be undone, deleting one, needs the bench.
        ("POST", "/recordings"),
        ("PATCH", "/recordings/{recording}"),
        ("POST", "/recordings/{recording}/stop"),
        ("POST", "/recordings/{recording}/marks"),
        ("POST", "/recordings/{recording}/replay"),
        ("POST", "/recordings/compare"),
        # Saved documents, likewise.
        ("POST", "/profiles"),
        ("PATCH", "/profiles/{profile}"),
        ("POST", "/profiles/compare"),
        ("POST", "/profiles/script"),
        # A view of what happens anyway.
        ("POST", "/twin"),
        ("DELETE", "/twin"),
        ("POST", "/twin/cursor"),
    }
)
"""Method and address of what needs no lease; any other call by one of `CHANGING_METHODS` does."""
CHANGING_METHODS = frozenset({"POST", "PUT", "PATCH", "DELETE"})
"""No route has another method that changes anything: others (QUERY, TRACE) are answered that there is no such call."""
DRY_RUN = ("PUT", "/devices/{device}/profile")
"""Free only where the query says `dry_run=true`."""


class Free:
    """Which calls need no lease, of the API under the address `base`."""

    def __init__(self, base: str) -> None:
        free = (f"{method} {re.escape(base)}{template(path)}" for method, path in sorted(FREE))
        self._free = re.compile("|".join(free))
        self._dry_run = re.compile(f"{DRY_RUN[0]} {re.escape(base)}{template(DRY_RUN[1])}")

    def holds(self, method: str, path: str, query: bytes = b"") -> bool:
        """Whether that call needs none: it changes nothing that the lease is for."""
        if method not in CHANGING_METHODS:
            return True
        call = f"{method} {path}"
        if self._dry_run.fullmatch(call):
            said = [value for name, value in parse_qsl(query.decode("latin-1"), True) if name == "dry_run"]
            return bool(said) and all(value == "true" for value in said)
        return self._free.fullmatch(call) is not None


def template(path: str) -> str:
    """A pattern for the addresses of a route."""
    return "[^/]+".join(re.escape(part) for part in re.split(r"{[^}]*}", path))


class CallsUnderWay:
    """Calls that may change something and have begun: who takes the bench waits until those before are over."""

    def __init__(self) -> None:
        self._calls: set[asyncio.Future[None]] = set()

    @property
    def any(self) -> bool:
        """Whether there are such calls."""
        return bool(self._calls)

    def begin(self) -> asyncio.Future[None]:
        """One begins; `end` it."""
        call: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._calls.add(call)
        return call

    def end(self, call: asyncio.Future[None]) -> None:
        """That one is over."""
        self._calls.discard(call)
        call.set_result(None)

    async def over(self, within_s: float) -> bool:
        """Return when all that have begun by now are over, True, or after `within_s` [s], False."""
        return not self._calls or not (await asyncio.wait(set(self._calls), timeout=within_s))[1]


class LeaseGate:
    """ASGI middleware: 409 for a change by one who has not got the bench. `actor` is set already."""

    def __init__(self, app: ASGIApp, lease: Lease, calls: CallsUnderWay, free: Free) -> None:
        self._app = app
        self._lease = lease
        self._calls = calls
        self._free = free

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        session = actor.get().session
        if session is not None:
            self._lease.seen(session)
        if self._free.holds(scope["method"], scope["path"], scope["query_string"]):
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
