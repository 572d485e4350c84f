"""The picture of the 3D view under our own origin: viser's page and its socket, passed on from its process.

One origin, one port, one login: the guard against foreign pages and the token stand before this as before everything
else. viser itself listens on the loopback address alone, and what a browser may do with its page is written here: run
the scripts that the page is made of, decode with WebAssembly in a worker, and talk to this server; nothing else is
loaded from anywhere.
"""

from __future__ import annotations

import asyncio
import base64
import contextlib
import gzip
import hashlib
import http.client
from collections.abc import Sequence

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket, WebSocketDisconnect
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import WebSocketException
from websockets.typing import Subprotocol

from ...errors import BenchError, WrongState
from ...twin.process import Address
from ...twin.service import Twin
from ..http.problems import error_answer
from ..http.sockets import until_one_ends

VIEW = "/twin/view"
"""Where the picture is; with a slash behind it its page, whose socket has the same address without."""
SUBPROTOCOL = "viser-v"
"""What viser's page offers begins like this, and goes on with its version."""
PAGE_BYTES_MAX = 8 << 20
TO_VIEWER_BYTES_MAX = 16 << 20
"""A whole scene with its bodies."""
TO_VIEWER_QUEUE = 4
"""Messages that may wait for a slow browser; then viser waits, and leaves out what is no longer true."""
CONNECT_WITHIN_S = 10.0

# viser's own panel is a developer's tool, and its messages about graphics would hide the picture: the page around it
# tells what there is to tell.
STYLE = "<style>.mantine-Paper-root,.mantine-Notifications-root{display:none!important}</style>"
# Its sorter of splats, of which there are none here, wants to compile strings. The policy forbids that, and what it
# then complains of is no error of ours.
QUIET = "addEventListener('unhandledrejection',e=>{if(e.reason instanceof EvalError)e.preventDefault()})"
QUIET_HASH = "sha256-" + base64.b64encode(hashlib.sha256(QUIET.encode()).digest()).decode()


def policy(scripts: Sequence[str]) -> str:
    """Content security policy of viser's page, whose `scripts` are named by their hashes; none: any inline script."""
    allowed = " ".join(f"'{script}'" for script in (QUIET_HASH, *scripts)) if scripts else "'unsafe-inline'"
    return "; ".join(
        (
            "default-src 'none'",
            f"script-src {allowed} 'wasm-unsafe-eval'",
            "style-src 'unsafe-inline'",
            "img-src data: blob:",
            "font-src data:",
            "connect-src 'self' data: blob:",
            "worker-src blob:",
            "base-uri 'none'",
            "form-action 'none'",
            "frame-ancestors 'self'",
        )
    )


