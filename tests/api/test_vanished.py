"""The session that had the bench has vanished: what happens to the motors of every family."""

from __future__ import annotations

import contextlib
from collections.abc import Awaitable, Callable
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from app.lease.lease import LeaseEvent
from app.main import bench_of
from tests.api import test_tmc5xxx, test_tmc4361

ANNA = {"stepscope-session": "session-of-anna-0001"}
BEN = {"stepscope-session": "session-of-ben-00002"}
AXIS = "devices/bench/axes/0"
WAY = 20_000
"""So far takes 10 s at that speed: longer than it takes to notice that somebody has vanished."""


async def chip428(client: httpx.AsyncClient) -> tuple[str, dict[str, int]]:
    return "devices/bench", {"v_max": 33}


async def chip4210(client: httpx.AsyncClient) -> tuple[str, dict[str, int]]:
    return "devices/slider", {"v_max": 33}


async def chip4361(client: httpx.AsyncClient) -> tuple[str, dict[str, int]]:
    link = {"kind": "emulator"}
    assert (await client.post("devices", json={"name": "Slide", "model": "tmc4361", "link": link})).is_success
    writes = [{"name": name, "axis": 0, **body} for name, body in test_tmc4361.SETUP]
    assert (await client.post("devices/slide/registers", json={"writes": writes})).json()["failed"] is None
    return "devices/slide", {"VMAX": 2000 * 256}


async def chip5072(client: httpx.AsyncClient) -> tuple[str, dict[str, int]]:
    return await test_tmc5xxx.connected(client, "tmc5072"), {"VMAX": 2100}


async def module(client: httpx.AsyncClient) -> tuple[str, dict[str, int]]:
    link = {"kind": "emulator"}
    assert (await client.post("devices", json={"name": "Motor", "model": "pd42-1241", "link": link})).is_success
    return "devices/motor", {"maximum_positioning_speed": 2000}


FAMILIES = [chip428, chip4210, chip4361, chip5072, module]
CASES = [(chip428, "nothing"), *((family, how) for family in FAMILIES for how in ("stop", "hold"))]
Family = Callable[[httpx.AsyncClient], Awaitable[tuple[str, dict[str, int]]]]
"""Adds a device and sets it up: its address, and what makes it go at some 2000 pps."""


async def slow(client: httpx.AsyncClient, family: Family) -> str:
    """The address of an axis that goes at some 2000 pps."""
    device, speed = await family(client)
    for name, value in speed.items():
        put = await client.put(f"{device}/registers/{name}?axis=0", json={"value": value})
        assert put.is_success, put.text
    return f"{device}/axes/0"


async def silence(clock: VirtualClock, seconds: float) -> None:
    """So long nobody says anything: to within a quarter second, whatever has to wake in between."""
    while seconds > 1e-6:
        await clock.advance(min(seconds, 0.25))
        seconds -= 0.25


async def state_of(client: httpx.AsyncClient, axis: str) -> dict[str, Any]:
    state: dict[str, Any] = (await client.get(axis)).json()
    return state


async def take(client: httpx.AsyncClient, on_vanish: str) -> None:
    assert (await client.post("lease", json={"name": "Anna"}, headers=ANNA)).json()["mine"]
    put = await client.put("lease", json={"on_vanish": on_vanish, "vanish_after_s": 6.0}, headers=ANNA)
    assert put.json()["on_vanish"] == on_vanish


@pytest.mark.parametrize(("family", "on_vanish"), CASES)
async def test_a_rotation(client: httpx.AsyncClient, clock: VirtualClock, family: Family, on_vanish: str) -> None:
    axis = await slow(client, family)
    await take(client, on_vanish)
    assert (await client.post(f"{axis}/rotate", json={"velocity": -1500}, headers=ANNA)).is_success
    await silence(clock, 5.9)
    assert (await state_of(client, axis))["moving"]
    assert (await client.get("lease")).json()["holder"] == "Anna"
    await silence(clock, 2.0)
    assert (await client.get("lease")).json()["state"] == "free"
    assert (await state_of(client, axis))["moving"] is (on_vanish == "nothing")


