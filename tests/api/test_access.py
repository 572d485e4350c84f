"""On a network only those who know the token come in; on this machine's own address everybody."""

from __future__ import annotations

import logging
from collections.abc import AsyncIterator
from dataclasses import dataclass

import httpx
import pytest
from fastapi import FastAPI

from app.api.http.access import ADDRESSES_MAX, GUESSES, WINDOW_S, Guesses
from app.api.http.guard import is_loopback
from app.api.http.log_ins import REFUSED_MAX, REFUSED_S
from app.clock import VirtualClock
from app.main import create_app
from app.serving import _address, _without_token
from app.settings import Settings

TOKEN = "correct horse"
HTML = {"accept": "text/html,application/xhtml+xml"}


@dataclass
class Door:
    """A server on a network, and who knocks."""

    app: FastAPI

    def visitor(self, address: str = "10.0.0.9", **headers: str) -> httpx.AsyncClient:
        """Somebody at that address, with a jar for cookies of their own."""
        transport = httpx.ASGITransport(self.app, client=(address, 40_000))
        return httpx.AsyncClient(transport=transport, base_url="http://10.0.0.1:8000", headers=headers)


@pytest.fixture
async def door(settings: Settings, clock: VirtualClock) -> AsyncIterator[Door]:
    networked = settings.model_copy(update={"host": "0.0.0.0", "demo": False})
    app = create_app(Settings.model_validate({**networked.model_dump(), "token": TOKEN}), clock)
    async with app.router.lifespan_context(app):
        yield Door(app)


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.8.8", "::1", "[::1]", "localhost", "LOCALHOST"])
def test_addresses_of_this_machine_alone(host: str) -> None:
    assert is_loopback(host)
    assert create_app(Settings(host=host)).state.token is None


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "", "192.168.1.5", "bench.local", "localhost.evil.com"])
def test_any_other_gets_a_token_of_its_own(host: str) -> None:
    assert not is_loopback(host)
    first, second = (create_app(Settings(host=host)).state.token for _ in range(2))
    assert len(first) >= 32
    assert first != second


def test_a_token_can_be_asked_for_on_loopback_too() -> None:
    assert create_app(Settings.model_validate({"token": TOKEN})).state.token == TOKEN


@pytest.mark.parametrize("change", [{"token": "short"}, {"tls_cert": "c.pem"}, {"tls_key": "k.pem"}])
def test_settings_that_cannot_be(change: dict[str, str]) -> None:
    with pytest.raises(ValueError, match=r"at least 8|needs both"):
        Settings.model_validate(change)


def test_the_terminal_shows_where_to_go() -> None:
    settings = Settings.model_validate({"host": "0.0.0.0", "token": TOKEN})
    assert _address(create_app(settings), settings, 8000) == "http://127.0.0.1:8000/?token=correct+horse"
    alone = Settings()
    assert _address(create_app(alone), alone, 8000) == "http://127.0.0.1:8000"


def test_settings_are_shown_without_it() -> None:
    assert TOKEN not in repr(Settings.model_validate({"token": TOKEN}))


def test_the_access_log_is_without_it() -> None:
    record = logging.LogRecord("uvicorn.access", 20, "", 0, "%s %s", ("GET /?token=abc&x=1", 303), None)
    assert _without_token(record)
    assert record.getMessage() == "GET /?token=***&x=1 303"


CALLS = [
    ("GET", "/api/v1/devices"),
    ("POST", "/api/v1/stop"),
    ("PUT", "/api/v1/devices/bench/registers/v_max?axis=0"),
    ("GET", "/openapi.json"),
    ("GET", "/assets/index-abc123.js"),
    ("GET", "/api/v1/devices?token=correct+horse"),
    ("POST", "/api/v1/login"),
]


@pytest.mark.parametrize(("method", "path"), CALLS)
@pytest.mark.parametrize(
    "headers", [{}, {"authorization": "Bearer wrong"}, {"authorization": "Basic Y29ycmVjdCBob3JzZQ=="}]
)
async def test_nobody_without_it_gets_anything(door: Door, method: str, path: str, headers: dict[str, str]) -> None:
    async with door.visitor() as visitor:
        answer = await visitor.request(method, path, headers=headers)
    assert answer.status_code == 401
    assert answer.headers["www-authenticate"] == "Bearer"
    assert answer.json()["type"] == "/problems/token-required"
    assert TOKEN not in answer.text


