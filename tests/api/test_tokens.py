"""Named tokens: made once, kept as hashes, and gone at once with all that they opened when they are revoked."""

from __future__ import annotations

import asyncio
import json
import stat
import subprocess
import sys
from collections.abc import AsyncIterator
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from app.api.http.access import GUESSES
from app.api.router import BASE
from app.clock import VirtualClock
from app.errors import UnknownThing, UsageError, WrongState
from app.main import bench_of, create_app
from app.settings import Settings
from app.store.tokens import TokenStore
from tests.api.live import live_server

TOKEN = "correct horse"
HTML = {"accept": "text/html"}


@pytest.fixture
async def networked(settings: Settings, clock: VirtualClock) -> AsyncIterator[FastAPI]:
    changes = {"host": "0.0.0.0", "token": TOKEN}
    app = create_app(Settings.model_validate({**settings.model_dump(), **changes}), clock)
    async with app.router.lifespan_context(app):
        yield app


def visitor(app: FastAPI, token: str | None = None, **headers: str) -> httpx.AsyncClient:
    bearer = {} if token is None else {"authorization": f"Bearer {token}"}
    transport = httpx.ASGITransport(app, client=("10.0.0.9", 40_000))
    return httpx.AsyncClient(transport=transport, base_url="http://10.0.0.1:8000", headers={**bearer, **headers})


# --- the file -----------------------------------------------------------------------------------


def test_the_file_holds_hashes_for_its_owner_alone(tmp_path: Path) -> None:
    store = TokenStore(tmp_path / "data")
    token = store.add("anna", "drive")
    assert len(token) >= 32
    assert token not in store.path.read_text()
    assert stat.S_IMODE(store.path.stat().st_mode) == 0o600
    (found,) = store.load().tokens
    assert (found.name, found.role) == ("anna", "drive")
    store.revoke("anna")
    assert store.load().tokens == ()
    with pytest.raises(UnknownThing):
        store.revoke("anna")


@pytest.mark.parametrize("name", ["", " ", "a/b", "a\nb", " anna", "anna ", "x" * 61, "stepscope", "StepScope", "\0"])
def test_a_name_that_is_none(tmp_path: Path, name: str) -> None:
    with pytest.raises(UsageError, match="no name for a token"):
        TokenStore(tmp_path).add(name, "look")


def test_a_name_is_taken_once(tmp_path: Path) -> None:
    store = TokenStore(tmp_path)
    store.add("Zoë", "look")
    with pytest.raises(WrongState, match="already"):
        store.add("zoë", "administer")


@pytest.mark.parametrize("text", ["", "{", "[]", '{"format": "x"}', '{"format": "stepscope-tokens", "version": 1}'])
def test_a_broken_file_lets_nobody_in_and_is_kept(tmp_path: Path, text: str) -> None:
    store = TokenStore(tmp_path)
    store.path.write_text(text)
    found = store.load()
    assert found.tokens == ()
    assert "cannot be read" in found.warnings[0]
    store.add("anna", "look")
    (aside,) = tmp_path.glob("tokens.broken-*.json")
    assert aside.read_text() == text
    assert stat.S_IMODE(aside.stat().st_mode) == 0o600


def test_an_entry_that_is_none_is_left_out(tmp_path: Path) -> None:
    store = TokenStore(tmp_path)
    store.add("anna", "look")
    document = json.loads(store.path.read_text())
    good = document["tokens"][0]
    document["tokens"] += [5, {}, {**good, "role": "king"}, {**good, "sha256": "x"}, {**good, "name": "stepscope"}]
    store.path.write_text(json.dumps(document))
    found = store.load()
    assert [token.name for token in found.tokens] == ["anna"]
    assert len(found.warnings) == 5


# --- the server ---------------------------------------------------------------------------------


async def test_a_token_is_told_once_and_lets_in_at_once(networked: FastAPI) -> None:
    async with visitor(networked, TOKEN) as owner:
        made = await owner.post(f"{BASE}/tokens", json={"name": "anna", "role": "look"})
        assert (made.status_code, made.headers["cache-control"]) == (201, "no-store")
        token = made.json()["token"]
        listed = (await owner.get(f"{BASE}/tokens")).json()
        assert [(each["name"], each["role"], each["sessions"]) for each in listed] == [("anna", "look", 0)]
        audit = (await owner.get(f"{BASE}/audit")).json()["entries"]
        assert token not in json.dumps([listed, audit])
        assert ("add token", "anna") in [(entry["action"], entry["subject"]) for entry in audit]
        again = await owner.post(f"{BASE}/tokens", json={"name": "Anna", "role": "look"})
        assert again.status_code == 409
    async with visitor(networked, token) as anna:
        me = (await anna.get(f"{BASE}/access")).json()
        assert me == {"name": "anna", "role": "look", "by": "token"}
        assert (await anna.get(f"{BASE}/devices")).status_code == 200


