"""What stands before every request: is it from our own pages or from a script, and is it short enough.

A motor must not move because some web page elsewhere posted to 127.0.0.1. Browsers say where a
request comes from (Origin, Sec-Fetch-Site); scripts say nothing and are let through. A page that
points its own DNS name at this machine (rebinding) looks same-origin, but bears that name in Host:
so Host must be an address, a name that public DNS cannot give, or one that the settings allow. In a network anybody
may give out names without a dot, and under .local: a server that only its own machine can reach takes none but those
of this machine.

A GET changes nothing, so any page may send one, and the browser keeps the answer from it. Those few that do change
something (reading clears a register) ask `require_own_page`.
"""

from __future__ import annotations

import ipaddress
import re
from functools import lru_cache

from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from .errors import ForeignPage
from .problem_document import FOREIGN, TOO_LARGE, problem_answer

SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


def host_name(authority: str) -> str:
    """`name:port` or `[v6]:port` to the bare name."""
    if authority.startswith("["):
        return authority[1:].partition("]")[0].casefold()
    return authority.partition(":")[0].casefold().rstrip(".")


@lru_cache(maxsize=256)  # asked for every request, and nearly always the same
def host_is_ours(authority: str, allowed: frozenset[str], local: bool = False) -> bool:
    """Whether a browser under that Host can only mean this server; `local` if only its own machine reaches it."""
    name = host_name(authority)
    if not name:
        return False
    if local:
        return name in allowed or name == "localhost" or name.endswith(".localhost") or is_loopback(name)
    if "." not in name or name in allowed or name.endswith((".localhost", ".local")):
        return True  # no dot: localhost, a container, a machine in this network; never from public DNS
    return is_address(name)


def is_loopback(host: str) -> bool:
    """Whether a server that listens there can only be reached from its own machine."""
    if host.casefold() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False  # a name may mean anything, and "" is every address


def is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def origin_is_ours(origin: str, authority: str, allowed: frozenset[str]) -> bool:
    """Whether the page behind `origin` was served under the Host that it talks to (or an allowed name)."""
    scheme, _, page = origin.partition("://")
    if scheme not in ("http", "https"):
        return False  # "null" of sandboxed frames and files among them
    return page.casefold() == authority.casefold() or host_name(page) in allowed


_FILES = re.compile(r"/api/v1/recordings/[^/]+/added")
"""Where whole files of instruments come in."""
_FOREIGN_PAGE = "stepscope.foreign_page"


def require_own_page(scope: Scope) -> None:
    """Raises ForeignPage where another web site's page sent this request, although it is a GET."""
    finding = scope.get(_FOREIGN_PAGE, "")
    if finding:
        raise ForeignPage(finding)


class Guard:
    """ASGI middleware: 403 for foreign pages, 413 for long bodies; files of instruments may have `file_bytes_max`.

    `local`: as in `host_is_ours`; None is for those connections that came to an address of this machine alone.
    """

    def __init__(
        self,
        app: ASGIApp,
        allowed_hosts: tuple[str, ...],
        body_limit_bytes: int,
        *,
        local: bool | None = None,
        file_bytes_max: int = 0,
    ) -> None:
        self._app = app
        self._local = local
        self._allowed = frozenset(allowed_hosts)
        self._limit, self._file_limit = body_limit_bytes, max(body_limit_bytes, file_bytes_max)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        host = origin = site = length = ""
        for key, value in scope["headers"]:
            if key == b"host":
                host = value.decode("latin-1")
            elif key == b"origin":
                origin = value.decode("latin-1")
            elif key == b"sec-fetch-site":
                site = value.decode("latin-1")
            elif key == b"content-length":
                length = value.decode("latin-1")
        finding = self._foreign_host(scope, host)
        if not finding:
            finding = self._foreign_page(host, origin, site)
            if finding and scope["type"] == "http" and scope["method"] in SAFE_METHODS:
                scope[_FOREIGN_PAGE], finding = finding, ""
        if finding:
            await problem_answer(FOREIGN, finding, scope["path"])(scope, receive, send)
            return
        if scope["type"] == "http" and scope["method"] not in SAFE_METHODS:
            limit = self._file_limit if _FILES.fullmatch(scope["path"]) else self._limit
            if length.isdecimal() and int(length[:20]) > limit:
                detail = f"{length} bytes, at most {limit} are read"
                await problem_answer(TOO_LARGE, detail, scope["path"], connection="close")(scope, receive, send)
                return
            receive = _Counted(receive, limit)
        await self._app(scope, receive, send)

    def _foreign_host(self, scope: Scope, host: str) -> str:
        local = is_loopback((scope.get("server") or ("",))[0]) if self._local is None else self._local
        if host_is_ours(host, self._allowed, local):
            return ""
        here = "; only localhost is, since it listens to its own machine" if local else ""
        return f"Host {host!r} is not a name of this server{here}; STEPSCOPE_ALLOWED_HOSTS can make it one"

    def _foreign_page(self, host: str, origin: str, site: str) -> str:
        if origin:
            ours = origin_is_ours(origin, host, self._allowed)
            return "" if ours else f"a page of {origin} may not use the bench at {host}"
        if site and site not in ("same-origin", "none"):
            return f"a {site} page may not use the bench at {host}"
        return ""


class _Counted:
    """A body without a declared length, cut off where it gets too long."""

    def __init__(self, receive: Receive, limit_bytes: int) -> None:
        self._receive = receive
        self._left = limit_bytes

    async def __call__(self) -> Message:
        message = await self._receive()
        if message["type"] == "http.request":
            self._left -= len(message.get("body", b""))
            if self._left < 0:
                raise HTTPException(TOO_LARGE.status, "the body is longer than this server reads")
        return message
