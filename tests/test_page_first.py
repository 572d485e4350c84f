"""The page comes before the program: a browser has it at once, and its calls wait for what is still imported."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI
from starlette.types import Message

from app import page_first, serving
from app.errors import StoreUnavailable
from app.listening import listen
from app.page_first import PageFirst
from app.settings import Settings

HELD_S = 30.0


class Held:
    """A program whose making ends when the test says so."""

    def __init__(self, fails_with: Exception | None = None) -> None:
        self.may_end = threading.Event()
        self.told = 0
        self.events: list[str] = []
        self._fails_with = fails_with

    def make(self) -> FastAPI:
        assert self.may_end.wait(HELD_S)
        if self._fails_with is not None:
            raise self._fails_with

        @asynccontextmanager
        async def lifespan(_: FastAPI) -> AsyncIterator[None]:
            self.events.append("begins")
            yield
            self.events.append("ends")

        program = FastAPI(lifespan=lifespan)
        program.get("/api/v1/health")(lambda: "well")
        return program

    def over(self) -> None:
        self.told += 1


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    (tmp_path / "index.html").write_text("<!doctype html>the page", encoding="utf-8")
    (tmp_path / "assets").mkdir()
    (tmp_path / "assets/index.js").write_text("the script", encoding="utf-8")
    return Settings(data_dir=tmp_path / "data", web_dir=tmp_path)


@asynccontextmanager
async def running(first: PageFirst) -> AsyncIterator[httpx.AsyncClient]:
    """A browser of it, between its lifespan's two messages as uvicorn sends them."""
    heard: asyncio.Queue[str] = asyncio.Queue()
    said: asyncio.Queue[Message] = asyncio.Queue()
    said.put_nowait({"type": "lifespan.startup"})

    async def send(message: Message) -> None:
        await heard.put(message["type"])

    life = asyncio.create_task(first({"type": "lifespan"}, said.get, send))
    async with asyncio.timeout(HELD_S):
        assert await heard.get() == "lifespan.startup.complete"
        async with httpx.AsyncClient(transport=httpx.ASGITransport(first), base_url="http://127.0.0.1") as client:
            yield client
        await said.put({"type": "lifespan.shutdown"})
        assert await heard.get() == "lifespan.shutdown.complete"
        await life


async def test_a_browser_has_the_page_at_once_and_its_calls_wait(settings: Settings) -> None:
    held = Held()
    async with running(PageFirst(held.make, settings, held.over)) as client:
        page = await client.get("/")
        assert page.text.endswith("the page")
        assert "script-src 'self'" in page.headers["content-security-policy"]
        assert (await client.get("/assets/index.js")).text == "the script"
        waiting = [asyncio.create_task(client.get(path)) for path in ("/api/v1/health", "/assets/none.js", "/?token=a")]
        await asyncio.wait(waiting, timeout=0)
        assert not any(call.done() for call in waiting)
        held.may_end.set()
        assert [(await call).status_code for call in waiting] == [200, 404, 404]
        assert (held.told, held.events) == (1, ["begins"])
    assert held.events == ["begins", "ends"]


async def test_another_sites_page_is_refused_before_the_program_is_there(settings: Settings) -> None:
    held = Held()
    async with running(PageFirst(held.make, settings, held.over)) as client:
        assert (await client.get("/", headers={"host": "evil.example"})).status_code == 403
        held.may_end.set()


@pytest.mark.parametrize("asks", [{"token": "a token of sixteen"}, {"host": "0.0.0.0"}])
async def test_a_server_that_asks_for_a_token_shows_nothing_before_it_can_check_one(
    settings: Settings, asks: dict[str, object]
) -> None:
    held = Held()
    first = PageFirst(held.make, Settings.model_validate({**settings.model_dump(), **asks}), held.over)
    assert not first.shows_page
    async with running(first) as client:
        waiting = asyncio.create_task(client.get("/"))
        await asyncio.wait([waiting], timeout=0)
        assert not waiting.done()
        held.may_end.set()
        assert (await waiting).status_code == 404, "the program answers, which has no page here"


async def test_who_waits_is_told_where_the_program_does_not_come(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    failure = StoreUnavailable("no room", "make some")
    held = Held(failure)
    first = PageFirst(held.make, settings, held.over)
    async with running(first) as client:
        with monkeypatch.context() as hurried:
            hurried.setattr(page_first, "STARTED_WITHIN_S", 0.0)
            late = await client.get("/api/v1/health")
        assert (late.status_code, late.json()["type"]) == (503, "/problems/starting")
        held.may_end.set()
        assert (await client.get("/api/v1/health")).status_code == 503
    assert (first.failure, held.told) == (failure, 1)


def test_a_server_whose_program_fails_ends_and_says_why(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(_: Settings) -> FastAPI:
        raise StoreUnavailable("no room", "make some")

    monkeypatch.setattr(serving, "make_program", fail)
    told: list[str] = []
    with listen("127.0.0.1", 0) as listener, pytest.raises(StoreUnavailable, match="no room"):
        serving._serve(settings, listener, told.append)
    assert [line.startswith("stepscope is at http://127.0.0.1:") for line in told] == [True]
