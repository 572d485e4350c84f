"""Several devices over REST: wires between emulated chips, and moves that start together."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from app.clock import VirtualClock

NET = {"wires": [{"pin": "START", "net": "start"}]}
SETUP = [
    ("CLK_FREQ", 16_000_000),
    ("AMAX", 800_000),
    ("DMAX", 800_000),
    ("RAMPMODE", 5),
    ("VMAX", 12_800_000),
]


async def add(client: httpx.AsyncClient, name: str, **link: Any) -> str:
    """An emulated TMC4361 that moves on trapezoids: the address of its device."""
    body = {"name": name, "model": "tmc4361", "link": {"kind": "emulator", **link}}
    answer = await client.post("devices", json=body)
    assert answer.status_code == 201, answer.text
    device = f"devices/{answer.json()['id']}"
    writes = [{"name": register, "axis": 0, "value": value} for register, value in SETUP]
    batch = (await client.post(f"{device}/registers", json={"writes": writes})).json()
    assert batch["failed"] is None, batch
    return device


async def nets(client: httpx.AsyncClient) -> dict[str, Any]:
    return {net["net"]: net for net in (await client.get("wiring")).json()["nets"]}


async def test_devices_on_a_net_are_wired_until_one_leaves(client: httpx.AsyncClient) -> None:
    assert await nets(client) == {}
    await add(client, "one", **NET)
    assert (await nets(client))["start"]["open"] == "no other pin is on it"
    two = await add(client, "two", **NET)
    net = (await nets(client))["start"]
    assert net["open"] is None
    assert net["equal_clocks"]
    assert net["pins"] == [{"device": name, "pin": "START", "role": "level"} for name in ("one", "two")]
    await client.patch(two, json={"name": "second"})
    assert [pin["device"] for pin in (await nets(client))["start"]["pins"]] == ["one", "second"]
    await client.delete("devices/second")
    assert (await nets(client))["start"]["open"] == "no other pin is on it"


async def test_a_start_over_rest_is_that_of_the_wired_chip(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    one, two = await add(client, "one", **NET), await add(client, "two", **NET)
    for device, conf in ((one, 1 | 1 << 8 | 1 << 9), (two, 1 | 1 << 5 | 1 << 9 | 1 << 10)):
        writes = [("POS_COMP", 1 << 30), ("START_CONF", conf), ("XTARGET", 1000)]
        body = {"writes": [{"name": name, "axis": 0, "value": value} for name, value in writes]}
        assert (await client.post(f"{device}/registers", json=body)).json()["failed"] is None
    await clock.advance(1.0)
    assert (await client.get(f"{two}/axes/0")).json()["position"] == 0
    await client.put(f"{one}/registers/POS_COMP", params={"axis": 0}, json={"value": 0})
    starts = [(await client.get(f"{device}/emulator")).json()["ramp"]["starts"] for device in (one, two)]
    assert starts == [1, 1]
    await clock.advance(1.0)
    assert [(await client.get(f"{device}/axes/0")).json()["position"] for device in (one, two)] == [1000, 1000]


@pytest.mark.parametrize("wires", [[{"pin": "START", "net": "Has Blanks"}], [{"pin": "DIAG", "net": "a"}], [{}] * 9])
async def test_wires_that_cannot_be_are_refused(client: httpx.AsyncClient, wires: list[Any]) -> None:
    body = {"name": "one", "model": "tmc4361", "link": {"kind": "emulator", "wires": wires}}
    answer = await client.post("devices", json=body)
    assert answer.status_code == 422, answer.text


async def test_axes_of_several_devices_start_together(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    one, two = await add(client, "one", **NET), await add(client, "two", **NET)
    lone = await add(client, "lone")
    moves = [{"device": name, "axis": 0, "target": 2000} for name in ("one", "two", "lone")]
    answer = await client.post("start-together", json={"moves": moves})
    assert answer.status_code == 200, answer.text
    axes = answer.json()["axes"]
    assert [(axis["device"], axis["how"]) for axis in axes] == [
        ("one", "START wire"),
        ("two", "START wire"),
        ("lone", "command"),
    ]
    assert axes[0]["skew_s"] == axes[1]["skew_s"]
    await clock.advance(1.0)
    for device in (one, two, lone):
        assert (await client.get(f"{device}/axes/0")).json()["position"] == 2000
    entries = (await client.get("audit", params={"limit": 50})).json()["entries"]
    assert {entry["device"] for entry in entries if entry["action"] == "move together"} == {"one", "two", "lone"}


async def test_a_start_of_nothing_or_of_nobody_is_refused(client: httpx.AsyncClient) -> None:
    assert (await client.post("start-together", json={"moves": []})).status_code == 422
    moves = [{"device": "nobody", "axis": 0, "target": 1}]
    assert (await client.post("start-together", json={"moves": moves})).status_code == 404


async def test_a_straight_line_is_planned_gone_and_stopped(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    one, two = await add(client, "one", **NET), await add(client, "two", **NET)
    axes = [{"device": name, "axis": 0} for name in ("one", "two")]
    body = {"axes": axes, "points": [[3000, 1000]]}
    plan = (await client.post("straight-line/plan", json=body)).json()
    assert plan["duration_s"] == plan["legs"][0]["duration_s"]
    assert [axis["position"][-1] for axis in plan["legs"][0]["axes"]] == pytest.approx([3000, 1000], abs=2)
    assert (await client.get("straight-line")).json()["state"] == "idle"
    answer = await client.post("straight-line", json=body)
    assert answer.status_code == 200, answer.text
    await clock.advance(plan["duration_s"] + 0.5)
    state = (await client.get("straight-line")).json()
    assert state["state"] == "done", state
    assert [axis["how"] for axis in state["started"]["axes"]] == ["START wire"] * 2
    assert [(await client.get(f"{device}/axes/0")).json()["position"] for device in (one, two)] == [3000, 1000]
    await client.post("straight-line", json={"axes": axes, "points": [[300_000, 100_000]]})
    await clock.advance(0.5)
    stop = await client.delete("straight-line")
    assert stop.json()["state"] in ("aborted", "running"), stop.text
    await clock.advance(2.0)
    assert (await client.get("straight-line")).json()["state"] == "aborted"
    assert not (await client.get(f"{one}/axes/0")).json()["moving"]