@pytest.mark.parametrize(("family", "on_vanish"), CASES)
async def test_a_move_to_a_target(
    client: httpx.AsyncClient, clock: VirtualClock, family: Family, on_vanish: str
) -> None:
    axis = await slow(client, family)
    await take(client, on_vanish)
    move = await client.post(f"{axis}/move", json={"target": WAY, "relative": True}, headers=ANNA)
    assert move.json()["warnings"] == []
    await silence(clock, 5.9)
    assert (await state_of(client, axis))["moving"]
    await silence(clock, 1.5)
    assert (await client.get("lease")).json()["state"] == "free"
    assert (await state_of(client, axis))["moving"] is (on_vanish != "stop")
    await silence(clock, 6.0)
    state = await state_of(client, axis)
    assert not state["moving"]
    assert (state["position"] == move.json()["target_position"]) is (on_vanish != "stop")


@pytest.mark.parametrize("on_vanish", ["stop", "hold"])
async def test_a_shuttle_and_a_search_end(client: httpx.AsyncClient, clock: VirtualClock, on_vanish: str) -> None:
    x, y = (f"devices/bench/axes/{axis}" for axis in (0, 1))
    await take(client, on_vanish)
    body = {"first": 0, "second": 4000, "dwell_s": 0.5}
    assert (await client.post(f"{x}/shuttle", json=body, headers=ANNA)).json()["running"]
    search = await client.post(f"{y}/reference-search", json={"velocity": 1000}, headers=ANNA)
    assert search.json()["state"] == "running"
    await silence(clock, 5.9)
    assert (await client.get(f"{x}/shuttle")).json()["running"]
    await silence(clock, 3.0)
    ended = (await client.get(f"{x}/shuttle")).json()
    assert not ended["running"]
    assert "vanished" in ended["message"]
    search_ended = (await client.get(f"{y}/reference-search")).json()
    assert (search_ended["state"], "vanished" in search_ended["message"]) == ("aborted", True)
    for axis in (x, y):
        assert not (await state_of(client, axis))["moving"]


