"""Moving over REST: what starts, what arrives, what stops."""

from __future__ import annotations

import asyncio
from typing import Any

import httpx
import pytest

from app.clock import VirtualClock

AXIS = "devices/bench/axes/0"


async def rest(client: httpx.AsyncClient, clock: VirtualClock, url: str = AXIS) -> dict[str, Any]:
    for _ in range(200):
        await clock.advance(0.05)
        state: dict[str, Any] = (await client.get(url)).json()
        if not state["moving"]:
            return state
    raise AssertionError("it still moves after 10 s")


@pytest.mark.parametrize(
    ("target", "unit", "microsteps"),
    [(1600, "microsteps", 1600), (100, "fullsteps", 1600), (0.5, "rev", 1600), (-180, "deg", -1600), (4, "mm", 1600)],
)
async def test_a_move_arrives_in_any_unit(
    client: httpx.AsyncClient, clock: VirtualClock, target: float, unit: str, microsteps: int
) -> None:
    started = (await client.post(f"{AXIS}/move", json={"target": target, "unit": unit})).json()
    assert started["target_position"] == microsteps
    assert (await rest(client, clock))["position"] == microsteps


async def test_a_relative_move_counts_from_here(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    for expected in (500, 1000):
        await client.post(f"{AXIS}/move", json={"target": 500, "relative": True})
        assert (await rest(client, clock))["position"] == expected


async def test_the_prediction_is_the_move(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    assert (await client.get(f"{AXIS}/prediction")).json() is None
    started = (await client.post(f"{AXIS}/move", json={"target": 50_000})).json()
    expected = (await client.get(f"{AXIS}/prediction")).json()
    assert expected["started_at_s"] == started["started_at_s"]
    assert expected["duration_s"] == started["predicted_duration_s"]
    assert expected["position"][-1] == 50_000
    assert [phase["name"] for phase in expected["phases"]][:2] == ["acceleration", "constant velocity"]
    await clock.advance(expected["duration_s"] - 0.05)
    assert (await client.get(AXIS)).json()["moving"]
    await clock.advance(0.06)
    assert (await client.get(AXIS)).json()["position"] == 50_000


async def test_several_axes_start_together(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    moves = [{"axis": axis, "target": 1000 * (axis + 1)} for axis in range(3)]
    started = (await client.post("devices/bench/move", json={"moves": moves})).json()
    times = [move["started_at_s"] for move in started]
    assert max(times) - min(times) < 1e-3
    for axis in range(3):
        assert (await rest(client, clock, f"devices/bench/axes/{axis}"))["position"] == 1000 * (axis + 1)


async def test_of_several_moves_one_that_cannot_be_starts_none(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    moves = [{"axis": 0, "target": 1000}, {"axis": 1, "target": 1e9}]
    assert (await client.post("devices/bench/move", json={"moves": moves})).status_code == 422
    await clock.advance(0.5)
    assert (await client.get(AXIS)).json()["position"] == 0


async def test_rotating_goes_on_until_stopped(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    rotating = (await client.post(f"{AXIS}/rotate", json={"velocity": -20, "unit": "mm_per_s"})).json()
    assert rotating["velocity_pps"] == pytest.approx(-20 * 400, rel=0.01)
    await clock.advance(1.0)
    state = (await client.get(AXIS)).json()
    assert state["mode"] == "VELOCITY_MODE"
    assert state["velocity_pps"] == rotating["velocity_pps"]
    stopped = (await client.post(f"{AXIS}/stop")).json()
    assert stopped["ok"]
    assert (await rest(client, clock))["velocity_pps"] == 0


@pytest.mark.parametrize("mode", ["ramp", "immediate"])
async def test_both_ways_to_stop(client: httpx.AsyncClient, clock: VirtualClock, mode: str) -> None:
    await client.post(f"{AXIS}/rotate", json={"velocity": 40_000})
    await clock.advance(1.0)
    before = (await client.get(AXIS)).json()["position"]
    assert (await client.post(f"{AXIS}/stop", json={"mode": mode})).json()["ok"]
    after = await rest(client, clock)
    way = after["position"] - before
    assert (way > 1000) if mode == "ramp" else (way < 100)


async def test_stop_all_stops_every_axis_of_every_device(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    axes = [f"devices/bench/axes/{axis}" for axis in range(3)] + ["devices/slider/axes/0"]
    for url in axes:
        assert (await client.post(f"{url}/rotate", json={"velocity": 5000})).status_code == 200
    await clock.advance(0.5)
    for url in axes:
        assert (await client.get(url)).json()["moving"]
    results = (await client.post("stop")).json()["results"]
    assert [(result["device"], result["axis"], result["ok"]) for result in results] == [
        ("bench", 0, True),
        ("bench", 1, True),
        ("bench", 2, True),
        ("slider", 0, True),
    ]
    for url in axes:
        assert (await rest(client, clock, url))["velocity_pps"] == 0


async def test_a_stop_overtakes_a_thousand_reads_on_a_wire(far_chip: int, client: httpx.AsyncClient) -> None:
    link = {"kind": "tcp", "host": "127.0.0.1", "port": far_chip}
    assert (await client.post("devices", json={"name": "far", "model": "tmc428", "link": link})).status_code == 201
    reads = [asyncio.ensure_future(client.get("devices/far/registers")) for _ in range(20)]
    while not (await client.get("devices/far/registers/v_max?axis=0")).is_success:
        pass
    results = (await client.post("stop")).json()["results"]
    assert not any(read.done() for read in reads)
    assert all(result["ok"] for result in results)
    assert {answer.status_code for answer in await asyncio.gather(*reads)} == {200}


@pytest.mark.parametrize(
    ("url", "body", "status"),
    [
        (f"{AXIS}/move", {"target": 2**23}, 422),
        (f"{AXIS}/move", {"target": 1e300}, 422),
        (f"{AXIS}/move", {"target": 1, "unit": "inch"}, 422),
        (f"{AXIS}/move", {"target": 0.5}, 200),
        (f"{AXIS}/rotate", {"velocity": 1e9}, 422),
        (f"{AXIS}/stop", {"mode": "never"}, 422),
        ("devices/bench/axes/3/move", {"target": 1}, 404),
        ("devices/bench/axes/-1/move", {"target": 1}, 422),
        ("devices/bench/axes/x/move", {"target": 1}, 422),
        ("devices/nothing/axes/0/move", {"target": 1}, 404),
        ("devices/bench/move", {"moves": []}, 422),
        ("devices/bench/move", {"moves": [{"axis": 0, "target": 1}, {"axis": 0, "target": 2}]}, 422),
        (f"{AXIS}/shuttle", {"first": 1, "second": 1}, 422),
        (f"{AXIS}/reference-search", {"velocity": -1}, 422),
    ],
)
async def test_what_cannot_be_asked_is_told(
    client: httpx.AsyncClient, url: str, body: dict[str, object], status: int
) -> None:
    answer = await client.post(url, json=body)
    assert answer.status_code == status, answer.text


async def test_a_device_that_vanishes_during_a_move_is_told_and_comes_back(
    client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    await client.post(f"{AXIS}/move", json={"target": 50_000})
    await clock.advance(0.3)
    assert (await client.patch("devices/bench/emulator", json={"faults": {"unplugged": True}})).status_code == 200
    for method, url, body in (
        ("GET", AXIS, None),
        ("GET", "devices/bench/registers/v_max?axis=0", None),
        ("PUT", "devices/bench/registers/v_max?axis=0", {"value": 5}),
        ("POST", f"{AXIS}/move", {"target": 0}),
    ):
        answer = await client.request(method, url, json=body)
        assert (answer.status_code, answer.json()["type"]) == (409, "/problems/not-connected")
    stops = (await client.post("stop")).json()["results"]
    assert [stop["ok"] for stop in stops] == [False, False, False, True]
    assert stops[0]["problem"]["type"] == "/problems/not-connected"
    assert (await client.get("devices/bench")).json()["state"] == "failed"
    assert (await client.get("health")).status_code == 200
    assert (await client.get("devices/slider/axes/0")).status_code == 200
    await client.patch("devices/bench/emulator", json={"faults": {"unplugged": False}})
    await clock.advance(5.0)
    assert (await client.get("devices/bench")).json()["state"] == "connected"
    assert (await client.post("stop")).json()["results"][0]["ok"]
    assert (await client.get(AXIS)).json()["velocity_pps"] == 0


async def test_a_silent_device_is_504(client: httpx.AsyncClient) -> None:
    await client.patch("devices/bench/emulator", json={"faults": {"silence": True}})
    answer = await client.get(AXIS)
    assert (answer.status_code, answer.json()["type"]) == (504, "/problems/no-reply")


async def test_a_power_cut_is_no_secret(client: httpx.AsyncClient) -> None:
    state = (await client.patch("devices/bench/emulator", json={"power_cycle": True})).json()
    assert state["driver_chain"]["endless"] in (True, False)
    answer = await client.post(f"{AXIS}/move", json={"target": 100})
    assert answer.status_code == 409, "v_max and a_max are 0 after power-on"


async def test_a_shuttle_runs_until_another_command_ends_it(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    body = {"first": -2000, "second": 2000, "dwell_s": 0.1}
    assert (await client.post(f"{AXIS}/shuttle", json=body)).json()["running"]
    again = await client.post(f"{AXIS}/shuttle", json=body)
    assert again.status_code == 409
    await clock.advance(5.0)
    assert (await client.get(f"{AXIS}/shuttle")).json()["cycles"] >= 2
    await client.post("stop")
    await clock.advance(1.0)
    state = (await client.get(f"{AXIS}/shuttle")).json()
    assert not state["running"]
    assert state["message"]


async def test_a_reference_search_centres_the_switch(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    url = f"{AXIS}/reference-search"
    assert (await client.get(url)).json()["state"] == "idle"
    assert (await client.post(url)).json()["state"] == "running"
    state = {}
    for _ in range(600):
        await clock.advance(0.1)
        state = (await client.get(url)).json()
        if state["state"] != "running":
            break
    assert state["state"] == "done", state
    emulator = (await client.get("devices/bench/emulator")).json()["axes"][0]
    assert (await client.get(AXIS)).json()["position"] == 0
    assert emulator["position_fullsteps"] == pytest.approx(300, abs=1)


async def test_a_reference_search_can_be_aborted(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    url = f"{AXIS}/reference-search"
    await client.post(url, json={"switch": "left"})
    await clock.advance(0.5)
    aborting = asyncio.ensure_future(client.delete(url))
    await clock.advance(2.0)
    assert (await aborting).json()["state"] == "aborted"
    assert (await rest(client, clock))["velocity_pps"] == 0