async def test_a_script_says_it_with_every_call(door: Door) -> None:
    async with door.visitor(authorization=f"Bearer {TOKEN}") as script:
        assert (await script.get("/api/v1/devices")).json() == []
        assert (await script.post("/api/v1/stop")).status_code == 200
    assert not script.cookies


async def test_health_is_for_everybody(door: Door) -> None:
    async with door.visitor() as visitor:
        assert (await visitor.get("/api/v1/health")).json()["status"] == "ok"
        assert (await visitor.post("/api/v1/healthy")).status_code == 401


async def test_a_browser_comes_in_by_the_address_of_the_terminal(door: Door) -> None:
    async with door.visitor(**HTML) as browser:
        page = await browser.get("/ramps")
        assert page.status_code == 401
        assert 'type="password"' in page.text
        welcome = await browser.get("/ramps", params={"token": TOKEN, "device": "x y"})
        assert (welcome.status_code, welcome.headers["location"]) == (303, "/ramps?device=x+y")
        cookie = welcome.headers["set-cookie"].casefold()
        assert "httponly" in cookie
        assert "samesite=strict" in cookie
        assert TOKEN not in cookie
        assert "the page" in (await browser.get("/ramps")).text
        assert (await browser.get("/api/v1/devices")).json() == []


async def test_or_by_the_form(door: Door) -> None:
    async with door.visitor(**HTML) as browser:
        wrong = await browser.post("/login", data={"token": "nonsense"})
        assert (wrong.status_code, "Wrong token" in wrong.text) == (401, True)
        assert (await browser.post("/login", content=b"token=" + b"x" * 10_000)).status_code == 413
        assert (await browser.post("/login", data={"token": TOKEN})).headers["location"] == "/"
        assert (await browser.get("/api/v1/devices")).status_code == 200


async def test_browsers_say_whose_the_form_is(door: Door) -> None:
    """With "no-referrer" they would send it with "Origin: null", and the guard would refuse it."""
    async with door.visitor(**HTML) as browser:
        page = await browser.get("/")
        assert page.headers["referrer-policy"] == "same-origin"
        own = {"origin": "http://10.0.0.1:8000"}
        assert (await browser.post("/login", data={"token": TOKEN}, headers=own)).status_code == 303
        assert (await browser.post("/login", data={"token": TOKEN}, headers={"origin": "null"})).status_code == 403


async def test_a_foreign_page_may_not_even_guess(door: Door) -> None:
    async with door.visitor(origin="http://evil.com") as visitor:
        assert (await visitor.post("/login", data={"token": TOKEN})).status_code == 403


@pytest.mark.parametrize("path", ["//evil.com", "/\\evil.com", "//evil.com/a"])
async def test_the_way_in_leads_to_no_other_server(door: Door, path: str) -> None:
    async with door.visitor(**HTML) as browser:
        welcome = await browser.get(httpx.URL(f"http://10.0.0.1:8000{path}", params={"token": TOKEN}))
    assert welcome.status_code == 303
    location = welcome.headers["location"]
    assert location.startswith("/")
    assert not location.startswith(("//", "/\\"))


@pytest.mark.parametrize("cookie", ["stepscope_8000=guess", "stepscope_8000=", "=;;=", "stepscope_8000"])
async def test_a_made_up_session_is_none(door: Door, cookie: str) -> None:
    async with door.visitor(cookie=cookie) as visitor:
        assert (await visitor.get("/api/v1/devices")).status_code == 401


async def test_a_session_ends(door: Door, clock: VirtualClock) -> None:
    async with door.visitor() as browser:
        await browser.get("/", params={"token": TOKEN})
        assert (await browser.get("/api/v1/devices")).status_code == 200
        await clock.advance(31 * 24 * 3600)
        browser.cookies.set("stepscope_8000", next(iter(browser.cookies.values()), "x"))
        assert (await browser.get("/api/v1/devices")).status_code == 401