async def test_with_nothing_a_shuttle_goes_on(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await take(client, "nothing")
    body = {"first": 0, "second": 4000, "dwell_s": 0.1}
    await client.post("devices/bench/axes/0/shuttle", json=body, headers=ANNA)
    await silence(clock, 9.0)
    assert (await client.get("lease")).json()["state"] == "free"
    assert (await client.get("devices/bench/axes/0/shuttle")).json()["running"]


async def test_giving_it_back_is_not_vanishing(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    axis = await slow(client, chip428)
    await take(client, "stop")
    await client.post(f"{axis}/rotate", json={"velocity": 1000}, headers=ANNA)
    await client.delete("lease", headers=ANNA)
    await silence(clock, 9.0)
    assert (await state_of(client, axis))["moving"]


async def test_signs_of_life_keep_everything_going(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    axis = await slow(client, chip428)
    await take(client, "stop")
    await client.post(f"{axis}/rotate", json={"velocity": 1000}, headers=ANNA)
    for sign in range(6):
        await silence(clock, 4.0)
        await client.get("lease" if sign % 2 else axis, headers=ANNA)  # any request is one, one that only reads too
    assert (await state_of(client, axis))["moving"]
    assert (await client.get("lease", headers=ANNA)).json()["mine"]


async def test_it_is_noticed_though_nobody_asks_and_told_once(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    heard: list[LeaseEvent] = []
    bench_of(app).lease.listen(heard.append)
    await take(client, "nothing")
    await silence(clock, 20.0)
    assert [(event.action, event.name) for event in heard] == [("taken", "Anna"), ("set", "Anna"), ("vanished", "Anna")]


async def test_a_longer_time_set_late_counts(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await take(client, "stop")
    await silence(clock, 5.0)
    await client.put("lease", json={"vanish_after_s": 60}, headers=ANNA)
    await silence(clock, 59.0)
    assert (await client.get("lease")).json()["state"] == "taken"
    await client.put("lease", json={"vanish_after_s": 6}, headers=ANNA)
    await silence(clock, 6.1)
    assert (await client.get("lease")).json()["state"] == "free"


async def test_a_motor_that_this_server_never_moved_is_left_alone(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    axis = await slow(client, chip428)
    await client.post(f"{axis}/rotate", json={"velocity": 1000})
    device = bench_of(app).manager.get("bench")
    device.session.motion_commands[0] = 0  # as after a restart: the motor turned before this server was there
    await take(client, "stop")
    await silence(clock, 9.0)
    assert (await state_of(client, axis))["moving"]


async def test_a_device_that_is_away_is_stopped_when_it_is_back(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    axis = await slow(client, chip428)
    await take(client, "stop")
    await client.post(f"{axis}/rotate", json={"velocity": 1000}, headers=ANNA)
    silent = {"faults": {"silence": True}}
    assert (await client.patch("devices/bench/emulator", json=silent, headers=ANNA)).is_success
    await silence(clock, 12.0)
    assert (await client.get("lease")).json()["state"] == "free"
    await client.patch("devices/bench/emulator", json={"faults": {"silence": False}})
    await silence(clock, 4.0)
    assert not (await state_of(client, axis))["moving"]


async def test_what_the_next_one_moves_is_not_stopped(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    axis = await slow(client, chip428)
    await take(client, "stop")
    await client.patch("devices/bench/emulator", json={"faults": {"silence": True}}, headers=ANNA)
    await client.post(f"{axis}/rotate", json={"velocity": 1000}, headers=ANNA)
    await silence(clock, 8.0)
    assert (await client.post("lease", json={"name": "Ben"}, headers=BEN)).json()["mine"]
    await client.patch("devices/bench/emulator", json={"faults": {"silence": False}}, headers=BEN)
    await silence(clock, 2.0)
    assert (await client.post(f"{axis}/rotate", json={"velocity": 1000}, headers=BEN)).is_success
    await silence(clock, 3.0)
    assert (await state_of(client, axis))["moving"]


async def test_a_page_that_closes_frees_a_bench_at_rest(client: httpx.AsyncClient) -> None:
    await take(client, "stop")
    left = (await client.post("lease/leave", headers=ANNA)).json()
    assert (left["state"], left["left"]) == ("free", False)


@pytest.mark.parametrize("how", ["dies", "is back", "was one of two", "says more", "leaves the motor to go on"])
async def test_a_page_that_could_not_say_that_it_closes(
    client: httpx.AsyncClient, clock: VirtualClock, app: FastAPI, how: str
) -> None:
    bench = bench_of(app)
    session = ANNA["stepscope-session"]
    await take(client, "nothing" if how == "leaves the motor to go on" else "stop")
    if how == "leaves the motor to go on":
        assert (await client.post(f"{AXIS}/rotate", json={"velocity": 2000}, headers=ANNA)).is_success
    with contextlib.ExitStack() as other:
        if how == "was one of two":
            other.enter_context(bench.pages.page(session))
        with bench.pages.page(session):
            await silence(clock, 5.0)
        await silence(clock, 0.25)
        await client.get("lease", headers=ANNA)  # was still on its way
        if how == "is back":
            other.enter_context(bench.pages.page(session))
        await silence(clock, 1.0)
        if how == "says more":  # its socket is broken, and it is not
            await client.get("lease", headers=ANNA)
        await silence(clock, 1.0)
        free = (await client.get("lease")).json()["state"] == "free"
        assert free is (how in ("dies", "leaves the motor to go on"))


@pytest.mark.parametrize("how", ["back", "nobody", "another"])
async def test_a_page_that_closes_while_its_motor_moves(
    client: httpx.AsyncClient, clock: VirtualClock, how: str
) -> None:
    axis = await slow(client, chip428)
    await take(client, "stop")
    assert (await client.post(f"{axis}/rotate", json={"velocity": 2000}, headers=ANNA)).is_success
    await silence(clock, 1.0)
    left = (await client.post("lease/leave", headers=ANNA)).json()
    assert (left["state"], left["left"], left["mine"]) == ("taken", True, True)
    if how == "back":  # loaded anew: nothing is lost, nothing stops
        await silence(clock, 4.0)
        assert (await client.get("lease", headers=ANNA)).json()["left"] is False
        await silence(clock, 4.0)
    elif how == "another":  # whose motor it is then
        assert (await client.post("lease", json={"name": "Ben"}, headers=BEN)).json()["mine"]
        for _ in range(3):
            await silence(clock, 4.0)
            await client.get("lease", headers=BEN)
    else:
        await silence(clock, 12.0)
    assert (await state_of(client, axis))["moving"] is (how != "nobody")
