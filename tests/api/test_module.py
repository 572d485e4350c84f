"""A PD42-1241 over REST: connect it, read and write it, move it, disturb it, and keep what it stores."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from app.clock import VirtualClock
from app.main import create_app
from app.settings import Settings

TURN = 51_200
"""Microsteps of one turn."""


async def test_the_catalog_has_its_parameters_and_its_commands(client: httpx.AsyncClient) -> None:
    model = (await client.get("catalog/pd42-1241")).json()
    assert (model["kind"], model["title"], model["axes"]) == ("module", "PD42-1241", 1)
    rows = {row["alias"]: row for row in model["rows"]}
    speed = rows["AP 4"]
    assert (speed["name"], speed["space"], speed["unit"], speed["axis"]) == (
        "maximum_positioning_speed",
        "ap",
        "pps",
        0,
    )
    assert speed["internal_range"][0] == 0
    assert rows["AP 207"]["read_clears"]
    assert rows["GP0 66"]["stored"] == "auto"
    assert rows["GP2 5"]["stored"] == "on request"
    assert rows["COORD 3"]["stored"] == "on request"
    assert rows["GP0 66"]["axis"] is None
    commands = {command["mnemonic"]: command for command in model["commands"] if command["mnemonic"]}
    assert commands["MVP"]["types"] == {"ABS": 0, "REL": 1, "COORD": 2}
    assert commands["MVP"]["moves"]
    assert commands["GAP"]["reads"]
    assert not commands["JC"]["direct"]
    chip = (await client.get("catalog/tmc428")).json()
    assert (chip["kind"], chip["commands"]) == ("chip", [])
    assert {row["alias"] for row in chip["rows"]} == {""}


async def test_it_moves_and_tells_why_it_stopped(client: httpx.AsyncClient, motor: str, clock: VirtualClock) -> None:
    axis = f"{motor}/axes/0"
    started = (await client.post(f"{axis}/move", json={"target": 2, "unit": "rev"})).json()
    assert started["target_position"] == 2 * TURN
    expected = (await client.get(f"{axis}/prediction")).json()
    assert expected["duration_s"] == pytest.approx(started["predicted_duration_s"])
    assert expected["position"][-1] == 2 * TURN
    assert [phase["name"] for phase in expected["phases"]][-1].startswith("deceleration")
    await clock.advance(started["predicted_duration_s"] + 0.5)
    state = (await client.get(axis)).json()
    assert (state["position"], state["position_reached"], state["moving"]) == (2 * TURN, True, False)
    assert abs(state["deviation"]) < TURN / 100
    stop = (await client.get(f"{axis}/stops")).json()[0]
    assert (stop["axis"], stop["reason"], stop["position"]) == (0, "target_reached", 2 * TURN)
    assert stop["time_s"] == pytest.approx(started["started_at_s"] + started["predicted_duration_s"], abs=0.2)


async def test_the_latest_stop_is_told_first(client: httpx.AsyncClient, motor: str, clock: VirtualClock) -> None:
    axis = f"{motor}/axes/0"
    assert (await client.get(f"{axis}/stops")).json() == []
    await client.post(f"{axis}/move", json={"target": 1000})
    await clock.advance(2)
    rotating = (await client.post(f"{axis}/rotate", json={"velocity": -1, "unit": "rps"})).json()
    assert rotating["velocity_pps"] == -TURN
    await clock.advance(2)
    assert (await client.post(f"{axis}/stop")).json()["ok"]
    await clock.advance(2)
    stops = (await client.get(f"{axis}/stops")).json()
    assert [stop["reason"] for stop in stops] == ["stop_command", "target_reached"]
    assert (await client.get("devices/bench/axes/0/stops")).json() == []
    assert (await client.get(f"{motor}/axes/1/stops")).status_code == 404


async def test_parameters_by_name_and_by_number(client: httpx.AsyncClient, motor: str) -> None:
    for name in ("maximum_positioning_speed", "ap4", "AP4"):
        reading = (await client.get(f"{motor}/registers/{name}")).json()
        assert (reading["address"], reading["space"], reading["unit"]) == (4, "ap", "pps")
    written = (await client.put(f"{motor}/registers/ap4", json={"value": 12_345})).json()
    assert written["value"] == 12_345
    assert written["verified"]
    assert written["space"] == "ap"
    everything = (await client.get(f"{motor}/registers")).json()
    assert {"ap", "gp0", "gp2", "gp3", "in", "ain", "out", "coord"} == {reading["space"] for reading in everything}
    beyond = await client.put(f"{motor}/registers/ap4", json={"value": 10**9})
    assert (beyond.status_code, beyond.json()["type"]) == (422, "/problems/out-of-range")


@pytest.mark.sheet("FM-PD42-1241", "3.6.9")
@pytest.mark.sheet("FM-PD42-1241", "3.6.10")
@pytest.mark.parametrize("name", ["gp2_5", "coord3"])
async def test_what_is_stored_comes_back(client: httpx.AsyncClient, motor: str, name: str) -> None:
    await client.put(f"{motor}/registers/{name}", json={"value": 77})
    stored = await client.post(f"{motor}/registers/{name}/store")
    assert (stored.status_code, stored.json()["value"]) == (200, 77)
    await client.put(f"{motor}/registers/{name}", json={"value": 5})
    assert (await client.post(f"{motor}/registers/{name}/restore")).json()["value"] == 77
    await client.put(f"{motor}/registers/{name}", json={"value": 5})
    await client.patch(f"{motor}/emulator", json={"power_cycle": True})
    assert (await client.post(f"{motor}/registers/{name}/restore")).json()["value"] == 77


async def test_what_cannot_be_stored_is_refused_with_what_can(client: httpx.AsyncClient, motor: str) -> None:
    for method in ("store", "restore"):
        refused = await client.post(f"{motor}/registers/ap4/{method}")
        assert refused.status_code == 409
        assert "user variables" in refused.json()["way_out"]
        chip = await client.post(f"devices/bench/registers/v_max/{method}", params={"axis": 0})
        assert chip.status_code == 409
        assert "profile" in chip.json()["way_out"]
        assert (await client.post(f"{motor}/registers/nothing/{method}")).status_code == 404


async def test_its_memory_outlives_the_server(settings: Settings) -> None:
    for life in range(2):
        app = create_app(settings, VirtualClock(), list)
        transport = httpx.ASGITransport(app)
        async with (
            app.router.lifespan_context(app),
            httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000/api/v1/") as client,
        ):
            if life == 0:
                body = {"name": "Motor", "model": "pd42-1241", "link": {"kind": "emulator"}}
                assert (await client.post("devices", json=body)).json()["link"]["eeprom"] == "motor"
                twin = (await client.post("devices", json=body)).json()
                assert twin["link"]["eeprom"] == "motor-2"
                await client.put("devices/motor/registers/gp2_1", json={"value": 1241})
                await client.post("devices/motor/registers/gp2_1/store")
            else:
                await client.post("devices/motor/connect")
                await client.post("devices/motor-2/connect")
                assert (await client.get("devices/motor/registers/gp2_1")).json()["value"] == 1241
                assert (await client.get("devices/motor-2/registers/gp2_1")).json()["value"] == 0


async def test_a_tried_link_leaves_no_memory(client: httpx.AsyncClient, settings: Settings) -> None:
    tried = await client.post("devices/test", json={"model": "pd42-1241", "link": {"kind": "emulator"}})
    assert tried.json()["ok"], tried.text
    assert not (settings.data_dir / "emulators").exists()


# --- the emulated module ------------------------------------------------------------------------


async def test_its_motor_and_its_plant_are_shown_and_changed(
    client: httpx.AsyncClient, motor: str, clock: VirtualClock
) -> None:
    state = (await client.get(f"{motor}/emulator")).json()
    assert state["model"] == "pd42-1241"
    assert state["truth"]["lost_fullsteps"] == 0
    changed = (await client.patch(f"{motor}/emulator", json={"blocked": True, "load_torque_nm": 0.05})).json()
    assert (changed["blocked"], changed["load_torque_nm"]) == (True, 0.05)
    forced = (await client.patch(f"{motor}/emulator", json={"switches": {"left": True}})).json()
    assert forced["switches"]["left"] == {"active": True, "forced": True}
    await clock.advance(0.01)
    assert (await client.get(f"{motor}/axes/0")).json()["switches"]["left"]
    same = (await client.patch(f"{motor}/emulator", json={"time_scale": 2.0})).json()
    assert same["time_scale"] == 2.0


@pytest.mark.parametrize(
    ("device", "body"),
    [
        ("motor", {"stages": []}),  # a chip's
        ("bench", {"blocked": True}),  # a module's
        ("motor", {"nothing": 1}),
        ("motor", {"time_scale": "fast"}),
        ("motor", {"time_scale": 1000.0}),  # nobody could work that out in time
        ("bench", {"time_scale": 2000.0}),
        ("motor", {"blocked": 1}),
        ("motor", {"stage": {"left_at_fullsteps": 4000.0}}),  # right of the right one
    ],
)
async def test_a_change_that_is_none_of_this_emulator_is_refused(
    client: httpx.AsyncClient, motor: str, device: str, body: dict[str, object]
) -> None:
    before = (await client.get(f"devices/{device}/emulator")).json()
    assert (await client.patch(f"devices/{device}/emulator", json=body)).status_code == 422
    assert (await client.get(f"devices/{device}/emulator")).json() == before


async def test_a_blocked_shaft_is_a_deviation_that_stops_it(
    client: httpx.AsyncClient, motor: str, clock: VirtualClock
) -> None:
    await client.put(f"{motor}/registers/ap212", json={"value": 2000})
    await client.patch(f"{motor}/emulator", json={"blocked": True})
    await client.post(f"{motor}/axes/0/move", json={"target": 5 * TURN})
    await clock.advance(2)
    stop = (await client.get(f"{motor}/axes/0/stops")).json()[0]
    assert stop["reason"] == "deviation"


async def test_what_is_not_emulated_here_has_no_emulator(client: httpx.AsyncClient) -> None:
    body = {"name": "far", "model": "pd42-1241", "link": {"kind": "tcp", "host": "127.0.0.1", "port": 1}}
    await client.post("devices", json=body)
    for answer in (await client.get("devices/far/emulator"), await client.patch("devices/far/emulator", json={})):
        assert answer.status_code == 409
        assert "not emulated here" in answer.json()["detail"]


# --- what makes no sense for it -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("method", "path", "body"),
    [
        ("GET", "microstep-table", None),
        ("PUT", "microstep-table", {"values": [1] * 64}),
        ("GET", "driver-chain", None),
        ("PUT", "driver-chain", {"drivers": ["tmc236"]}),
    ],
)
async def test_tables_of_chips_are_refused_with_a_way_out(
    client: httpx.AsyncClient, motor: str, method: str, path: str, body: dict[str, Any] | None
) -> None:
    answer = await client.request(method, f"{motor}/{path}", json=body)
    assert answer.status_code == 409
    assert answer.json()["way_out"]


async def test_its_profile_names_each_parameter_as_the_manual_does(client: httpx.AsyncClient, motor: str) -> None:
    profile = (await client.get(f"{motor}/profile")).json()
    aliases = {entry["name"]: entry["alias"] for entry in profile["parameters"]}
    assert aliases["maximum_positioning_speed"] == "ap4"
    assert aliases["coordinate_1"] == "coord1"
    assert (profile["registers"], profile["tables"]["microstep"]) == ([], None)


async def test_a_raw_frame_has_nine_bytes(client: httpx.AsyncClient, motor: str) -> None:
    answer = (await client.post(f"{motor}/exchange", json={"frame": "01 06 04 00 00 00 00 00 0b"})).json()
    assert answer["decoded"]["value"] == 51_200
    assert (await client.post(f"{motor}/exchange", json={"frame": "01 06 04 00"})).status_code == 422
    wrong = (await client.post(f"{motor}/exchange", json={"frame": "01 06 04 00 00 00 00 00 00"})).json()
    assert wrong["decoded"]["status"] == 1


# --- reference search ---------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "7.1")
async def test_it_searches_by_itself_in_one_of_its_modes(
    client: httpx.AsyncClient, motor: str, clock: VirtualClock
) -> None:
    stage = {"left_at_fullsteps": -60.0, "home_from_fullsteps": -20.0, "home_to_fullsteps": -10.0}
    await client.patch(f"{motor}/emulator", json={"stage": stage})
    body = {"mode": 1, "search_speed_pps": 50_000, "switch_speed_pps": 10_000}
    url = f"{motor}/axes/0/reference-search"
    started = (await client.post(url, json=body)).json()
    assert (started["state"], started["mode"]) == ("running", 1)
    for _ in range(200):
        await clock.advance(0.1)
        state = (await client.get(url)).json()
        if state["state"] != "running":
            break
    assert state["state"] == "done", state
    assert state["last_position"] < -60 * 250
    assert (await client.get(f"{motor}/registers/ap194")).json()["value"] == 50_000


@pytest.mark.parametrize(
    ("device", "body"),
    [
        ("motor", {"mode": 9}),
        ("motor", {"mode": 69}),
        ("motor", {"mode": 1, "switch": "left"}),
        ("motor", {"mode": 1, "search_speed_pps": 0}),
        ("bench", {"mode": 1}),
        ("bench", {"search_speed_pps": 100}),
    ],
)
async def test_a_search_that_this_family_does_not_know_is_refused(
    client: httpx.AsyncClient, motor: str, device: str, body: dict[str, object]
) -> None:
    url = f"devices/{device}/axes/0/reference-search"
    assert (await client.post(url, json=body)).status_code == 422
    assert (await client.get(url)).json()["state"] == "idle"


@pytest.mark.sheet("FM-PD42-1241", "7.2")
async def test_the_end_of_the_stage_is_searched_by_stall(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    link = {"kind": "emulator", "stage": {"left_end_fullsteps": -30.0, "left_at_fullsteps": -3000.0}}
    made = await client.post("devices", json={"name": "homer", "model": "pd42-1241", "link": link})
    assert made.status_code == 201, made.text
    url = f"devices/{made.json()['id']}/axes/0/reference-search"
    started = (await client.post(url, json={"stall": {"side": "left", "hits": 2}})).json()
    assert (started["state"], started["stall"]) == ("running", True)
    for _ in range(2000):
        await clock.advance(0.02)
        state = (await client.get(url)).json()
        if state["state"] != "running":
            break
    assert (state["state"], len(state["edges"])) == ("done", 2), state
    assert state["last_position"] == pytest.approx(-30 * 256, abs=256)


@pytest.mark.parametrize(
    ("device", "body", "status"),
    [
        ("motor", {"stall": {"side": "up"}}, 422),
        ("motor", {"stall": {"side": "left", "threshold": 64}}, 422),
        ("motor", {"stall": {"side": "left"}, "mode": 1}, 422),
        ("bench", {"stall": {"side": "left"}}, 409),
    ],
)
async def test_a_search_by_stall_that_cannot_be_is_refused(
    client: httpx.AsyncClient, motor: str, device: str, body: dict[str, object], status: int
) -> None:
    url = f"devices/{device}/axes/0/reference-search"
    assert (await client.post(url, json=body)).status_code == status
    assert (await client.get(url)).json()["state"] == "idle"


# --- links --------------------------------------------------------------------------------------

SERIAL = {"kind": "serial", "port": "/dev/ttyNONE", "baud": 115_200, "address": 3}
CAN = {"kind": "can", "interface": "virtual", "channel": "bus", "bitrate": 500_000, "send_id": 3, "receive_id": 4}
TCP = {"kind": "tcp", "host": "127.0.0.1", "port": 1, "address": 5}


@pytest.mark.parametrize("link", [SERIAL, CAN, TCP])
async def test_each_kind_of_link_is_kept_as_it_was_said(client: httpx.AsyncClient, link: dict[str, object]) -> None:
    made = await client.post("devices", json={"name": "far", "model": "pd42-1241", "link": link})
    assert made.status_code == 201, made.text
    assert made.json()["link"] == link
    assert made.json()["state"] in ("connecting", "failed")
    assert made.json()["problem"]["way_out"]
    edited = await client.patch("devices/far", json={"link": {**link, "timeout_s": 0.1}})
    assert edited.json()["link"] == {**link, "timeout_s": 0.1}


@pytest.mark.parametrize(
    ("model", "link"),
    [
        ("tmc428", SERIAL),
        ("tmc428", {"kind": "tcp", "host": "a", "port": 1, "address": 1}),
        ("tmc4210", CAN),
        ("pd42-1241", {"kind": "emulator", "wiring": "multiplexed"}),
        ("pd42-1241", {"kind": "emulator", "eeprom": "../../etc/passwd"}),
        ("pd42-1241", {**SERIAL, "address": 0}),
        ("pd42-1241", {**SERIAL, "baud": 1}),
        ("pd42-1241", {**CAN, "receive_id": 3}),
        ("pd42-1241", {"kind": "usb"}),
        ("pd42-1241", {}),
    ],
)
async def test_a_link_that_does_not_suit_the_model_is_refused(
    client: httpx.AsyncClient, motor: str, model: str, link: dict[str, object]
) -> None:
    count = len((await client.get("devices")).json())
    assert (await client.post("devices", json={"name": "x", "model": model, "link": link})).status_code == 422
    assert (await client.post("devices/test", json={"model": model, "link": link})).status_code == 422
    known = {"tmc428": "bench", "tmc4210": "slider", "pd42-1241": "motor"}[model]
    before = (await client.get(f"devices/{known}")).json()["link"]
    assert (await client.patch(f"devices/{known}", json={"link": link})).status_code == 422
    assert (await client.get(f"devices/{known}")).json()["link"] == before
    assert len((await client.get("devices")).json()) == count
