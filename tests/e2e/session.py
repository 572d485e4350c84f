"""One session for the tests' own calls and their pages: whoever arranges a test also has the bench in the browser."""

from __future__ import annotations

import json
from collections.abc import Generator

import httpx
from playwright.sync_api import BrowserContext

SESSION = "e2e-of-stepscope-itself"
NAME = "Tester"


class AsTheHolder(httpx.Auth):
    """Takes the bench when a call finds that the session has not got it, as after a while without a page."""

    requires_response_body = True

    def auth_flow(self, request: httpx.Request) -> Generator[httpx.Request, httpx.Response, None]:
        request.headers["Stepscope-Session"] = SESSION
        answer = yield request
        if answer.status_code == 409 and answer.json()["type"] == "/problems/bench-not-taken":
            address = request.url.join("/api/v1/lease")
            taken = yield httpx.Request("POST", address, json={"name": NAME}, headers={"Stepscope-Session": SESSION})
            if taken.is_success:
                yield request


def a_client(url: str, timeout_s: float = 10.0) -> httpx.Client:
    """REST of the server at `url`; what `raise_for_status` raises says what the server said."""
    hooks = {"response": [_say_why]}
    return httpx.Client(base_url=f"{url}/api/v1", timeout=timeout_s, auth=AsTheHolder(), event_hooks=hooks)


def _say_why(response: httpx.Response) -> None:
    if response.is_error:
        said = response.read().decode(errors="replace")
        response.extensions["reason_phrase"] = f"{response.reason_phrase}: {said}".encode("ascii", "backslashreplace")


def take_the_bench(api: httpx.Client) -> None:
    """For the pages that are opened next."""
    api.post("/lease", json={"name": NAME}).raise_for_status()


def begin_with_the_bench(context: BrowserContext) -> None:
    """Let every page of `context` be a tab of our session.

    Its scope begins with 100 Hz instead of 500, which is a tenth of what a browser and its server work for a page.
    """
    stored = f"localStorage['stepscope.session'] = {json.dumps(SESSION)}; localStorage['stepscope.name'] = '{NAME}'"
    stored += "; localStorage['stepscope.scope'] ??= '{\"rateHz\":100}'"
    context.add_init_script(f"if (location.protocol !== 'about:') {{ {stored} }}")
