"""Start-up over REST: every model from power-on, the cure beside a refusal, and emulators that arrive set up."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.client import AsyncBench
from app.clock import VirtualClock
from app.main import bench_of, create_app
from app.profiles.capture import read_held
from app.registers.catalog import MODELS
from app.settings import Settings


async def added(client: httpx.AsyncClient, model: str, **more: Any) -> dict[str, Any]:
    body = {"name": "New", "model": model, "link": {"kind": "emulator"}, **more}
    answer = await client.post("devices", json=body)
    assert answer.status_code == 201, answer.text
    device: dict[str, Any] = answer.json()
    assert device["state"] == "connected", device["problem"]
    return device


async def arrives(client: httpx.AsyncClient, clock: VirtualClock, axis: int, target: int) -> None:
    for _ in range(40):
        await clock.advance(0.1)
        state = (await client.get(f"devices/new/axes/{axis}")).json()
        if not state["moving"] and state["position_reached"]:
            break
    assert state["position"] == target


TOLD = [name for name, model in MODELS.items() if model.counts_position or model.can("own_velocity")]
"""Those that can be told to move, and so refuse it."""


async def sets_off(client: httpx.AsyncClient, model: str, axis: int, target: int) -> httpx.Response:
    """Send it to `target`, or that way on and on where it counts no position, by steps from outside if need be."""
    if MODELS[model].counts_position:
        return await client.post(f"devices/new/axes/{axis}/move", json={"target": target})
    if not MODELS[model].can("own_velocity"):
        return await client.patch("devices/new/emulator", json={"pins": {"step_hz": 10 * target}})
    return await client.post(f"devices/new/axes/{axis}/rotate", json={"velocity": 10 * target})


async def gets_there(client: httpx.AsyncClient, clock: VirtualClock, model: str, axis: int, target: int) -> None:
    """It arrives, or turns that fast where it counts no position."""
    if MODELS[model].counts_position:
        await arrives(client, clock, axis, target)
        return
    await clock.advance(1)
    state = (await client.get(f"devices/new/axes/{axis}")).json()
    if MODELS[model].spi is None:  # else it tells no speed
        assert state["velocity_pps"] == pytest.approx(10 * target, rel=0.005)
    assert state["moving"]


async def cannot_move(client: httpx.AsyncClient, model: str) -> None:
    """Nothing, for a chip with a ramp after power-on; others are set so."""
    if MODELS[model].kind == "module":  # its memory knows a speed: a user has set it to 0
        await client.put("devices/new/registers/maximum_positioning_speed", json={"value": 0})
    elif not MODELS[model].counts_position:  # its bridges are on: a user has switched them off
        await client.put("devices/new/registers/CHOPCONF", json={"fields": {"toff": 0}})


@pytest.mark.parametrize("model", TOLD)
async def test_the_cure_is_in_the_refusal_and_one_move_then_arrives(
    client: httpx.AsyncClient, app: FastAPI, clock: VirtualClock, model: str
) -> None:
    device = await added(client, model)
    assert device["start_up"] is False
    await cannot_move(client, model)
    last = len(device["axes"]) - 1
    refused = await sets_off(client, model, last, 3_000)
    assert refused.status_code == 409, refused.text
    (remedy,) = refused.json()["remedies"]
    assert (remedy["method"], remedy["path"], remedy["moves"]) == ("POST", "/api/v1/devices/new/start-up", False)
    assert remedy["body"] == {"axes": [last]}

    held = bench_of(app).manager.get("new")
    before = (await read_held(held)).words
    tried = await client.post("devices/new/start-up", json={**remedy["body"], "dry_run": True})
    assert tried.status_code == 200, tried.text
    dry = tried.json()
    assert (dry["state"], dry["axes"]) == ("dry run", [last])
    assert dry["writes"]
    assert {each["verified"] for each in dry["writes"]} == {None}
    asked = await client.post("devices/new/start-up", params={"dry_run": True}, json=remedy["body"])
    assert asked.json() == dry, "said in the query, it is the same"
    assert (await read_held(held)).words == before

    cured = await client.post(remedy["path"].removeprefix("/api/v1/"), json=remedy["body"])
    assert cured.status_code == 200, cured.text
    done = cured.json()
    assert done["state"] == "applied"
    assert [each["name"] for each in done["writes"]] == [each["name"] for each in dry["writes"]]
    for each in done["writes"]:
        readable = held.family.table.find(each["name"], each["axis"])[0].access.readable  # type: ignore[index]
        assert each["verified"] is (True if readable else None)
    if MODELS[model].counts_position:  # its ramp; without a sense resistor nobody knows amperes
        assert any(each["right_physical"] for each in done["writes"])
    ramp, currents = {"velocity_pps", "acceleration_pps2"}, {"microsteps", "run_scale", "hold_scale"}
    assert {each["name"] for each in done["chosen"]} >= (ramp if MODELS[model].counts_position else currents)

    moved = await sets_off(client, model, last, 3_000)
    assert moved.status_code == 200, moved.text
    await gets_there(client, clock, model, last, 3_000)
    entries = (await client.get("audit", params={"action": "start up"})).json()["entries"]
    assert [entry["outcome"] for entry in entries] == ["done"], "a dry run is no entry"


@pytest.mark.parametrize("model", MODELS)
async def test_an_emulator_added_with_start_up_moves_at_once(
    client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    device = await added(client, model, start_up=True)
    assert device["start_up"] is True
    for axis in range(len(device["axes"])):
        moved = await sets_off(client, model, axis, -2_500)
        assert moved.status_code == 200, moved.text
        if MODELS[model].counts_position:
            assert moved.json()["warnings"] == []
        await gets_there(client, clock, model, axis, -2_500)


async def test_it_is_set_up_again_where_its_emulator_is_a_new_one(
    client: httpx.AsyncClient, settings: Settings, clock: VirtualClock
) -> None:
    await added(client, "tmc5160", start_up=True)
    link = {"kind": "emulator", "full_scale_a": 5.0}
    edited = await client.patch("devices/new", json={"link": link})
    assert edited.status_code == 200, edited.text
    assert (await client.post("devices/new/axes/0/move", json={"target": 100})).status_code == 200


async def test_a_saved_emulator_moves_after_a_restart(settings: Settings, clock: VirtualClock) -> None:
    async def server(work: Any) -> None:
        app = create_app(settings, clock, list)
        async with app.router.lifespan_context(app):
            transport = httpx.ASGITransport(app)
            async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000/api/v1/") as client:
                await work(client)

    async def first(client: httpx.AsyncClient) -> None:
        await added(client, "tmc4361", start_up=True)

    async def second(client: httpx.AsyncClient) -> None:
        moved = await client.post("devices/new/axes/0/move", json={"target": 100})
        assert moved.status_code == 200, moved.text

    await server(first)
    await server(second)


async def test_start_up_by_itself_is_for_emulators_alone(client: httpx.AsyncClient) -> None:
    link = {"kind": "tcp", "host": "127.0.0.1", "port": 1}
    body = {"name": "New", "model": "tmc428", "link": link, "start_up": True}
    refused = await client.post("devices", json=body)
    assert (refused.status_code, "emulator" in refused.json()["detail"]) == (422, True)


async def test_what_cannot_be_is_refused_in_words(client: httpx.AsyncClient) -> None:
    await added(client, "tmc5160")
    for body, status, words in (
        ({"axes": [4]}, 404, "axis"),
        ({"axes": []}, 422, "axes"),
        ({"microsteps": 3}, 422, "microsteps"),
        ({"run_current_a": 1.0}, 422, "sense_resistor_ohm"),
        ({"run_current_a": 9.0, "motor": {"sense_resistor_ohm": 0.22}}, 422, "full scale"),
        ({"velocity_pps": 7.9e6, "acceleration_pps2": 9e6}, 422, "A1"),
        ({"nonsense": 1}, 422, "nonsense"),
    ):
        for dry_run in (True, False):
            refused = await client.post("devices/new/start-up", json={**body, "dry_run": dry_run})
            assert (refused.status_code, words in refused.json()["detail"]) == (status, True), refused.text


@pytest.mark.parametrize("model", ["tmc2240", "tmc5240"])
async def test_where_a_chip_measures_inside_a_sense_resistor_tells_no_amperes(
    client: httpx.AsyncClient, model: str
) -> None:
    await added(client, model)
    motor = {"rated_current_a": 1.0, "sense_resistor_ohm": 0.11}
    told = await client.post("devices/new/start-up", json={"motor": motor, "dry_run": True})
    assert told.status_code == 200, told.text
    assert any("is not known (current_full_scale_a)" in each for each in told.json()["warnings"])
    refused = await client.post("devices/new/start-up", json={"run_current_a": 1.0, "motor": motor})
    assert (refused.status_code, "needs current_full_scale_a" in refused.json()["detail"]) == (422, True)


async def test_a_motor_that_moves_is_left_alone(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await added(client, "tmc5130", start_up=True)
    await client.post("devices/new/axes/0/move", json={"target": 100_000})
    await clock.advance(0.2)
    refused = await client.post("devices/new/start-up", json={"velocity_pps": 1000.0})
    assert (refused.status_code, "moves" in refused.json()["detail"]) == (409, True)


async def test_the_client_starts_up(app: FastAPI, client: httpx.AsyncClient) -> None:
    await added(client, "tmc5072")
    bench = AsyncBench("http://127.0.0.1:8000", transport=httpx.ASGITransport(app))
    dry = await bench.start_up("new", axes=[1], dry_run=True)
    assert (dry["state"], dry["axes"]) == ("dry run", [1])
    done = await bench.start_up("new", velocity_pps=20_000.0, motor={"full_steps_per_rev": 400})
    assert (done["state"], done["axes"]) == ("applied", [0, 1])
    assert (await bench.device("new")).axes[0]["full_steps_per_rev"] == 400
    await bench.aclose()
