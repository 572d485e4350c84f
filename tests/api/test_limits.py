"""Soft limits over REST: set with a connection, told with it, kept on every route, stored."""

from __future__ import annotations

import asyncio
import json

import httpx
import pytest

from app.clock import VirtualClock
from app.settings import Settings

LIMITS = {"position_min": -3000, "position_max": 5000, "velocity_max_pps": 20000.0}
NONE = dict.fromkeys(
    (
        "position_min",
        "position_max",
        "velocity_max_pps",
        "acceleration_max_pps2",
        "current_max_a",
        "sense_resistor_ohm",
        "current_full_scale_a",
    )
)


async def add(client: httpx.AsyncClient, model: str, **limits: object) -> str:
    body = {"name": f"a {model}", "model": model, "link": {"kind": "emulator"}, "axes": [{"limits": limits}]}
    answer = await client.post("/devices", json=body)
    assert answer.status_code == 201, answer.text
    assert answer.json()["axes"][0]["limits"] == {**NONE, **limits}
    assert answer.json()["axes"][0]["limit_warnings"] == []
    return str(answer.json()["id"])


REFUSED = [
    ("POST", "axes/0/move", {"target": 5001}, "position"),
    ("POST", "move", {"moves": [{"axis": 0, "target": -3001}]}, "position"),
    ("POST", "axes/0/rotate", {"velocity": 20001}, "velocity"),
    ("POST", "axes/0/shuttle", {"first": 0, "second": 6000}, "position"),
    ("PUT", "registers/VMAX?axis=0", {"value": 8_000_000}, "velocity"),
    ("PUT", "registers/XTARGET?axis=0", {"value": 9000}, "position"),
    (
        "POST",
        "registers",
        {"writes": [{"name": "AMAX", "axis": 0, "value": 5}, {"name": "VMAX", "axis": 0, "value": 8_000_000}]},
        "velocity",
    ),
    ("POST", "exchange", {"frame": "a7 00 7a 12 00"}, "velocity"),
    ("POST", "axes/0/start-up", {"velocity_pps": 30000, "acceleration_pps2": 100000}, "velocity"),
]


@pytest.mark.parametrize(("method", "path", "body", "quantity"), REFUSED)
async def test_every_route_refuses_what_is_beyond(
    client: httpx.AsyncClient, method: str, path: str, body: dict[str, object], quantity: str
) -> None:
    device = await add(client, "tmc5160", **LIMITS)
    started = await client.post(
        f"/devices/{device}/axes/0/start-up", json={"velocity_pps": 15000, "acceleration_pps2": 100000}
    )
    assert started.status_code == 200, started.text
    answer = await client.request(method, f"/devices/{device}/{path}", json=body)
    assert answer.status_code == 422, answer.text
    problem = answer.json()
    assert problem["type"] == "/problems/soft-limit"
    assert problem["way_out"]
    facts = problem["facts"]
    assert {"quantity", "wanted", "limit", "axis", "unit"} <= facts.keys()
    assert (facts["quantity"], facts["axis"]) == (quantity, 0)
    assert facts["limit"] in LIMITS.values()


async def test_limits_are_changed_told_and_taken_away(client: httpx.AsyncClient) -> None:
    device = await add(client, "tmc5160", **LIMITS)
    await client.post(f"/devices/{device}/axes/0/start-up", json={"velocity_pps": 15000, "acceleration_pps2": 100000})
    lower = {"axes": [{"name": "X", "limits": {"velocity_max_pps": 100.0}}]}
    answer = await client.patch(f"/devices/{device}", json=lower)
    axis = answer.json()["axes"][0]
    assert axis["limits"] == {**NONE, "velocity_max_pps": 100.0}
    assert len(axis["limit_warnings"]) == 1
    assert "above the limit of 100 pps: write VMAX 104 or less" in axis["limit_warnings"][0]
    assert (await client.post(f"/devices/{device}/axes/0/move", json={"target": 10})).status_code == 422
    stopped = await client.post(f"/devices/{device}/axes/0/stop", json={})
    assert stopped.status_code == 200
    gone = await client.patch(f"/devices/{device}", json={"axes": [{"name": "X"}]})
    assert gone.json()["axes"][0]["limits"] == NONE
    assert (await client.post(f"/devices/{device}/axes/0/move", json={"target": 10})).status_code == 200


async def test_a_rotation_ends_at_the_limit(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    device = await add(client, "tmc5160", **LIMITS)
    await client.post(f"/devices/{device}/axes/0/start-up", json={"velocity_pps": 15000, "acceleration_pps2": 100000})
    assert (await client.post(f"/devices/{device}/axes/0/rotate", json={"velocity": 15000})).status_code == 200
    await clock.advance(3.0)
    state = (await client.get(f"/devices/{device}/axes/0")).json()
    assert state["moving"] is False
    assert 4000 < state["position"] <= 5000


async def test_limits_are_stored_with_the_connection(client: httpx.AsyncClient, settings: Settings) -> None:
    await add(client, "tmc428", **LIMITS)
    for _ in range(200):
        path = settings.data_dir / "connections.json"
        if path.exists() and "position_max" in path.read_text():
            break
        await asyncio.sleep(0.01)
    kept = json.loads((settings.data_dir / "connections.json").read_text())["connections"]
    entry = next(connection for connection in kept if connection["name"] == "a tmc428")
    assert entry["axes"][0]["limits"] == {**NONE, **LIMITS}


@pytest.mark.parametrize(
    ("model", "limits", "text"),
    [
        ("tmc428", {"position_min": 5, "position_max": 1}, "not above position_max"),
        ("tmc5160", {"current_max_a": 1.0}, "sense_resistor_ohm"),
        ("tmc4210", {"current_max_a": 1.0}, "driver"),
        ("tmc428", {"velocity_max_pps": 0}, "greater than 0"),
        ("tmc428", {"speed": 5}, "Extra inputs"),
    ],
)
async def test_limits_that_cannot_be_are_refused(
    client: httpx.AsyncClient, model: str, limits: dict[str, object], text: str
) -> None:
    body = {"name": "x", "model": model, "link": {"kind": "emulator"}, "axes": [{"limits": limits}]}
    answer = await client.post("/devices", json=body)
    assert answer.status_code == 422
    assert text in answer.json()["detail"]
