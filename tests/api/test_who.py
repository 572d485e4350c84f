"""Each request knows whose it is, and everything that it starts knows it too."""

from __future__ import annotations

import asyncio

import httpx
import pytest
from fastapi import FastAPI
from hypothesis import given
from hypothesis import strategies as st
from starlette.types import Receive, Scope, Send

from app.api.http.actor import NAME_MAX, ActorMiddleware, plain_name
from app.api.http.identity import ANYBODY, Identity, identify
from app.devices.core.actor import STEPSCOPE, Actor, actor

SESSION = "0f8fad5b-d9cb-469f-a165-70867728950e"
CHROME = "Mozilla/5.0 (X11; Linux x86_64) AppleWebKit/537.36 Chrome/142"


class Asked:
    """An application that remembers who asked it, in a task of its own as a procedure would."""

    def __init__(self) -> None:
        self.seen: list[Actor] = []

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        await asyncio.create_task(self._look())
        if scope["type"] == "http":
            await send({"type": "http.response.start", "status": 204, "headers": []})
            await send({"type": "http.response.body"})

    async def _look(self) -> None:
        self.seen.append(actor.get())


async def who(headers: dict[str, str], names: dict[str, str] | None = None, identity: Identity = ANYBODY) -> Actor:
    asked = Asked()
    inside = ActorMiddleware(asked, (names or {}).get)

    async def door(scope: Scope, receive: Receive, send: Send) -> None:
        identify(scope, identity)
        await inside(scope, receive, send)

    transport = httpx.ASGITransport(door, client=("10.0.0.7", 40_000))
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000") as client:
        await client.get("/", headers=headers)
    assert actor.get() is STEPSCOPE
    return asked.seen[0]


@pytest.mark.parametrize(
    ("headers", "expected"),
    [
        ({"user-agent": "curl/8.5.0"}, Actor("curl@10.0.0.7", "client", None, "10.0.0.7")),
        ({"user-agent": CHROME}, Actor("browser@10.0.0.7", "browser", None, "10.0.0.7")),
        ({"user-agent": ""}, Actor("unknown@10.0.0.7", "client", None, "10.0.0.7")),
        (
            {"user-agent": CHROME, "stepscope-session": SESSION, "stepscope-name": "Zo%C3%AB%20at%20bench%202"},
            Actor("Zoë at bench 2", "browser", SESSION, "10.0.0.7"),
        ),
        ({"user-agent": "x", "stepscope-name": "%0a%0d"}, Actor("x@10.0.0.7", "client", None, "10.0.0.7")),
        (
            {"user-agent": "x", "stepscope-name": "%ff%00"},
            Actor("\N{REPLACEMENT CHARACTER}", "client", None, "10.0.0.7"),
        ),
    ],
)
async def test_what_a_request_says_of_itself(headers: dict[str, str], expected: Actor) -> None:
    assert await who(headers) == expected


async def test_the_name_of_the_lease_wins() -> None:
    headers = {"stepscope-session": SESSION, "stepscope-name": "somebody%20else"}
    assert (await who(headers, {SESSION: "tuning"})).name == "tuning"


async def test_the_name_of_the_token_wins_over_all() -> None:
    headers = {"stepscope-session": SESSION, "stepscope-name": "somebody%20else"}
    seen = await who(headers, {SESSION: "tuning"}, Identity("anna", "drive", "0" * 64))
    assert (seen.name, seen.token) == ("anna", "anna")


async def test_a_socket_has_one_too() -> None:
    asked = Asked()

    async def receive() -> dict[str, str]:
        return {"type": "websocket.connect"}

    async def send(message: object) -> None:
        del message

    scope = {"type": "websocket", "headers": [(b"user-agent", b"curl/8")], "client": ("::1", 5)}
    identify(scope, ANYBODY)
    await ActorMiddleware(asked, lambda _: None)(scope, receive, send)
    assert asked.seen[0].name == "curl@::1"


async def test_every_request_of_the_program_passes_here(app: FastAPI, client: httpx.AsyncClient) -> None:
    seen: list[Actor] = []

    @app.get("/api/v1/who-is-it", include_in_schema=False)
    async def look() -> None:
        seen.append(actor.get())

    assert (await client.get("who-is-it", headers={"user-agent": "curl/8"})).status_code == 200
    assert [one.name for one in seen] == ["curl@127.0.0.1"]


def test_the_secret_is_not_shown() -> None:
    assert SESSION not in repr(Actor("x", "client", SESSION, ""))


@given(st.text())
def test_any_name_is_one_short_line(text: str) -> None:
    name = plain_name(text)
    assert len(name) <= NAME_MAX
    assert name.isprintable()
    assert name == name.strip()