async def test_who_guesses_is_told_to_wait_and_who_knows_comes_in(door: Door, clock: VirtualClock) -> None:
    async with door.visitor() as friend, door.visitor("10.0.0.66") as thief, door.visitor("10.0.0.66") as neighbour:
        for guess in range(GUESSES):
            answer = await thief.get("/api/v1/devices", headers={"authorization": f"Bearer {guess}"})
            assert answer.status_code == 401
        for _ in range(2):
            answer = await thief.get("/api/v1/devices", headers={"authorization": "Bearer another"})
            assert answer.status_code == 429
            assert 0 < int(answer.headers["retry-after"]) <= WINDOW_S
        assert (await thief.post("/login", data={"token": "another"})).status_code == 429
        assert (await thief.get("/", params={"token": "another"})).status_code == 429
        # From behind the same address, as everybody behind one proxy is.
        bearer = {"authorization": f"Bearer {TOKEN}"}
        assert (await neighbour.get("/api/v1/devices", headers=bearer)).status_code == 200
        assert (await neighbour.post("/api/v1/stop", headers=bearer)).status_code == 200
        assert (await neighbour.get("/", headers=HTML)).status_code == 401, "the form for the token"
        assert (await neighbour.post("/login", data={"token": TOKEN})).status_code == 303
        assert (await neighbour.post("/api/v1/stop")).status_code == 200
        assert (await friend.get("/", params={"token": TOKEN})).status_code == 303
        await clock.advance(WINDOW_S + 1)
        answer = await thief.get("/api/v1/devices", headers={"authorization": "Bearer another"})
        assert answer.status_code == 401


@pytest.mark.parametrize("path", ["/api/v1/stop", "/api/v1/devices/bench/axes/0/stop"])
async def test_a_stop_gets_through_past_guesses_and_past_somebody_elses_lease(door: Door, path: str) -> None:
    bearer = {"authorization": f"Bearer {TOKEN}"}
    async with (
        door.visitor(**bearer, **{"stepscope-session": "session-of-anna-0001"}) as anna,
        door.visitor("10.0.0.66") as thief,
        door.visitor("10.0.0.66", **bearer) as neighbour,
    ):
        assert (await anna.post("/api/v1/lease", json={"name": "Anna"})).json()["mine"]
        for guess in range(2 * GUESSES):
            refused = await thief.post(path, headers={"authorization": f"Bearer {guess}"})
            assert refused.status_code == 401, "a wrong token stops nothing, and is told what is wrong"
        assert (await thief.get("/api/v1/devices", headers={"authorization": "Bearer x"})).status_code == 429
        assert (await neighbour.post("/api/v1/devices", json={})).json()["type"] == "/problems/bench-taken"
        assert (await neighbour.post(path)).status_code == (200 if path.endswith("v1/stop") else 404)


def test_many_addresses_cost_little_memory(clock: VirtualClock) -> None:
    guesses = Guesses(clock)
    for number in range(ADDRESSES_MAX + 100):
        guesses.was_wrong(str(number))
    assert len(guesses._wrong) == ADDRESSES_MAX


async def test_nobody_listens_in_without_it(door: Door) -> None:
    sent: list[dict[str, object]] = []

    async def receive() -> dict[str, str]:
        return {"type": "websocket.connect"}

    async def send(message: dict[str, object]) -> None:
        sent.append(message)

    scope = {
        "type": "websocket",
        "path": "/api/v1/devices/bench/telemetry",
        "headers": [(b"host", b"10.0.0.1:8000")],
        "query_string": b"channels=position.0",
        "client": ("10.0.0.9", 1),
        "server": ("10.0.0.1", 8000),
        "subprotocols": [],
        "extensions": {},
    }
    await door.app(scope, receive, send)  # type: ignore[arg-type]  # a plain dict is a scope
    assert [message["type"] for message in sent] == ["websocket.http.response.start", "websocket.http.response.body"]
    assert sent[0]["status"] == 401


async def test_wrong_tokens_fill_no_audit_log(door: Door, clock: VirtualClock) -> None:
    for number in range(REFUSED_MAX):
        async with door.visitor(f"10.0.1.{number}") as thief:
            for _ in range(GUESSES):
                await thief.post("/login", data={"token": "wrong"})
            await thief.get("/api/v1/devices", headers={"authorization": "Bearer wrong"})
    await clock.advance(REFUSED_S)
    async with door.visitor(authorization="Bearer wrong") as thief:
        await thief.get("/api/v1/devices")
    async with door.visitor(authorization=f"Bearer {TOKEN}") as owner:
        audit = (await owner.get("/api/v1/audit")).json()["entries"]
    assert [(each["action"], each["detail"]) for each in audit if each["action"] != "start"] == [
        ("use token", "100 wrong tokens before it are not entered"),
        *[("log in", "")] * REFUSED_MAX,
    ]
