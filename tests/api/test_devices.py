"""Connections over REST."""

from __future__ import annotations

import asyncio
import json

import httpx
import pytest

from app.clock import VirtualClock, WallClock
from app.main import create_app
from app.settings import Settings

NEW: dict[str, object] = {"name": "My axis", "model": "tmc4210", "link": {"kind": "emulator", "seed": 7}}


async def test_the_demo_bench_is_there_when_nothing_is_saved(client: httpx.AsyncClient) -> None:
    bench, slider = (await client.get("devices")).json()
    assert (bench["id"], bench["model"], slider["id"], slider["model"]) == ("bench", "tmc428", "slider", "tmc4210")
    assert [axis["name"] for axis in bench["axes"]] == ["X", "Y", "Z"]
    assert [axis["microsteps_per_full_step"] for axis in bench["axes"]] == [16, 32, 64]
    for device in (bench, slider):
        assert device["state"] == "connected"
        assert device["demo"]
        assert device["emulated"]
        assert device["chip_timed"]
        assert device["rate_max_hz"] == 1000
        assert all(axis["travel_mm_per_rev"] == 8.0 for axis in device["axes"])
    assert {"position.0", "residual.2"} <= {channel["name"] for channel in bench["channels"]}


@pytest.mark.parametrize(("device", "axis"), [("bench", 0), ("bench", 1), ("bench", 2), ("slider", 0)])
async def test_the_first_click_moves_every_demo_motor(
    client: httpx.AsyncClient, clock: VirtualClock, device: str, axis: int
) -> None:
    url = f"devices/{device}/axes/{axis}"
    started = (await client.post(f"{url}/move", json={"target": 100, "unit": "mm"})).json()
    assert started["warnings"] == []
    assert 0.5 < started["predicted_duration_s"] < 3.0
    await clock.advance(started["predicted_duration_s"] + 0.05)
    state = (await client.get(url)).json()
    assert state["position"] == started["target_position"]
    assert state["position_reached"]
    emulator = (await client.get(f"devices/{device}/emulator")).json()["axes"][axis]
    assert emulator["position_fullsteps"] == pytest.approx(3750 + 100 / 8 * 200)


async def test_a_device_is_added_edited_and_removed(client: httpx.AsyncClient) -> None:
    made = await client.post("devices", json=NEW)
    assert made.status_code == 201
    device = made.json()
    assert device["id"] == "my-axis"
    assert device["state"] == "connected"
    assert not device["demo"]
    assert device["link"] == {"kind": "emulator", "seed": 7}
    again = (await client.post("devices", json=NEW)).json()
    assert again["id"] == "my-axis-2"
    edited = await client.patch("devices/my-axis", json={"name": "Lift", "axes": [{"name": "up", "gear_ratio": 3}]})
    assert edited.status_code == 200
    assert edited.json()["id"] == "lift"
    assert edited.json()["axes"][0]["gear_ratio"] == 3
    assert (await client.get("devices/my-axis")).status_code == 404
    assert (await client.delete("devices/lift")).status_code == 204
    assert (await client.delete("devices/lift")).status_code == 404
    assert [device["id"] for device in (await client.get("devices")).json()] == ["bench", "slider", "my-axis-2"]


@pytest.mark.parametrize("model", ["tmc428", "tmc4210"])
async def test_where_an_emulated_chip_lets_its_velocity_be_written_is_an_option_of_the_link(
    client: httpx.AsyncClient, model: str
) -> None:
    """What it does is in tests/emulators/test_ramp.py; the driver writes V_ACTUAL in HOLD_MODE only."""

    async def make(link: dict[str, str]) -> httpx.Response:
        return await client.post("devices", json={**NEW, "model": model, "link": {"kind": "emulator", **link}})

    links: list[tuple[dict[str, str], str]] = [
        ({}, "hold-mode"),
        ({"v_actual_writable": "velocity-mode"}, "velocity-mode"),
    ]
    for link, told in links:
        made = (await make(link)).json()
        assert made["link"] == {"kind": "emulator", **link}
        assert (await client.get(f"devices/{made['id']}/emulator")).json()["v_actual_writable"] == told
    assert (await make({"v_actual_writable": "always"})).status_code == 422


async def test_an_emulated_chip_runs_at_the_devices_clock(client: httpx.AsyncClient) -> None:
    for body in ({**NEW, "clock_hz": 32e6}, {**NEW, "link": {"kind": "emulator", "clock_hz": 32e6}}):
        device = (await client.post("devices", json=body)).json()
        assert device["clock_hz"] == 32e6
        assert (await client.get(f"devices/{device['id']}/emulator")).json()["clock_hz"] == 32e6


async def test_disconnected_is_409_and_connecting_brings_it_back(client: httpx.AsyncClient) -> None:
    assert (await client.post("devices/slider/disconnect")).json()["state"] == "disconnected"
    answer = await client.get("devices/slider/axes/0")
    assert answer.status_code == 409
    assert answer.json()["way_out"]
    assert (await client.post("devices/slider/connect")).json()["state"] == "connected"
    assert (await client.get("devices/slider/axes/0")).status_code == 200