class TwinProxy:
    """ASGI application for `/twin/view`; everything else goes to `otherwise`."""

    def __init__(self, twin: Twin, otherwise: ASGIApp) -> None:
        self._twin = twin
        self._otherwise = otherwise
        self._page: tuple[Address, bytes, bytes, str] | None = None
        """Of which process, plain, compressed, and its tag."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        path: str = scope["path"]
        if path != VIEW and not path.startswith(f"{VIEW}/"):
            await self._otherwise(scope, receive, send)
        elif scope["type"] == "websocket":
            await self._socket(WebSocket(scope, receive, send))
        else:
            try:
                response = await self._answer(Request(scope))
            except BenchError as error:
                response = error_answer(error, path)
            await response(scope, receive, send)

    # --- the page -------------------------------------------------------------------------------

    async def _answer(self, request: Request) -> Response:
        if request.method not in ("GET", "HEAD"):
            raise HTTPException(405, headers={"Allow": "GET, HEAD"})
        if request.url.path != f"{VIEW}/":
            raise HTTPException(404, "the 3D view is one page")  # and viser's folder nobody's business
        address, plain, packed, tag = await self._viser_page()
        headers = {
            "content-security-policy": policy(address.scripts),
            "x-content-type-options": "nosniff",
            "referrer-policy": "no-referrer",
            "cross-origin-opener-policy": "same-origin",
            "cache-control": "no-cache",
            "vary": "accept-encoding",
            "etag": tag,
        }
        known = request.headers.get("if-none-match", "")
        if tag in [each.strip().removeprefix("W/") for each in known.split(",")]:
            return Response(None, 304, headers)
        body = plain
        if "gzip" in request.headers.get("accept-encoding", ""):
            headers["content-encoding"] = "gzip"
            body = packed
        return Response(body, headers=headers, media_type="text/html")

    async def _viser_page(self) -> tuple[Address, bytes, bytes, str]:
        """The page as we pass it on; asked once of each process. Raises WrongState."""
        address = self._twin.address
        if self._page is None or self._page[0] != address:
            plain = await asyncio.to_thread(_fetched, address)
            # Before viser's own: it has to be there when that begins.
            plain = plain.replace(b"<head>", f"<head>{STYLE}<script>{QUIET}</script>".encode(), 1)
            packed = await asyncio.to_thread(gzip.compress, plain, 6)
            tag = f'"{hashlib.sha256(plain).hexdigest()[:32]}"'
            self._page = (address, plain, packed, tag)
        return self._page

    # --- the socket -----------------------------------------------------------------------------

    async def _socket(self, browser: WebSocket) -> None:
        wanted = [name for name in browser.scope.get("subprotocols", []) if name.startswith(SUBPROTOCOL)]
        if browser.url.path not in (VIEW, f"{VIEW}/") or not wanted:
            await browser.close(1008, "no socket at this address")
            return
        try:
            address = self._twin.address
            with self._twin.looking():
                async with connect(
                    f"ws://{address.host}:{address.port}/",
                    subprotocols=[Subprotocol(name) for name in wanted],
                    compression=None,
                    proxy=None,  # whatever the environment says: it is this machine
                    user_agent_header=None,
                    open_timeout=CONNECT_WITHIN_S,
                    close_timeout=1.0,
                    ping_interval=None,
                    max_size=TO_VIEWER_BYTES_MAX,
                    max_queue=TO_VIEWER_QUEUE,
                ) as viser:
                    await browser.accept(viser.subprotocol)
                    await self._pass_on(browser, viser)
        except WrongState as error:
            await _close(browser, 1013, str(error))
        except (OSError, WebSocketException):
            await _close(browser, 1001, "the 3D view has ended")

    async def _pass_on(self, browser: WebSocket, viser: ClientConnection) -> None:
        """Both ways, until either ends. Each way waits for its reader: nothing piles up here."""

        async def down() -> None:
            async for message in viser:
                if isinstance(message, bytes):
                    await browser.send_bytes(message)

        goodbye = (1001, "the 3D view has ended")

        async def up() -> None:
            nonlocal goodbye
            while True:
                message = await browser.receive()
                if message["type"] == "websocket.disconnect":
                    return
                data = message.get("bytes")
                if data is None:
                    goodbye = (1003, "binary messages only")
                    return
                await viser.send(data)

        await until_one_ends(down(), up(), name="twin view")
        await _close(browser, *goodbye)  # not in `up`: whatever ended `down` meanwhile would take it back half said


def _fetched(address: Address) -> bytes:
    """The page from the process; blocks. Raises WrongState where it does not give it."""
    connection = http.client.HTTPConnection(address.host, address.port, timeout=CONNECT_WITHIN_S)
    try:
        # Nothing of the browser's request goes on: neither its cookie nor anything else is viser's business.
        connection.request("GET", "/", headers={"accept-encoding": "identity"})
        answer = connection.getresponse()
        content = answer.read(PAGE_BYTES_MAX + 1)
    except (OSError, http.client.HTTPException) as error:
        raise WrongState(f"the 3D view does not answer: {error!r}", "start it again") from error
    finally:
        connection.close()
    if answer.status != 200 or not 0 < len(content) <= PAGE_BYTES_MAX:
        raise WrongState(f"the 3D view answered {answer.status} with {len(content)} bytes", "start it again")
    return content


async def _close(browser: WebSocket, code: int, reason: str) -> None:
    with contextlib.suppress(RuntimeError, WebSocketDisconnect, OSError):  # it may be closed already
        await browser.close(code, reason[:120])
