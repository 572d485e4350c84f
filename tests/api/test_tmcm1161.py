"""A TMCM-1161 over REST: known to the catalog, moved in turns, its emulator changed, its parameters kept and taken."""

from __future__ import annotations

import httpx
import pytest

from app.clock import VirtualClock

TURN = 51_200


@pytest.fixture
async def motor(client: httpx.AsyncClient) -> str:
    answer = await client.post("devices", json={"name": "Motor", "model": "tmcm-1161", "link": {"kind": "emulator"}})
    assert answer.status_code == 201, answer.text
    assert answer.json()["state"] == "connected"
    return "devices/motor"


async def test_the_catalog_lists_it_with_the_links_that_it_has(client: httpx.AsyncClient) -> None:
    model = (await client.get("catalog/tmcm-1161")).json()
    assert (model["kind"], model["title"], model["family"], model["axes"]) == ("module", "TMCM-1161", "tmcl", 1)
    assert [wire["kind"] for wire in model["wires"]] == ["emulator", "serial", "tcp"]
    rows = {row["alias"]: row for row in model["rows"]}
    assert rows["AP 4"]["unit"].startswith("fCLK/(65536")
    assert rows["AP 4"]["stored"] == "on request"
    link = {"kind": "can", "interface": "virtual", "channel": "none"}
    refused = await client.post("devices", json={"name": "no", "model": "tmcm-1161", "link": link})
    assert refused.status_code in (409, 422)
    assert "no can link" in refused.text


async def test_it_moves_in_turns_and_says_what_it_counts_by(
    client: httpx.AsyncClient, motor: str, clock: VirtualClock
) -> None:
    axis = f"{motor}/axes/0"
    told = (await client.get(motor)).json()["axes"][0]
    assert (told["pulse_div"], told["ramp_div"], told["microsteps_per_full_step"]) == (3, 7, 256)
    started = (await client.post(f"{axis}/move", json={"target": 2, "unit": "rev"})).json()
    assert started["target_position"] == 2 * TURN
    await clock.advance(started["predicted_duration_s"] + 0.5)
    state = (await client.get(axis)).json()
    assert (state["position"], state["position_reached"], state["moving"]) == (2 * TURN, True, False)
    assert abs(state["deviation"]) < TURN / 100
    turning = (await client.post(f"{axis}/rotate", json={"velocity": 30, "unit": "rpm"})).json()
    assert turning["velocity_pps"] == pytest.approx(TURN / 2, rel=2e-3)
    assert (await client.post(f"{axis}/stop", json={})).status_code == 200


async def test_its_emulator_and_its_memory(client: httpx.AsyncClient, motor: str) -> None:
    emulator = (await client.get(f"{motor}/emulator")).json()
    assert emulator["model"] == "tmcm-1161"
    await client.put(f"{motor}/registers/ap4", json={"value": 1234})
    assert (await client.post(f"{motor}/registers/ap4/store")).json()["value"] == 1234
    await client.patch(f"{motor}/emulator", json={"power_cycle": True})
    assert (await client.get(f"{motor}/registers/ap4")).json()["value"] == 1234
