"""The lease over REST: taking, asking, handing over; scripts beside sessions; and stops, which nobody is refused."""

from __future__ import annotations

import asyncio

import httpx
import pytest
from fastapi import FastAPI

from app.api.server_state import ServerState
from app.clock import VirtualClock
from app.lease.lease import LeaseEvent
from app.main import bench_of

ANNA = {"stepscope-session": "session-of-anna-0001"}
BEN = {"stepscope-session": "session-of-ben-00002"}
AXIS = "devices/bench/axes/0"
V_MAX = "devices/bench/registers/v_max?axis=0"


@pytest.fixture
def bench(app: FastAPI) -> ServerState:
    return bench_of(app)


async def test_from_free_to_taken_and_back(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    free: dict[str, object] = {
        "state": "free",
        "holder": None,
        "mine": False,
        "since_s": None,
        "left": False,
        "expires_in_s": None,
        "asking": [],
        "on_vanish": "stop",
        "vanish_after_s": 15.0,
    }
    assert (await client.get("lease")).json() == free
    taken = await client.post("lease", json={"name": "Zoë, bench 2"}, headers=ANNA)
    mine = {"state": "taken", "holder": "Zoë, bench 2", "mine": True, "since_s": 0.0, "expires_in_s": 15.0}
    assert taken.json() == {**free, **mine}
    await clock.advance(6.0)
    theirs = {**free, **mine, "mine": False, "since_s": 6.0, "expires_in_s": 9.0}
    assert (await client.get("lease", headers=BEN)).json() == theirs
    assert (await client.put("lease", json={}, headers=ANNA)).json()["expires_in_s"] == 15.0
    assert (await client.put("lease", headers=ANNA)).status_code == 200  # without a body too
    assert (await client.delete("lease", headers=ANNA)).json() == free


async def test_the_holder_writes_and_nobody_else(client: httpx.AsyncClient) -> None:
    wanted = {"value": 700}
    assert (await client.put(V_MAX, json=wanted)).status_code == 200  # borrowed
    assert (await client.put(V_MAX, json=wanted, headers=ANNA)).json()["type"] == "/problems/bench-not-taken"
    await client.post("lease", json={"name": "Anna"}, headers=ANNA)
    assert (await client.put(V_MAX, json=wanted, headers=ANNA)).status_code == 200
    for others in ({}, BEN):
        refused = (await client.put(V_MAX, json={"value": 5}, headers=others)).json()
        assert (refused["type"], refused["status"]) == ("/problems/bench-taken", 409)
        assert refused["facts"] == {"holder": "Anna", "since_s": 0.0, "expires_in_s": 15.0}
        assert (await client.get(V_MAX, headers=others)).json()["value"] == 700


async def test_a_borrowed_call_holds_nothing_afterwards(client: httpx.AsyncClient) -> None:
    both = await asyncio.gather(*(client.put(V_MAX, json={"value": value}) for value in (400, 500)))
    assert [answer.status_code for answer in both] == [200, 200]
    assert (await client.post(f"{AXIS}/rotate", json={"velocity": 2000})).status_code == 200
    assert (await client.get("lease")).json()["state"] == "free"
    assert (await client.post("lease", json={"name": "Anna"}, headers=ANNA)).json()["mine"]


async def test_one_who_takes_it_waits_for_calls_that_have_begun(client: httpx.AsyncClient, bench: ServerState) -> None:
    taken = asyncio.Event()
    bench.lease.listen(lambda _: taken.set())
    call = bench.calls.begin()
    taking = asyncio.create_task(client.post("lease", json={"name": "Anna"}, headers=ANNA))
    await taken.wait()
    assert (await client.put(V_MAX, json={"value": 5})).status_code == 409  # none begins any more
    assert not taking.done()
    bench.calls.end(call)
    assert (await taking).json()["mine"]
    own = bench.calls.begin()
    assert (await client.post("lease", json={"name": "Anna B."}, headers=ANNA)).json()["holder"] == "Anna B."
    bench.calls.end(own)


async def test_asking_and_handing_over(client: httpx.AsyncClient, bench: ServerState) -> None:
    heard: list[LeaseEvent] = []
    bench.lease.listen(heard.append)
    await client.post("lease", json={"name": "Anna"}, headers=ANNA)
    refused = await client.post("lease", json={"name": "Ben"}, headers=BEN)
    assert refused.json()["type"] == "/problems/bench-taken"
    asked = (await client.post("lease/ask", json={"name": "Ben"}, headers=BEN)).json()
    (ben,) = asked["asking"]
    assert (ben["name"], asked["mine"]) == ("Ben", False)
    assert (await client.post("lease/hand-over", json={"to": ben["id"]}, headers=BEN)).status_code == 409
    assert (await client.post("lease/hand-over", json={"to": "x"}, headers=ANNA)).status_code == 404
    over = (await client.post("lease/hand-over", json={"to": ben["id"]}, headers=ANNA)).json()
    assert (over["holder"], over["mine"], over["asking"]) == ("Ben", False, [])
    assert (await client.put(V_MAX, json={"value": 5}, headers=ANNA)).status_code == 409
    assert (await client.put(V_MAX, json={"value": 5}, headers=BEN)).status_code == 200
    assert [event.action for event in heard] == ["taken", "handed over"]


async def test_what_runs_goes_on_when_it_changes_hands(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await client.post("lease", json={"name": "Anna"}, headers=ANNA)
    await client.post(f"{AXIS}/shuttle", json={"first": 0, "second": 2000, "dwell_s": 0.1}, headers=ANNA)
    jog = {"velocity": 2000, "hold_s": 0.5}
    await client.post("devices/bench/axes/1/rotate", json=jog, headers=ANNA)
    await client.post("lease/ask", json={"name": "Ben"}, headers=BEN)
    (ben,) = (await client.get("lease")).json()["asking"]
    await client.post("lease/hand-over", json={"to": ben["id"]}, headers=ANNA)
    kept = await client.patch("devices/bench/axes/1/rotate", json={"hold_s": 0.5}, headers=ANNA)
    assert kept.status_code == 409  # it was hers to keep up, and ends by itself
    for _ in range(60):
        await clock.advance(0.05)
    assert (await client.get(f"{AXIS}/shuttle")).json()["running"]
    assert not (await client.get("devices/bench/axes/1")).json()["moving"]
    assert (await client.delete(f"{AXIS}/shuttle", headers=ANNA)).json()["running"] is False  # a stop, so anybody's


@pytest.mark.parametrize("headers", [{}, BEN])
@pytest.mark.parametrize("path", ["stop", f"{AXIS}/stop"])
async def test_a_stop_gets_through_for_everybody(
    client: httpx.AsyncClient, clock: VirtualClock, path: str, headers: dict[str, str]
) -> None:
    await client.post("lease", json={"name": "Anna"}, headers=ANNA)
    await client.post(f"{AXIS}/rotate", json={"velocity": 5000}, headers=ANNA)
    await clock.advance(0.5)
    assert (await client.get(AXIS)).json()["moving"]
    assert (await client.post(path, headers=headers)).status_code == 200
    await clock.advance(1.0)
    assert not (await client.get(AXIS)).json()["moving"]


WRONG: list[tuple[str, str, object, dict[str, str], int]] = [
    ("POST", "lease", {"name": "Anna"}, {}, 422),
    ("POST", "lease", {"name": "Anna"}, {"stepscope-session": "too-short"}, 422),
    ("POST", "lease", {"name": "Anna"}, {"stepscope-session": "x" * 201}, 422),
    ("POST", "lease", {"name": " \u200b\t"}, ANNA, 422),
    ("POST", "lease", {"name": "x" * 61}, ANNA, 422),
    ("POST", "lease", {}, ANNA, 422),
    ("POST", "lease", {"name": "Anna", "for": "ever"}, ANNA, 422),
    ("PUT", "lease", {}, ANNA, 409),
    ("PUT", "lease", {"vanish_after_s": 1}, ANNA, 422),
    ("PUT", "lease", {"on_vanish": "explode"}, ANNA, 422),
    ("POST", "lease/hand-over", {"to": "x"}, ANNA, 409),
    ("DELETE", "lease", None, ANNA, 200),
]


async def test_what_cannot_be_asked_is_told(client: httpx.AsyncClient) -> None:
    for method, path, body, headers, status in WRONG:
        answer = await client.request(method, path, json=body, headers=headers)
        assert answer.status_code == status, f"{method} {path} {body}: {answer.text}"
        assert (await client.get("lease")).json()["state"] == "free"


async def test_the_secret_is_in_no_answer(client: httpx.AsyncClient) -> None:
    await client.post("lease", json={"name": "Anna"}, headers=ANNA)
    await client.post("lease/ask", json={"name": "Ben"}, headers=BEN)
    for answer in (
        await client.get("lease"),
        await client.get("lease", headers=BEN),
        await client.put(V_MAX, json={"value": 5}, headers=BEN),
    ):
        assert "session-of" not in answer.text