async def test_the_servers_own_token_administers(networked: FastAPI) -> None:
    async with visitor(networked, TOKEN) as owner:
        assert (await owner.get(f"{BASE}/access")).json() == {"name": None, "role": "administer", "by": "token"}


async def test_loopback_without_a_token_stays_open_whatever_tokens_there_are(client: httpx.AsyncClient) -> None:
    assert (await client.get("access")).json() == {"name": None, "role": "administer", "by": "nothing"}
    token = (await client.post("tokens", json={"name": "anna", "role": "look"})).json()["token"]
    assert (await client.post("recordings", json={})).status_code == 422, "as before"
    named = {"authorization": f"Bearer {token}"}
    assert (await client.get("access", headers=named)).json()["role"] == "look", "who says who he is, is that"
    wrong = {"authorization": "Bearer wrong"}
    assert (await client.get("access", headers=wrong)).json()["role"] == "administer"


async def test_a_browser_logs_in_with_a_named_token_and_out_again(networked: FastAPI) -> None:
    token = await bench_of(networked).tokens.add("anna", "drive")
    async with visitor(networked, **HTML) as browser:
        assert (await browser.post("/login", data={"token": token})).status_code == 303
        assert (await browser.get(f"{BASE}/access")).json() == {"name": "anna", "role": "drive", "by": "session"}
        kept = dict(browser.cookies)
        assert bench_of(networked).tokens.all()[0].name == "anna"
        gone = await browser.post(f"{BASE}/access/log-out")
        assert gone.status_code == 204
        assert "max-age=0" in gone.headers["set-cookie"].casefold()
        assert (await browser.get(f"{BASE}/access")).status_code == 401
    async with visitor(networked, cookie="; ".join(f"{name}={value}" for name, value in kept.items())) as thief:
        assert (await thief.get(f"{BASE}/access")).status_code == 401, "it ended on the server, too"


async def test_logging_in_and_out_is_in_the_audit_log(networked: FastAPI) -> None:
    token = await bench_of(networked).tokens.add("anna", "drive")
    agent = {"user-agent": "Mozilla/5.0", "stepscope-name": "bob", **HTML}
    async with visitor(networked, **agent) as browser:
        await browser.post("/login", data={"token": "wrong"})
        await browser.post("/login", data={"token": token})
        await browser.post(f"{BASE}/access/log-out")
        await browser.get("/", params={"token": TOKEN})
        audit = (await browser.get(f"{BASE}/audit")).json()["entries"]
    done, stranger = "done", "refused: the token is wrong, or revoked"
    assert [(each["action"], each["who"], each["address"], each["outcome"]) for each in reversed(audit)][-4:] == [
        ("log in", "browser@10.0.0.9", "10.0.0.9", stranger),
        ("log in", "anna", "10.0.0.9", done),
        ("log out", "anna", "10.0.0.9", done),
        ("log in", "bob", "10.0.0.9", done),
    ]
    assert audit[0]["detail"] == "with the server's own token"
    assert not {token, TOKEN, "wrong"} & set(json.dumps(audit).replace('"', " ").split())


async def test_revoking_ends_sessions(networked: FastAPI) -> None:
    token = await bench_of(networked).tokens.add("anna", "drive")
    async with visitor(networked) as browser, visitor(networked, TOKEN) as owner:
        await browser.post("/login", data={"token": token})
        assert (await browser.get(f"{BASE}/devices")).status_code == 200
        assert (await owner.delete(f"{BASE}/tokens/anna")).status_code == 204
        assert (await browser.get(f"{BASE}/devices")).status_code == 401
        again = (await owner.post(f"{BASE}/tokens", json={"name": "anna", "role": "drive"})).json()["token"]
        assert again != token
        assert (await browser.get(f"{BASE}/devices")).status_code == 401, "the new one of that name is another one"
        assert (await owner.delete(f"{BASE}/tokens/nobody")).status_code == 404


async def test_named_guesses_are_told_off_and_a_right_one_never_is(networked: FastAPI) -> None:
    token = await bench_of(networked).tokens.add("anna", "look")
    async with visitor(networked, "wrong") as thief, visitor(networked, token) as anna:
        codes = [(await thief.get(f"{BASE}/devices")).status_code for _ in range(GUESSES + 1)]
        assert codes == [401] * GUESSES + [429]
        assert (await anna.get(f"{BASE}/devices")).status_code == 200
        assert (await anna.post(f"{BASE}/stop")).status_code == 200
        assert (await thief.post(f"{BASE}/stop")).status_code == 401


