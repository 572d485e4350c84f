"""The TMC5xxx over REST: connect them, set them up, move them, follow their events, load them, cut their power."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from app.clock import VirtualClock
from app.registers.tmc5xxx.table import AXES

CHIP = "devices/slide"
AXIS = f"{CHIP}/axes/0"
RAMP = {"VSTOP": 10, "A1": 2_000, "D1": 2_000, "DMAX": 2_000, "AMAX": 2_000, "VMAX": 60_000}
MODELS = tuple(AXES)


async def connected(client: httpx.AsyncClient, model: str, **options: object) -> str:
    """An emulated chip, ready to move: the address of its device."""
    link = {"kind": "emulator", "motor": "rigid", **options}
    answer = await client.post("devices", json={"name": "Slide", "model": model, "link": link})
    assert answer.status_code == 201, answer.text
    assert answer.json()["state"] == "connected", answer.text
    writes: list[dict[str, Any]] = []
    for axis in range(AXES[model]):
        writes += [{"name": "CHOPCONF", "axis": axis, "fields": {"toff": 3, "tbl": 2}}]
        writes += [{"name": "IHOLD_IRUN", "axis": axis, "fields": {"IRUN": 20, "IHOLD": 5}}]
        writes += [{"name": name, "axis": axis, "value": value} for name, value in RAMP.items()]
    batch = (await client.post(f"{CHIP}/registers", json={"writes": writes})).json()
    assert batch["failed"] is None, batch
    return CHIP


async def let(clock: VirtualClock, seconds: float) -> None:
    for _ in range(round(seconds / 0.05)):
        await clock.advance(0.05)


@pytest.mark.parametrize("model", MODELS)
async def test_every_chip_connects_and_moves(client: httpx.AsyncClient, clock: VirtualClock, model: str) -> None:
    await connected(client, model)
    device = (await client.get(CHIP)).json()
    assert (device["model"], len(device["axes"])) == (model, AXES[model])
    for axis in range(AXES[model]):
        started = (await client.post(f"{CHIP}/axes/{axis}/move", json={"target": 20_000})).json()
        assert started["warnings"] == []
        expected = (await client.get(f"{CHIP}/axes/{axis}/prediction")).json()
        assert expected["duration_s"] == pytest.approx(started["predicted_duration_s"])
    await let(clock, 2)
    for axis in range(AXES[model]):
        state = (await client.get(f"{CHIP}/axes/{axis}")).json()
        assert (state["position"], state["position_reached"], state["mode"]) == (20_000, True, "position")


@pytest.mark.parametrize("model", MODELS)
async def test_one_call_sets_a_fresh_axis_up(client: httpx.AsyncClient, clock: VirtualClock, model: str) -> None:
    link = {"kind": "emulator", "motor": "rigid"}
    await client.post("devices", json={"name": "Slide", "model": model, "link": link})
    last = AXES[model] - 1
    axis = f"{CHIP}/axes/{last}"
    assert (await client.post(f"{axis}/move", json={"target": 100})).status_code == 409
    encoder = {} if model == "tmc5031" else {"counts_per_rev": 40_000}
    done = (await client.post(f"{axis}/start-up", json={"velocity_pps": 30_000.0, **encoder})).json()
    assert (done["failed"], done["not_tried"]) == (None, 0)
    assert "VMAX" in {written["name"] for written in done["done"]}
    started = (await client.post(f"{axis}/move", json={"target": 20_000})).json()
    assert started["warnings"] == []
    await let(clock, 2)
    state = (await client.get(axis)).json()
    assert state["position"] == 20_000
    assert (state["deviation"] is None) == (model == "tmc5031")


async def test_figures_beyond_its_registers_are_refused(client: httpx.AsyncClient) -> None:
    link = {"kind": "emulator", "motor": "rigid"}
    await client.post("devices", json={"name": "Slide", "model": "tmc5160", "link": link})
    refused = await client.post(f"{AXIS}/start-up", json={"velocity_pps": 7.9e6, "acceleration_pps2": 9e6})
    assert refused.status_code == 422
    assert "A1" in refused.json()["detail"]


async def test_two_axes_start_together(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await connected(client, "tmc5072")
    moves = [{"axis": 0, "target": 5_000}, {"axis": 1, "target": -5_000}]
    answer = await client.post(f"{CHIP}/move", json={"moves": moves})
    assert [move["axis"] for move in answer.json()] == [0, 1]
    await let(clock, 1)
    positions = [(await client.get(f"{CHIP}/axes/{axis}")).json()["position"] for axis in (0, 1)]
    assert positions == [5_000, -5_000]


async def test_events_stops_and_a_switch_of_the_emulator(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await connected(client, "tmc5130")
    await client.put(f"{CHIP}/registers/SW_MODE?axis=0", json={"fields": {"stop_r_enable": 1}})
    await client.post(f"{AXIS}/rotate", json={"velocity": 10_000})
    await let(clock, 0.5)
    pressed = {"axes": [{"axis": 0, "switches": {"right": True}}]}
    emulator = await client.patch(f"{CHIP}/emulator", json=pressed)
    assert emulator.status_code == 200, emulator.text
    assert emulator.json()["axes"][0]["switches"]["right"] == {"active": True, "forced": True}
    await let(clock, 0.5)
    events = (await client.get(f"{AXIS}/events")).json()
    names = [name for entry in events["events"] for name in entry["names"]]
    assert names == ["reset", "event_stop_r"]
    stops = (await client.get(f"{AXIS}/stops")).json()
    assert stops[0]["reason"] == "right_switch"


async def test_a_held_jog_stops_by_itself(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await connected(client, "tmc5160")
    held = await client.post(f"{AXIS}/rotate", json={"velocity": 10_000, "hold_s": 0.5})
    assert held.status_code == 200, held.text
    await let(clock, 0.3)
    assert (await client.patch(f"{AXIS}/rotate", json={"hold_s": 0.5})).status_code == 200
    await let(clock, 0.3)
    assert (await client.get(AXIS)).json()["moving"]
    await let(clock, 0.8)
    assert not (await client.get(AXIS)).json()["moving"]


async def test_stop_of_everything_reaches_both_axes(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await connected(client, "tmc5062")
    for axis in (0, 1):
        await client.post(f"{CHIP}/axes/{axis}/rotate", json={"velocity": 5_000})
    await let(clock, 0.3)
    stopped = (await client.post("stop")).json()
    assert [result["ok"] for result in stopped["results"] if result["device"] == "slide"] == [True, True]
    await let(clock, 0.3)
    assert [(await client.get(f"{CHIP}/axes/{axis}")).json()["moving"] for axis in (0, 1)] == [False, False]


@pytest.mark.parametrize("model", ["tmc5031", "tmc5072", "tmc5160"])
async def test_a_microstep_table_goes_in_and_out(client: httpx.AsyncClient, model: str) -> None:
    await connected(client, model)
    before = (await client.get(f"{CHIP}/microstep-table")).json()
    assert (before["written"], before["agrees"], len(before["values"])) == (False, True, 256)
    designed = (await client.post("calc/microstep-table", json={"chip": model, "exponent": 1.1})).json()
    assert designed["encodable"]
    written = await client.put(f"{CHIP}/microstep-table", json={"values": designed["table"]["values"], "mirror": 0})
    assert written.status_code == 200, written.text
    assert written.json()["values"] == designed["table"]["values"]
    assert written.json()["written"] is True
    assert [row["address"] for row in written.json()["registers"]] == list(range(0x60, 0x6A))


async def test_two_axes_may_have_tables_of_their_own(client: httpx.AsyncClient) -> None:
    await connected(client, "tmc5062")
    before = (await client.get(f"{CHIP}/microstep-table")).json()["values"]
    designed = (await client.post("calc/microstep-table", json={"chip": "tmc5062", "exponent": 1.2})).json()
    table = {"values": designed["table"]["values"], "mirror": 0}
    written = (await client.put(f"{CHIP}/microstep-table?axis=1", json=table)).json()
    assert [row["address"] for row in written["registers"]] == list(range(0x70, 0x7A))
    assert (await client.get(f"{CHIP}/microstep-table?axis=1")).json()["values"] == table["values"] != before
    assert (await client.get(f"{CHIP}/microstep-table")).json()["values"] == before
    assert (await client.get(f"{CHIP}/microstep-table?axis=2")).status_code == 404


async def test_a_step_and_a_load_are_recorded_with_the_encoder(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    async def finished(what: str) -> dict[str, Any]:
        for _ in range(200):
            await clock.advance(0.05)
            state: dict[str, Any] = (await client.get(f"{CHIP}/axes/1/{what}")).json()
            if state["state"] != "running":
                return state
        raise AssertionError(f"{what} does not end")

    await client.post("devices", json={"name": "Slide", "model": "tmc5072", "link": {"kind": "emulator"}})
    step = {"distance": 2_000, "seconds": 0.5}
    assert (await client.post(f"{CHIP}/axes/1/step-response", json=step)).status_code == 409  # no encoder is set
    started = await client.post(f"{CHIP}/axes/1/start-up", json={"counts_per_rev": 40_000, "ihold": 20, "irun": 20})
    assert started.json()["failed"] is None
    assert (await client.post(f"{CHIP}/axes/1/step-response", json={**step, "shape": "step"})).status_code == 409
    assert (await client.post(f"{CHIP}/axes/1/step-response", json=step)).status_code == 200
    recorded = await finished("step-response")
    assert recorded["state"] == "done", recorded["message"]
    assert recorded["recording"]["encoder"][-1] == pytest.approx(2_000, abs=40)
    assert set(recorded["recording"]["load_angle_deg"]) == {None}
    load = {"load_torque_nm": 0.1, "seconds": 0.4, "load_s": 0.2}
    assert (await client.post(f"{CHIP}/axes/1/disturbance", json=load)).status_code == 200
    loaded = await finished("disturbance")
    assert loaded["state"] == "done", loaded["message"]
    assert max(abs(number) for number in loaded["recording"]["deviation"]) > 10
    assert (await client.get(f"{CHIP}/emulator")).json()["axes"][1]["load_torque_nm"] == 0


async def test_a_power_cycle_is_seen(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await connected(client, "tmc5160")
    await client.get(AXIS)
    await client.patch(f"{CHIP}/emulator", json={"power_cycle": True})
    await let(clock, 1)
    events = (await client.get(f"{AXIS}/events")).json()
    assert [entry["names"] for entry in events["events"]].count(["reset"]) == 2
    refused = await client.post(f"{AXIS}/move", json={"target": 100})
    assert refused.status_code == 409
    assert "VMAX is 0" in refused.json()["detail"]


async def test_a_write_only_register_answers_with_what_arrived(client: httpx.AsyncClient) -> None:
    await connected(client, "tmc5130")
    written = (await client.put(f"{CHIP}/registers/TPOWERDOWN?axis=0", json={"value": 20})).json()
    assert (written["verified"], written["value"]) == (True, 20)
    assert "arrived" in written["note"]
    assert (await client.get(f"{CHIP}/registers/TPOWERDOWN?axis=0")).status_code == 409


async def test_the_profile_has_what_cannot_be_read(client: httpx.AsyncClient) -> None:
    await connected(client, "tmc5072")
    await client.post(f"{CHIP}/axes/1/stop")  # writes VMAX 0, which is not what the user wants
    registers = (await client.get(f"{CHIP}/profile")).json()["registers"]
    kept = {(entry["name"], entry["axis"]): entry["value"] for entry in registers}
    assert kept["VMAX", 1] == RAMP["VMAX"]
    assert kept["AMAX", 0] == RAMP["AMAX"]
    assert ("XACTUAL", 0) not in kept
    assert ("CHOPCONF", 1) in kept


async def test_links_and_options_are_checked(client: httpx.AsyncClient) -> None:
    async def status(link: dict[str, object], model: str = "tmc5160") -> int:
        return (await client.post("devices/test", json={"model": model, "link": link})).status_code

    assert await status({"kind": "emulator", "motor": "rigid", "encoder": {"lines": 500}}) == 200
    assert await status({"kind": "emulator", "wiring": "multiplexed"}) == 422  # of other chips
    assert await status({"kind": "spidev", "bus": 0, "device": 0}) == 200
    assert await status({"kind": "uart", "port": "/dev/none", "node": 3}) == 200
    assert await status({"kind": "uart", "port": "/dev/none"}, "tmc5031") == 422
    assert await status({"kind": "serial", "port": "/dev/none"}) == 422


async def test_a_patch_that_does_not_suit_the_chip_is_refused(client: httpx.AsyncClient) -> None:
    await connected(client, "tmc5160")
    refused = await client.patch(f"{CHIP}/emulator", json={"axes": [{"axis": 1, "blocked": True}]})
    assert refused.status_code == 422
    refused = await client.patch(f"{CHIP}/emulator", json={"inputs": {"gp_in": True}})
    assert refused.status_code == 422