@pytest.mark.parametrize(
    ("change", "part"),
    [
        ({"model": "tmc9999"}, "model"),
        ({"link": {"kind": "spidev"}}, "link"),
        ({"link": {"kind": "emulator", "sead": 1}}, "sead"),
        ({"link": {"kind": "tcp", "host": "x", "port": 0}}, "port"),
        ({"name": "  "}, "name"),
        ({"clock_hz": 33e6}, "clock_hz"),
        ({"axes": [{"gear_ratio": 0}]}, "gear_ratio"),
        ({"axes": [{}, {}]}, "axes"),
        ({"clock_hz": 17e6, "model": "tmc428"}, "clock_hz"),
        (
            {"clock_hz": 1.0, "model": "tmc4361", "link": {"kind": "emulator", "clock_hz": 28e6}, "start_up": True},
            "clock_hz",
        ),
        ({"clock_hz": 3.9e6, "model": "tmc5160", "link": {"kind": "tcp", "host": "127.0.0.1", "port": 1}}, "clock_hz"),
    ],
)
async def test_a_connection_that_cannot_be_is_422_and_says_which_part(
    client: httpx.AsyncClient, change: dict[str, object], part: str
) -> None:
    answer = await client.post("devices", json={**NEW, **change})
    assert answer.status_code == 422
    assert part in answer.json()["detail"]
    assert len((await client.get("devices")).json()) == 2


async def test_a_link_is_tried_without_being_kept(client: httpx.AsyncClient) -> None:
    good = (await client.post("devices/test", json={"model": "tmc428", "link": {"kind": "emulator"}})).json()
    assert good["ok"]
    assert good["round_trip_ms"] > 0
    link = {"kind": "tcp", "host": "127.0.0.1", "port": 1}
    bad = (await client.post("devices/test", json={"model": "tmc428", "link": link})).json()
    assert not bad["ok"]
    assert bad["problem"]["type"] == "/problems/not-connected"
    assert len((await client.get("devices")).json()) == 2


async def test_a_chip_behind_a_socket_is_a_device_like_any_other(far_chip: int, client: httpx.AsyncClient) -> None:
    link = {"kind": "tcp", "host": "127.0.0.1", "port": far_chip}
    device = (await client.post("devices", json={"name": "far", "model": "tmc428", "link": link})).json()
    assert device["state"] == "connected"
    assert not device["emulated"]
    assert not device["chip_timed"]
    written = await client.put("devices/far/registers/v_max", params={"axis": 1}, json={"value": 321})
    assert written.json()["value"] == 321
    assert (await client.get("devices/far/emulator")).status_code == 409
    wrong = {"name": "wrong", "model": "tmc4210", "link": link}
    assert "TMC4210" in (await client.post("devices", json=wrong)).json()["problem"]["detail"]


async def test_an_answerless_device_is_added_all_the_same_and_tells_why(client: httpx.AsyncClient) -> None:
    link = {"kind": "tcp", "host": "127.0.0.1", "port": 1}
    answer = await client.post("devices", json={"name": "off", "model": "tmc428", "link": link})
    assert answer.status_code == 201
    assert answer.json()["state"] == "failed"
    assert answer.json()["problem"]["status"] == 409
    state = await client.get("devices/off/axes/0")
    assert state.status_code == 409
    assert state.json()["type"] == "/problems/not-connected"
    stops = (await client.post("stop")).json()["results"]
    assert {(stop["device"], stop["ok"]) for stop in stops} == {("bench", True), ("slider", True), ("off", False)}


async def test_connections_outlive_the_server_and_the_demo_does_not(settings: Settings) -> None:
    async def session(body: dict[str, object] | None) -> list[dict[str, object]]:
        app = create_app(settings, WallClock())
        async with (
            app.router.lifespan_context(app),
            httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://localhost/api/v1/") as client,
        ):
            if body is not None:
                assert (await client.post("devices", json=body)).status_code == 201
            await asyncio.sleep(0)
            devices: list[dict[str, object]] = (await client.get("devices")).json()
            return devices

    assert [device["id"] for device in await session(NEW)] == ["bench", "slider", "my-axis"]
    (kept,) = await session(None)
    assert kept["id"] == "my-axis"
    assert kept["link"] == NEW["link"]
    saved = json.loads((settings.data_dir / "connections.json").read_text())
    assert [entry["name"] for entry in saved["connections"]] == ["My axis"]
    with_demo = settings.model_copy(update={"demo": True})
    app = create_app(with_demo, WallClock())
    async with app.router.lifespan_context(app):
        assert [device.id for device in app.state.bench.manager.devices] == ["my-axis", "bench", "slider"]


async def test_a_link_that_this_version_cannot_use_does_not_stop_it_and_is_not_lost(
    settings: Settings, caplog: pytest.LogCaptureFixture
) -> None:
    links: dict[str, dict[str, object]] = {
        "far": {"kind": "usb-hid", "serial": "A1"},
        "older": {"kind": "emulator", "wheels": 4},
        "chip": {"kind": "emulator", "seed": 7},
    }
    models = {"chip": "tmc428"}
    kept = [{"name": name, "model": models.get(name, "pd42-1241"), "link": link} for name, link in links.items()]
    path = settings.data_dir / "connections.json"
    path.parent.mkdir(parents=True)
    path.write_text(json.dumps({"format": "stepscope-connections", "version": 1, "connections": kept}))
    app = create_app(settings, VirtualClock(), list)
    transport = httpx.ASGITransport(app)
    async with (
        app.router.lifespan_context(app),
        httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000/api/v1/") as client,
    ):
        assert [device["id"] for device in (await client.get("devices")).json()] == ["chip"]
        await client.patch("devices/chip", json={"name": "lift"})
    for word in ("'far'", "usb-hid", "'older'", "wheels"):
        assert word in caplog.text
    now = {entry["name"]: entry["link"] for entry in json.loads(path.read_text())["connections"]}
    assert now == {"far": links["far"], "older": links["older"], "lift": links["chip"]}
