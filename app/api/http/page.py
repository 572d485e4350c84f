"""What was built for the browser: the files of the UI, its page for every route of the client, and the help."""

from __future__ import annotations

import gzip
import html
import mimetypes
import os
from pathlib import Path

from starlette.exceptions import HTTPException
from starlette.responses import FileResponse, HTMLResponse, RedirectResponse, Response
from starlette.staticfiles import NotModifiedResponse
from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocketClose

CSP = "; ".join(
    (
        "default-src 'self'",
        "script-src 'self'",
        # the component library and the plots set styles from script
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src 'self' data:",
        "connect-src 'self'",
        "worker-src 'self' blob:",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'self'",
        "frame-ancestors 'none'",
    )
)
HEADERS = {
    "content-security-policy": CSP,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
}
HASHED = "public, max-age=31536000, immutable"
REVALIDATED = "no-cache"
GZIP = ".gz"
"""What the build has packed lies under its file's name and this (`scripts/built_folder.py`), beside that file or, in an
image, alone."""

INDEX = "/index.html"
HELP = "/help"

MISSING_HELP = """<!doctype html><html lang="en"><meta charset="utf-8"><title>stepscope help</title>
<body><h1>The help was not built</h1>
<p>Nothing was found in <code>{directory}</code>. <code>make run</code> builds it; an installed wheel always has it.</p>
"""
MISSING = """<!doctype html><html lang="en"><meta charset="utf-8"><title>stepscope</title>
<body><h1>stepscope runs, its web page was not built</h1>
<p>Nothing was found in <code>{directory}</code>. <code>make run</code> builds it; with hot reload:
<code>make dev</code>. An installed wheel always has it.</p>
<p>The API answers at <a href="/api/v1/health">/api/v1</a>; <a href="/openapi.json">/openapi.json</a> describes it.</p>
"""


class BuiltFiles:
    """The files of a folder, packed where the reader takes that, and sent once while they stay the same."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory.resolve()

    def find(self, path: str) -> Path | None:
        """The file under the directory that `path` names, packed where it is kept so only, or None."""
        return self._inside(path) or self._inside(path + GZIP)

    def _inside(self, path: str) -> Path | None:
        """The file of that very name; `..` and links never lead out."""
        if "\0" in path:
            return None
        try:
            found = (self.directory / path.lstrip("/")).resolve()
            inside = found.is_relative_to(self.directory)
            return found if inside and found.is_file() else None
        except OSError:  # names longer than the file system takes
            return None

    def send(self, path: str, found: Path, cache: str, scope: Scope) -> Response:
        """The answer that carries `found`, which lies at `path`."""
        headers = {**HEADERS, "cache-control": cache}
        packed = self._inside(path + GZIP)
        if packed is not None:
            headers["vary"] = "Accept-Encoding"
            if _takes_gzip(scope):
                # Of another length and time than the plain file, so with another ETag.
                headers["content-encoding"] = "gzip"
                found = packed
        kind = mimetypes.guess_type(path)[0] or "application/octet-stream"
        response: Response = FileResponse(found, stat_result=os.stat(found), media_type=kind, headers=headers)
        if found == packed and "content-encoding" not in headers:
            headers["etag"] = response.headers["etag"].removesuffix('"') + '-plain"'
            response = Response(gzip.decompress(found.read_bytes()), media_type=kind, headers=headers)
        return NotModifiedResponse(response.headers) if _unchanged(response, scope) else response

    def missing(self, page: str) -> Response:
        """The answer where nothing was built."""
        text = page.format(directory=html.escape(str(self.directory)))
        return HTMLResponse(text, 503, headers={**HEADERS, "cache-control": "no-store"})


class WebUi:
    """ASGI application behind the API's routes: whatever these do not know comes here."""

    def __init__(self, ui: Path, help_site: Path) -> None:
        self._ui, self._help = BuiltFiles(ui), BuiltFiles(help_site)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket":
            await WebSocketClose(1008, "no socket at this address")(scope, receive, send)
            return
        path: str = scope["path"]
        if path == "/api" or path.startswith("/api/"):
            raise HTTPException(404, "no such call")
        if scope["method"] not in ("GET", "HEAD"):
            raise HTTPException(405, headers={"Allow": "GET, HEAD"})
        is_help = path == HELP or path.startswith(f"{HELP}/")
        response = self._help_page(path.removeprefix(HELP), scope) if is_help else self._page(path, scope)
        await response(scope, receive, send)

    def _page(self, path: str, scope: Scope) -> Response:
        found = self._ui.find(path)
        if found is not None:
            return self._ui.send(path, found, HASHED if path.startswith("/assets/") else REVALIDATED, scope)
        if "." in path.rpartition("/")[2]:
            raise HTTPException(404, "no such file")
        index = self._ui.find(INDEX)
        return self._ui.missing(MISSING) if index is None else self._ui.send(INDEX, index, REVALIDATED, scope)

    def _help_page(self, path: str, scope: Scope) -> Response:
        if path == "":  # links of its pages count from the folder
            return RedirectResponse(f"{HELP}/", headers=HEADERS)
        path = f"{path}index.html" if path.endswith("/") else path
        found = self._help.find(path)
        if found is not None:
            return self._help.send(path, found, REVALIDATED, scope)
        if self._help.find(INDEX) is None:
            return self._help.missing(MISSING_HELP)
        raise HTTPException(404, f"no such page: {HELP}/ has the list")


def _takes_gzip(scope: Scope) -> bool:
    said = ",".join(value.decode("latin-1") for key, value in scope["headers"] if key == b"accept-encoding")
    weights: dict[str, str] = {}
    for choice in said.lower().replace(" ", "").split(","):
        name, _, weight = choice.partition(";q=")
        weights[name] = weight or "1"
    return weights.get("gzip", weights.get("*", "0")).strip("0.") != ""


def _unchanged(response: Response, scope: Scope) -> bool:
    tags = next((value.decode("latin-1") for key, value in scope["headers"] if key == b"if-none-match"), "")
    return response.headers["etag"] in [tag.strip().removeprefix("W/") for tag in tags.split(",")]
