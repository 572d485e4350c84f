"""Who may come in: everybody on this machine's own address, and on any other who knows a token.

A server that listens to a network asks for a token, its own or a named one: as `Authorization: Bearer`, or once, at
`/?token=...` or the page `/login`, for a cookie that holds a session until the server ends. What each may do once it is
in is the business of `roles`. Guesses are told off: after a few wrong
tokens an address hears how long it should wait. The right token and a session always come in, whoever else guesses
from behind the same address, so a stop gets through; what keeps guessing hopeless is the token's length.
"""

from __future__ import annotations

import hmac
import html
import math
import secrets
from collections import OrderedDict, deque
from collections.abc import Iterable
from dataclasses import replace
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlencode

from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from ...clock import Clock
from ...store.tokens import hash_of
from ..access.tokens import Tokens
from .identity import ANYBODY, OWN, Identity, identify
from .log_ins import LogIns
from .page import HEADERS
from .problem_document import Kind, problem_answer
from .sessions import SESSION_S, Sessions, cookie_name
from .stops_first import is_stop

UNKNOWN = Kind(
    401, "/problems/token-required", "This server asks for a token", "send it as Authorization: Bearer TOKEN"
)
TOO_MANY = Kind(429, "/problems/too-many-guesses", "Too many wrong tokens from this address", "wait, then try again")
OPEN_PATHS = frozenset({"/api/v1/health"})
"""What a container's health check has to see; it tells nothing but that we run."""
LOGIN = "/login"
GUESSES, WINDOW_S = 10, 60.0
"""So many wrong tokens of one address in so long [s]."""
ADDRESSES_MAX = 10_000
FORM_BYTES_MAX = 4096

PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<meta name="color-scheme" content="light dark"><title>stepscope: token</title>
<style>body{{font:16px system-ui,sans-serif;max-width:24rem;margin:15vh auto;padding:0 1rem}}
input,button{{font:inherit;padding:.5rem;width:100%;box-sizing:border-box;margin-top:.5rem}}p{{line-height:1.5}}</style>
<h1>stepscope</h1><form method="post" action="/login"><label for="token">Token</label>
<input id="token" name="token" type="password" autocomplete="current-password" required autofocus
 aria-describedby="said"><button>Open the bench</button></form><p id="said" role="status">{said}</p>
"""
WHERE = "Your own one, or that of the server: the terminal that started it shows it."


def new_token() -> str:
    """A token that nobody guesses."""
    return secrets.token_urlsafe(24)


class Guesses:
    """How often each address was wrong lately."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._wrong: OrderedDict[str, deque[float]] = OrderedDict()

    def wait_s(self, address: str) -> float:
        """How long that address has to wait before it may try again [s]."""
        wrong = self._wrong.get(address)
        if wrong is None or len(wrong) < GUESSES:
            return 0.0
        return max(0.0, wrong[0] + WINDOW_S - self._clock.now())

    def was_wrong(self, address: str) -> None:
        """Another one."""
        wrong = self._wrong.setdefault(address, deque(maxlen=GUESSES))
        wrong.append(self._clock.now())
        self._wrong.move_to_end(address)
        while len(self._wrong) > ADDRESSES_MAX:
            self._wrong.popitem(last=False)


