"""A TMC4361 over REST: connect it, set it up, move it, follow its events, close its loop, load it."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from app.clock import VirtualClock

CHIP = "devices/slide"
AXIS = f"{CHIP}/axes/0"
SETUP: list[tuple[str, dict[str, Any]]] = [
    ("STEP_CONF", {"fields": {"mstep_per_fs": 0, "fs_per_rev": 200}}),
    ("ENC_IN_RES", {"value": 40_000}),
    ("CL_DELTA_P", {"value": 65_536}),
    ("CL_TOLERANCE", {"value": 100}),
    ("AMAX", {"value": 800_000}),
    ("DMAX", {"value": 800_000}),
    *((f"BOW{number}", {"value": 2_000_000}) for number in (1, 2, 3, 4)),
    ("RAMPMODE", {"value": 6}),
    ("VMAX", {"value": 12_800_000}),
]


@pytest.fixture
async def chip(client: httpx.AsyncClient) -> str:
    """An emulated TMC4361, ready to move on S-ramps: the address of its device."""
    link = {"kind": "emulator"}
    answer = await client.post("devices", json={"name": "Slide", "model": "tmc4361", "link": link})
    assert answer.status_code == 201, answer.text
    assert answer.json()["state"] == "connected"
    writes = [{"name": name, "axis": 0, **body} for name, body in SETUP]
    batch = (await client.post(f"{CHIP}/registers", json={"writes": writes})).json()
    assert batch["failed"] is None, batch
    return CHIP


async def let(clock: VirtualClock, seconds: float) -> None:
    for _ in range(round(seconds / 0.05)):
        await clock.advance(0.05)


async def finished(client: httpx.AsyncClient, clock: VirtualClock, what: str) -> dict[str, Any]:
    for _ in range(400):
        await clock.advance(0.05)
        state: dict[str, Any] = (await client.get(f"{AXIS}/{what}")).json()
        if state["state"] != "running":
            return state
    raise AssertionError(f"{what} does not end")


async def test_its_links_and_options_are_checked(client: httpx.AsyncClient) -> None:
    async def status(link: dict[str, object], model: str = "tmc4361") -> int:
        return (await client.post("devices/test", json={"model": model, "link": link})).status_code

    assert await status({"kind": "emulator", "encoder": {"lines": 1000}}) == 200
    assert await status({"kind": "emulator", "wiring": "multiplexed"}) == 422  # of other chips
    assert await status({"kind": "spidev", "bus": 0, "device": 0}) == 200
    assert await status({"kind": "spidev", "bus": 0}) == 422
    assert await status({"kind": "landungsbruecke", "port": "/dev/none", "motor": 16}) == 422
    assert await status({"kind": "serial", "port": "/dev/none"}) == 422
    assert await status({"kind": "landungsbruecke", "port": "/dev/none"}, "tmc428") == 422


async def test_an_spi_bus_that_is_not_there_says_what_helps(client: httpx.AsyncClient) -> None:
    link = {"kind": "spidev", "bus": 9, "device": 9}
    trial = (await client.post("devices/test", json={"model": "tmc4361", "link": link})).json()
    assert trial["ok"] is False
    assert trial["problem"]["type"] == "/problems/not-connected"


async def test_a_kept_connection_gets_another_link(client: httpx.AsyncClient, chip: str) -> None:
    edited = await client.patch(chip, json={"link": {"kind": "emulator", "load": {"inertia_kgm2": 1e-4}}})
    assert edited.status_code == 200, edited.text
    assert edited.json()["link"]["load"] == {"inertia_kgm2": 1e-4}
    refused = await client.patch(chip, json={"link": {"kind": "can", "interface": "virtual", "channel": "a"}})
    assert refused.status_code == 422


async def test_it_moves_and_tells_of_it(client: httpx.AsyncClient, chip: str, clock: VirtualClock) -> None:
    started = (await client.post(f"{AXIS}/move", json={"target": 51_200})).json()
    assert started["predicted_duration_s"] == pytest.approx(1.374, abs=1e-3)
    prediction = (await client.get(f"{AXIS}/prediction")).json()
    assert [phase["name"] for phase in prediction["phases"]] == ["B1", "B12", "B2", "B23", "B3", "B34", "B4"]
    await let(clock, 2)
    state = (await client.get(AXIS)).json()
    assert (state["position"], state["moving"], state["mode"]) == (51_200, False, "positioning, S-ramp")
    assert abs(state["deviation"]) < 50
    assert state["load_angle_deg"] is not None
    stops = (await client.get(f"{AXIS}/stops")).json()
    assert (stops[0]["reason"], stops[0]["position"]) == ("target_reached", 51_200)


async def test_a_timeline_is_read_from_where_one_was(client: httpx.AsyncClient, chip: str, clock: VirtualClock) -> None:
    await let(clock, 1)
    before = (await client.get(f"{AXIS}/events")).json()
    assert "RST_EV" in before["events"][0]["names"]
    await client.post(f"{AXIS}/move", json={"target": 2_000})
    await let(clock, 2)
    page = (await client.get(f"{AXIS}/events", params={"after": before["next"]})).json()
    names = [name for entry in page["events"] for name in entry["names"]]
    assert names.count("TARGET_REACHED") == 1
    assert [entry["seq"] for entry in page["events"]] == list(range(before["next"] + 1, page["next"] + 1))
    assert page["lost"] == 0
    nothing = (await client.get(f"{AXIS}/events", params={"after": page["next"]})).json()
    assert nothing["events"] == []
    other = (await client.get("devices/bench/axes/0/events")).json()
    assert not any("TARGET_REACHED" in entry["names"] for entry in other["events"]), "another device has its own"


async def test_numbers_beyond_a_register_name_the_limit(client: httpx.AsyncClient, chip: str) -> None:
    refused = await client.put(f"{chip}/registers/AMAX", params={"axis": 0}, json={"value": 1 << 24})
    assert refused.status_code == 422
    assert refused.json()["facts"]["maximum"] == (1 << 24) - 1
    too_fast = await client.post(f"{AXIS}/rotate", json={"velocity": 8_000_001})
    assert too_fast.status_code == 422
    assert too_fast.json()["facts"]["maximum"] == pytest.approx(8e6)
    short = await client.post(f"{chip}/exchange", json={"frame": "21 00 00 00"})
    assert short.status_code == 422


async def test_one_datagram_is_decoded(client: httpx.AsyncClient, chip: str) -> None:
    answer = (await client.post(f"{chip}/exchange", json={"frame": "7F00000000"})).json()
    assert len(bytes.fromhex(answer["reply"])) == 5
    assert (answer["decoded"]["register"], answer["decoded"]["value"]) == ("VERSION_NO", 2)
    frames = (await client.get(f"{chip}/frames")).json()["frames"]
    assert any(entry["text"].startswith("read VERSION_NO (status") for entry in frames)


async def test_its_emulator_is_seen_and_changed(client: httpx.AsyncClient, chip: str, clock: VirtualClock) -> None:
    emulator = (await client.get(f"{chip}/emulator")).json()
    assert (emulator["model"], emulator["load_torque_nm"]) == ("tmc4361", 0)
    changed = await client.patch(f"{chip}/emulator", json={"load_torque_nm": 0.1, "switches": {"left": True}})
    assert changed.status_code == 200, changed.text
    assert changed.json()["load_torque_nm"] == 0.1
    refused = await client.patch(f"{chip}/emulator", json={"inputs": {"gp_in": True}})
    assert refused.status_code == 422  # of a TMC4210
    assert (await client.patch(f"{chip}/emulator", json={"time_scale": 2})).json()["time_scale"] == 2


async def test_a_loop_is_closed_stepped_and_loaded(client: httpx.AsyncClient, chip: str, clock: VirtualClock) -> None:
    idle = (await client.get(f"{AXIS}/closed-loop-calibration")).json()
    assert (idle["state"], idle["offset"]) == ("idle", None)
    started = await client.post(f"{AXIS}/closed-loop-calibration")
    assert (started.status_code, started.json()["state"]) == (200, "running")
    done = await finished(client, clock, "closed-loop-calibration")
    assert (done["state"], done["regulation"]) == ("done", "closed_loop"), done["message"]

    assert (await client.post(f"{AXIS}/step-response", json={"distance": 5_000})).json()["state"] == "running"
    step = await finished(client, clock, "step-response")
    assert step["state"] == "done", step["message"]
    assert step["score"]["settling_s"] is not None
    columns = step["recording"]
    assert {len(column) for column in columns.values()} == {len(columns["time_s"])}
    assert set(columns["load_torque_nm"]) == {None}

    load = {"load_torque_nm": 0.15, "seconds": 0.6}
    assert (await client.post(f"{AXIS}/disturbance", json=load)).json()["state"] == "running"
    loaded = await finished(client, clock, "disturbance")
    assert loaded["state"] == "done", loaded["message"]
    assert loaded["score"]["peak"] > 20
    assert max(loaded["recording"]["load_torque_nm"]) == 0.15


async def test_what_cannot_be_is_refused(client: httpx.AsyncClient, chip: str) -> None:
    assert (await client.post(f"{AXIS}/step-response", json={"distance": 0})).status_code == 422
    assert (await client.post(f"{AXIS}/step-response", json={})).status_code == 422
    assert (await client.post(f"{AXIS}/closed-loop-calibration", json={"settle_s": 0})).status_code == 422
    refused = await client.post("devices/bench/axes/0/closed-loop-calibration")
    assert refused.status_code == 409
    assert "closed loop" in refused.json()["detail"]
    assert (await client.get(f"{CHIP}/axes/1/step-response")).status_code == 404


async def test_home_is_another_word_for_the_reference_switch(
    client: httpx.AsyncClient, chip: str, clock: VirtualClock
) -> None:
    await client.post(f"{AXIS}/reference-search", json={"switch": "home", "max_travel": 5_000})
    state = await finished(client, clock, "reference-search")
    assert state["state"] == "failed"  # it lies 3400 full steps away
    assert "home" in state["message"]


async def test_its_units_and_their_limits(client: httpx.AsyncClient) -> None:
    body = {
        "model": "tmc4361",
        "velocity": {"value": 60, "unit": "rpm"},
        "acceleration": {"value": 800_000, "unit": "chip"},
        "bow": {"value": 2_000_000, "unit": "pps3"},
        "mechanics": {"microsteps_per_full_step": 256},
    }
    answer = (await client.post("calc/units", json=body)).json()
    assert answer["velocity"]["pps"] == pytest.approx(51_200)
    assert answer["acceleration"]["pps2"] == pytest.approx(200_000)
    assert answer["bow"]["chip"] == pytest.approx(2_000_000)
    assert answer["bow"]["rps3"] == pytest.approx(2_000_000 / 51_200)
    assert answer["ramp"] == {
        "velocity": 51_200 * 256,
        "velocity_pps": 51_200,
        "acceleration": 800_000,
        "acceleration_pps2": 200_000,
        "bow": 2_000_000,
        "bow_pps3": 2_000_000,
        "limits": [],
    }
    direct = body | {"direct_acceleration": True, "acceleration": {"value": 5369, "unit": "chip"}}
    assert (await client.post("calc/units", json=direct)).json()["acceleration"]["pps2"] == pytest.approx(1e7, rel=1e-4)
    fast = body | {"velocity": {"value": 8.1e6, "unit": "pps"}}
    ramp = (await client.post("calc/units", json=fast)).json()["ramp"]
    assert ramp["velocity"] is None
    assert "fCLK/2" in ramp["limits"][0]
    assert (await client.post("calc/units", json=body | {"model": "tmc428"})).status_code == 422
    assert (await client.post("calc/units", json=body | {"clock_hz": 1e6})).status_code == 422


async def test_what_cannot_be_read_is_told_as_last_written(client: httpx.AsyncClient, chip: str) -> None:
    """Only on request, marked, by axis and group like the others; and forgotten with a reset."""
    listed = (await client.get(f"{chip}/registers")).json()
    assert not any(reading["kept"] for reading in listed)

    async def kept(**query: Any) -> dict[str, int]:
        told = (await client.get(f"{chip}/registers", params={"kept": True, **query})).json()
        return {reading["name"]: reading["value"] for reading in told if reading["kept"]}

    assert (await kept())["CL_TOLERANCE"] == 100
    assert "CL_TOLERANCE" in await kept(axis=0, group=["closed loop"])
    assert "CL_TOLERANCE" not in await kept(axis=0, group=["ramp"])
    reset = {"fields": {"RESET_REG": 0x525354}}
    assert (await client.put(f"{chip}/registers/RESET_REG?axis=0", json=reset)).status_code == 200
    assert await kept() == {}