async def test_a_disk_that_takes_nothing_is_told(networked: FastAPI, settings: Settings) -> None:
    lock = settings.data_dir / "tokens.json.lock"
    lock.unlink(missing_ok=True)
    lock.mkdir()  # nobody opens a directory as a file
    async with visitor(networked, TOKEN) as owner:
        refused = await owner.post(f"{BASE}/tokens", json={"name": "anna", "role": "look"})
    assert (refused.status_code, refused.json()["type"]) == (503, "/problems/store-unavailable")


# --- sockets, and the command line beside a running server ---------------------------------------


def run(data_dir: Path, *words: str) -> subprocess.CompletedProcess[str]:
    command = [str(Path(sys.executable).with_name("stepscope")), "tokens", *words, "--data-dir", str(data_dir)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


async def tokens(data_dir: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return await asyncio.to_thread(run, data_dir, *words)


async def eventually(client: httpx.AsyncClient, token: str, status: int) -> float:
    """How long it took until that token is answered so [s]."""
    began_s = asyncio.get_running_loop().time()
    async with asyncio.timeout(30):
        while True:
            answer = await client.get(f"{BASE}/access", headers={"authorization": f"Bearer {token}"})
            if answer.status_code == status:
                return asyncio.get_running_loop().time() - began_s
            await asyncio.sleep(0.02)


async def test_the_command_line_beside_a_running_server(tmp_path: Path) -> None:
    async with live_server(tmp_path, token=TOKEN) as url, httpx.AsyncClient(base_url=url) as client:
        made = await tokens(tmp_path, "add", "anna", "--role", "look")
        assert made.returncode == 0, made.stderr
        token = made.stdout.strip()
        await eventually(client, token, 200)
        socket_url = url.replace("http", "ws") + f"{BASE}/conditions"
        bearer = {"authorization": f"Bearer {token}"}
        async with connect(socket_url, additional_headers=bearer) as socket:
            await socket.recv()
            listed = await tokens(tmp_path, "list")
            assert "anna" in listed.stdout
            assert "look" in listed.stdout
            assert token not in listed.stdout
            assert (await tokens(tmp_path, "add", "anna", "--role", "drive")).returncode == 1
            assert (await tokens(tmp_path, "add", "bob", "--role", "king")).returncode == 2
            revoked = await tokens(tmp_path, "revoke", "anna")
            assert revoked.returncode == 0, revoked.stderr
            await eventually(client, token, 401)
            await socket.wait_closed()
            assert socket.close_code == 4401
        with pytest.raises(InvalidStatus):
            await connect(socket_url, additional_headers=bearer)
        missing = await tokens(tmp_path, "revoke", "anna")
        assert missing.returncode == 1
        assert "anna" in missing.stderr
        audit = await client.get(f"{BASE}/audit", headers={"authorization": f"Bearer {TOKEN}"})
        noted = {(entry["who"], entry["action"], entry["subject"]) for entry in audit.json()["entries"]}
        assert {("stepscope", "add token", "anna"), ("stepscope", "revoke token", "anna")} <= noted


async def test_log_out_ends_the_sockets_of_that_session_alone(tmp_path: Path) -> None:
    async with (
        live_server(tmp_path, token=TOKEN) as url,
        httpx.AsyncClient(base_url=url) as one,
        httpx.AsyncClient(base_url=url) as other,
    ):
        cookies = []
        for browser in (one, other):
            await browser.post("/login", data={"token": TOKEN})
            cookies.append("; ".join(f"{name}={value}" for name, value in browser.cookies.items()))
        socket_url = url.replace("http", "ws") + f"{BASE}/conditions"
        async with (
            connect(socket_url, additional_headers={"cookie": cookies[0]}) as mine,
            connect(socket_url, additional_headers={"cookie": cookies[1]}) as theirs,
        ):
            await mine.recv()
            await theirs.recv()
            assert (await one.post(f"{BASE}/access/log-out")).status_code == 204
            await mine.wait_closed()
            assert mine.close_code == 4401
            assert (await other.get(f"{BASE}/health/details")).json()["sockets"]["websockets"] == 1
            assert theirs.close_code is None


@pytest.mark.parametrize("path", ["/devices/bench/telemetry?channels=position.0", "/conditions"])
async def test_look_may_open_the_sockets_that_tell(tmp_path: Path, path: str) -> None:
    async with live_server(tmp_path, token=TOKEN, demo=True) as url:
        made = await asyncio.to_thread(TokenStore(tmp_path).add, "anna", "look")
        async with httpx.AsyncClient(base_url=url) as client:
            await eventually(client, made, 200)
        bearer = {"authorization": f"Bearer {made}"}
        async with connect(url.replace("http", "ws") + BASE + path, additional_headers=bearer) as socket:
            assert json.loads(await socket.recv())
        with pytest.raises(InvalidStatus) as refused:
            await connect(url.replace("http", "ws") + "/twin/view", additional_headers=bearer)
        assert refused.value.response.status_code == 403