class Access:
    """ASGI middleware: 401 without token or session, 429 for who guesses. Who is let in is known from here on.

    `token` is the server's own one, of the role `administer`; None: nobody has to say one, and a named token or its
    session counts all the same where it is said.
    """

    def __init__(
        self, app: ASGIApp, token: str | None, tokens: Tokens, sessions: Sessions, log_ins: LogIns, clock: Clock
    ) -> None:
        self._app = app
        self._own_hash = None if token is None else hash_of(token)
        self._tokens = tokens
        self._sessions = sessions
        self._log_ins = log_ins
        self._guesses = Guesses(clock)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        if scope["path"] in OPEN_PATHS:
            identify(scope, ANYBODY)
            await self._app(scope, receive, send)
            return
        headers = [(key, value.decode("latin-1")) for key, value in scope["headers"]]
        bearer = next((value for key, value in headers if key == b"authorization"), "")
        scheme, _, said = bearer.partition(" ")
        logs_in = scope["type"] == "http" and (scope["method"], scope["path"]) == ("POST", LOGIN)
        identity = None if logs_in else self._in_session(scope, headers)
        if identity is None and scheme.casefold() == "bearer":
            identity = self._by_token(said.strip())
        if identity is None:
            refusal = await self._refusal(scope, receive, bearer)
            if refusal is not None:
                await refusal(scope, receive, send)
                return
            identity = ANYBODY
        identify(scope, identity)
        await self._app(scope, receive, send)

    async def _refusal(self, scope: Scope, receive: Receive, bearer: str) -> Response | None:
        """What one gets who is not in; None where everybody is."""
        address = (scope.get("client") or ("",))[0]
        refusal: Response | None = None
        if scope["type"] == "http":
            try:
                refusal = await self._visitor(Request(scope, receive))
            except _Wrong as wrong:
                self._log_ins.refused(scope, "log in")
                refusal = self._told_off(scope, address) or wrong.page
        if self._own_hash is None or refusal is not None:
            return refusal
        if bearer:
            self._log_ins.refused(scope, "use token")
            refusal = self._told_off(scope, address)
        if refusal is None:
            detail = "the token is wrong, or revoked" if bearer else "there is no token, and no session of a browser"
            refusal = problem_answer(UNKNOWN, detail, scope["path"], None, **{"WWW-Authenticate": "Bearer"})
        return refusal

    def _told_off(self, scope: Scope, address: str) -> Response | None:
        """That address said a wrong token: None while it may guess on."""
        wait_s = self._guesses.wait_s(address)
        if not wait_s:
            self._guesses.was_wrong(address)
            return None
        if scope["type"] == "http" and is_stop(scope["method"], scope["path"]):
            return None  # nobody who stops a motor is told to wait: the token is wrong, and that is what helps
        seconds = f"{math.ceil(wait_s)}"
        facts = {"wait_s": wait_s}
        return problem_answer(TOO_MANY, f"{seconds} s to wait", scope["path"], facts, **{"Retry-After": seconds})

    async def _visitor(self, request: Request) -> Response | None:
        """What a browser gets that is not in yet; None where it is no browser that opens a page. Raises _Wrong."""
        if request.method == "POST" and request.url.path == LOGIN:
            body = b""
            async for chunk in request.stream():
                body += chunk
                if len(body) > FORM_BYTES_MAX:
                    return _page("That is no token.", 413)
            said = parse_qs(body.decode("latin-1")).get("token", [""])[0]
            identity = self._by_token(said.strip())
            if identity is None:
                raise _Wrong(_page("Wrong token.", 401))
            return self._welcome(request, "/", identity)
        if request.method not in ("GET", "HEAD") or request.url.path.startswith("/api/"):
            return None
        query = dict(request.query_params)
        if "token" in query:
            identity = self._by_token(query.pop("token"))
            if identity is not None:
                # Another address, so that the token stands in no history and no bookmark.
                return self._welcome(request, request.url.path + (f"?{urlencode(query)}" if query else ""), identity)
            if self._own_hash is not None:
                raise _Wrong(_page("The token in the address is wrong.", 401))
        if self._own_hash is None or "text/html" not in request.headers.get("accept", ""):
            return None
        return _page(WHERE, 401)

    def _welcome(self, request: Request, path: str, identity: Identity) -> Response:
        identify(request.scope, identity)
        self._log_ins.done(request.scope)
        response = RedirectResponse("/" + path.lstrip("/\\"), 303, headers={"cache-control": "no-store"})
        response.set_cookie(
            cookie_name(request.scope),
            self._sessions.begin(identity.hash or ""),
            max_age=SESSION_S,
            httponly=True,
            samesite="strict",
            secure=request.url.scheme == "https",
        )
        return response

    def _by_token(self, said: str) -> Identity | None:
        """Who said that token; None where it is none. By hashes: the time it takes tells nothing of the tokens."""
        if self._own_hash is not None and hmac.compare_digest(hash_of(said), self._own_hash):
            return OWN
        named = self._tokens.match(said)
        return None if named is None else Identity(named.name, named.role, named.hash)

    def _in_session(self, scope: Scope, headers: Iterable[tuple[bytes, str]]) -> Identity | None:
        for key, value in headers:
            if key == b"cookie":
                try:
                    cookie = SimpleCookie(value).get(cookie_name(scope))
                except CookieError:
                    continue
                token_hash = self._sessions.token_of(cookie.value) if cookie else None
                if cookie is None or token_hash is None:
                    continue
                if token_hash == OWN.hash:
                    return replace(OWN, session=cookie.value)
                named = self._tokens.of_hash(token_hash)
                if named is not None:
                    return Identity(named.name, named.role, named.hash, cookie.value)
        return None


class _Wrong(Exception):
    """A token was said, and it is wrong; `page` says so."""

    def __init__(self, page: Response) -> None:
        self.page = page


def _page(said: str, status: int) -> HTMLResponse:
    # With "no-referrer" browsers send a form with "Origin: null", which the guard takes for another web site's.
    headers = {**HEADERS, "referrer-policy": "same-origin", "cache-control": "no-store", "WWW-Authenticate": "Bearer"}
    return HTMLResponse(PAGE.format(said=html.escape(said)), status, headers=headers)
