"""What both clients have in common on the wire: where it goes, who asks, and what an answer's status means."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import urlsplit, urlunsplit

import httpx

from .. import __version__
from .calls import Call
from .errors import ClientError, NoAnswer, NoServer, refusal
from .lease import session_headers

T = TypeVar("T")
URL = "http://127.0.0.1:8000"
TIMEOUT_S = 30.0
"""A write waits for its read-back, behind everybody else's turn on a slow wire [s]."""
CONNECT_S = 3.0


def server_url(url: str | None) -> str:
    """`url`, else STEPSCOPE_URL, else this machine. Raises ValueError for what is no address of a server."""
    wanted = url or os.environ.get("STEPSCOPE_URL") or URL
    parts = urlsplit(wanted)
    if parts.scheme not in ("http", "https") or not parts.netloc:
        raise ValueError(f"a server is http://HOST:PORT, not {wanted!r}")
    return wanted.rstrip("/")


def token_of(token: str | None) -> str | None:
    """`token`, else STEPSCOPE_TOKEN, else what stands in the file STEPSCOPE_TOKEN_FILE. Raises OSError for that."""
    kept = os.environ.get("STEPSCOPE_TOKEN_FILE")
    return token or os.environ.get("STEPSCOPE_TOKEN") or (Path(kept).read_text().strip() if kept else None) or None


def headers(token: str | None) -> dict[str, str]:
    """What goes with every request."""
    said = {"User-Agent": f"stepscope-client/{__version__}", **session_headers()}
    return {**said, "Authorization": f"Bearer {token}"} if token else said


def timeout(timeout_s: float) -> httpx.Timeout:
    return httpx.Timeout(timeout_s, connect=min(timeout_s, CONNECT_S))


def socket_url(url: str, path: str) -> str:
    """The address of a socket on the same server."""
    scheme, netloc, base, _, _ = urlsplit(url)
    address, _, query = path.partition("?")
    return urlunsplit(("wss" if scheme == "https" else "ws", netloc, base + address, query, ""))


def options(call: Call[T], timeout_s: float | None = None) -> dict[str, Any]:
    """The call as arguments of httpx's `request`; with `timeout_s` it waits so long for the answer [s]."""
    given: dict[str, Any] = {"method": call.method, "url": call.path}
    if call.query:  # even an empty one would take the place of the query in a path
        given["params"] = dict(call.query)
    if call.body is not None:
        given["json"] = dict(call.body)
    if call.content is not None:
        given |= {"content": call.content, "headers": {"content-type": "text/csv"}}
    if timeout_s is not None:
        given["timeout"] = timeout(timeout_s)
    return given


def answer_of(call: Call[T], response: httpx.Response) -> T:
    """The answer's meaning. Raises Refused; ClientError for an answer that is none of stepscope's."""
    try:
        data = response.json() if response.content else None
    except ValueError as error:
        raise ClientError(f"{response.url} answers {response.status_code} and no JSON: is it stepscope?") from error
    if response.is_error:
        raise refusal(response.status_code, data if isinstance(data, dict) else {})
    try:
        return call.parse(data)
    except (KeyError, TypeError) as error:
        raise ClientError(f"{response.url} answers in another shape than expected: {error!r} is missing") from error


def content_of(response: httpx.Response) -> bytes:
    """The answer's bytes, of calls that answer with a file. Raises Refused."""
    if response.is_error:
        try:
            problem = response.json()
        except ValueError:
            problem = None
        raise refusal(response.status_code, problem if isinstance(problem, dict) else {})
    return response.content


def told(error: httpx.TransportError, url: str) -> ClientError:
    """What a broken connection means: whether the call can have arrived."""
    if isinstance(error, httpx.ConnectError | httpx.ConnectTimeout):
        return NoServer(f"no stepscope answers at {url}: start it (stepscope serve), or say where (--url)")
    return NoAnswer(f"{url} did not answer ({error!r}): what was asked may have happened all the same")
