"""The 3D view over REST, and its picture under our own origin."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import httpx
import msgspec
import pytest
import viser
import websockets
from websockets.asyncio.client import ClientConnection
from websockets.typing import Origin, Subprotocol

from app.api.twin.proxy import policy
from app.connections import MESSAGE_BYTES_MAX
from tests.api.live import live_server

PROTOCOL = Subprotocol(f"viser-v{viser.__version__}")
CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": (1.0, 0.0, 0.0, 0.0),
    "position": (0.0, -9.0, 0.0),
    "fov": 0.5,
    "near": 0.1,
    "far": 100.0,
    "image_height": 100,
    "image_width": 100,
    "look_at": (0.0, 0.0, 0.0),
    "up_direction": (0.0, 0.0, 1.0),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("twin")


@pytest.fixture
async def url(folder: Path) -> AsyncIterator[str]:
    async with live_server(folder, demo=True) as url:
        yield url


@pytest.fixture
async def client(url: str) -> AsyncIterator[httpx.AsyncClient]:
    async with httpx.AsyncClient(base_url=url, timeout=40) as client:
        yield client


def view(url: str, **options: Any) -> websockets.connect:
    wanted: dict[str, Any] = {"subprotocols": [PROTOCOL], "max_size": None, "origin": Origin(url), **options}
    return websockets.connect(f"{url.replace('http', 'ws')}/twin/view", **wanted)


async def until(client: httpx.AsyncClient, path: str, done: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    """What `path` answers once it is so."""
    for _ in range(600):
        answer: dict[str, Any] = (await client.get(path)).json()
        if done(answer):
            return answer
        await asyncio.sleep(0.05)
    raise AssertionError(f"{path} still answers {answer}")


async def closed(socket: ClientConnection) -> int | None:
    """The code with which the server ends a socket."""
    async with asyncio.timeout(20):
        await socket.wait_closed()
    return socket.close_code


async def test_a_whole_life(url: str, client: httpx.AsyncClient) -> None:
    off = (await client.get("/api/v1/twin")).json()
    assert (off["state"], off["path"]) == ("off", None)
    assert (await client.get("/twin/view/")).status_code == 409
    on = await client.post("/api/v1/twin", json={"device": "bench", "axis": 1, "scheme": "dark"})
    assert on.status_code == 200, on.text
    assert on.json() | {"state": "on", "device": "bench", "axis": 1, "name": "Y", "place_unit": "mm"} == on.json()
    await the_page(client, on.json()["path"])
    async with view(url) as socket:
        assert socket.subprotocol == PROTOCOL
        await socket.send(msgspec.msgpack.encode(CAMERA))
        assert isinstance(await socket.recv(), bytes)
        state = await until(client, "/api/v1/twin", lambda state: bool(state["look"] and state["look"]["time_s"]))
        assert state["viewers"] == 1
        assert state["look"]["position"] is not None
        assert state["look"]["current_a"] is None  # a TMC428 does not tell it
        gone = (await client.delete("/api/v1/twin")).json()
        assert gone["state"] == "off"
        assert await closed(socket) == 1001


async def the_page(client: httpx.AsyncClient, path: str) -> None:
    page = await client.get(path, headers={"accept-encoding": "gzip"})
    assert page.status_code == 200
    assert page.headers["content-encoding"] == "gzip"
    rules = page.headers["content-security-policy"]
    assert "frame-ancestors 'self'" in rules
    assert "default-src 'none'" in rules
    assert "'unsafe-eval'" not in rules
    assert "'unsafe-inline'" not in rules.partition("script-src")[2].partition(";")[0]
    assert "http" not in rules  # no other origin
    again = await client.get(path, headers={"if-none-match": page.headers["etag"]})
    assert again.status_code == 304
    plain = await client.get(path, headers={"accept-encoding": "identity"})
    assert plain.content == page.content
    assert (await client.head(path)).status_code == 200
    # viser's folder is not ours to show, and nothing else is at this address
    for other in ("index.html", "../view/index.html", "%2e%2e/x", "assets/x.js"):
        assert (await client.get(f"{path}{other}")).status_code == 404
    assert (await client.post(path, content=b"x")).status_code == 405
    # the rest of the program keeps its own policy: nobody may frame it
    assert (await client.get("/twin")).headers["content-security-policy"].endswith("frame-ancestors 'none'")


async def test_what_may_not_come_in(url: str, client: httpx.AsyncClient) -> None:
    on = await client.post("/api/v1/twin", json={"device": "bench"})
    assert on.status_code == 200, on.text
    for options in (
        {"origin": Origin("https://evil.example")},
        {"origin": Origin("null")},
        {"additional_headers": {"host": "evil.example"}, "origin": None},
    ):
        with pytest.raises(websockets.InvalidStatus) as refused:
            async with view(url, **options):
                pass
        assert refused.value.response.status_code == 403
    assert (await client.get("/twin/view/", headers={"host": "evil.example"})).status_code == 403
    with pytest.raises(websockets.InvalidStatus):
        async with view(url, subprotocols=[Subprotocol("chat")]):
            pass
    with pytest.raises(websockets.InvalidStatus):
        async with websockets.connect(f"{url.replace('http', 'ws')}/twin/view/else", subprotocols=[PROTOCOL]):
            pass
    for message, code in (("text", 1003), (b"x" * (MESSAGE_BYTES_MAX + 1), 1009)):
        async with view(url) as socket:
            await socket.send(message)
            assert await closed(socket) == code
    # A page that asks for viser's public tunnel gets none, and the view lives on.
    async with view(url) as socket:
        await socket.send(msgspec.msgpack.encode(CAMERA))
        await socket.send(msgspec.msgpack.encode({"type": "ShareUrlRequest"}))
        await socket.recv()
    assert (await client.get("/api/v1/twin")).json()["state"] == "on"


async def test_with_a_token_the_view_asks_for_it(tmp_path: Path) -> None:
    async with live_server(tmp_path, demo=False, token="open sesame") as url:
        async with httpx.AsyncClient(base_url=url) as client:
            assert (await client.get("/twin/view/")).status_code == 401
            assert (await client.get("/api/v1/twin")).status_code == 401
        with pytest.raises(websockets.InvalidStatus) as refused:
            async with view(url):
                pass
        assert refused.value.response.status_code == 401


@pytest.mark.parametrize(
    ("body", "status"),
    [
        ({"device": "nobody"}, 404),
        ({"device": "bench", "axis": 9}, 404),
        ({"device": "bench", "axis": -1}, 422),
        ({"device": "bench", "scheme": "pink"}, 422),
        ({}, 422),
    ],
)
async def test_what_cannot_be_shown(client: httpx.AsyncClient, body: dict[str, object], status: int) -> None:
    answer = await client.post("/api/v1/twin", json=body)
    assert answer.status_code == status
    assert answer.headers["content-type"] == "application/problem+json"
    assert (await client.get("/api/v1/twin")).json()["state"] == "off"


async def test_a_cursor_scrubs_a_recording(client: httpx.AsyncClient) -> None:
    assert (await client.post("/api/v1/twin/cursor", json={"recording": None})).json()["state"] == "off"
    recording = await a_recording(client)
    await client.post("/api/v1/twin", json={"device": "slider"})
    shown = await client.post("/api/v1/twin/cursor", json={"recording": recording, "time_s": 0.2})
    assert shown.status_code == 200, shown.text
    assert shown.json() | {"following": "recording", "recording": recording, "recording_time_s": 0.2} == shown.json()
    assert (shown.json()["device"], shown.json()["name"]) == ("bench", "X")  # the recording's own axis
    assert shown.json()["channels"] == ["position", "velocity"]
    unknown = await client.post("/api/v1/twin/cursor", json={"recording": "20200101-000000-0000"})
    assert unknown.status_code == 404
    live = (await client.post("/api/v1/twin/cursor", json={"recording": None})).json()
    assert (live["following"], live["device"]) == ("telemetry", "slider")


async def a_recording(client: httpx.AsyncClient) -> str:
    body = {"device": "bench", "channels": ["position.0", "velocity.0"], "rate_hz": 200, "duration_s": 0.4}
    recording = (await client.post("/api/v1/recordings", json=body)).json()["id"]
    await until(client, f"/api/v1/recordings/{recording}", lambda state: bool(state["state"] == "done"))
    return str(recording)


def test_the_policy_is_narrow_also_where_the_scripts_are_not_known() -> None:
    assert "'unsafe-inline' 'wasm-unsafe-eval'" in policy(())
    assert "default-src 'none'" in policy(())
