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


async def wire(client: httpx.AsyncClient, net: str, *pins: tuple[str, str]) -> httpx.Response:
    body = {"pins": [{"device": device, "pin": pin} for device, pin in pins]}
    return await client.put(f"wiring/{net}", json=body)


async def test_wires_come_and_go_while_the_devices_live_on(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    one, two = await add(client, "one"), await add(client, "two")
    pins = (await client.get("wiring")).json()["pins"]
    assert [(pin["device"], pin["pin"]) for pin in pins if pin["pin"] == "START"] == [
        ("one", "START"),
        ("two", "START"),
    ]
    answer = await wire(client, "go", ("one", "START"), ("two", "START"))
    assert answer.status_code == 200, answer.text
    assert (await nets(client))["go"]["open"] is None
    moves = [{"device": name, "axis": 0, "target": 2000} for name in ("one", "two")]
    started = (await client.post("start-together", json={"moves": moves})).json()
    assert [axis["how"] for axis in started["axes"]] == ["START wire"] * 2
    await clock.advance(1.0)
    assert [(await client.get(f"{device}/axes/0")).json()["position"] for device in (one, two)] == [2000, 2000]
    assert (await client.get(one)).json()["link"]["wires"] == [{"pin": "START", "net": "go"}]
    assert (await client.delete("wiring/go")).json()["nets"] == []
    assert "wires" not in (await client.get(one)).json()["link"]
    assert (await client.get(f"{one}/axes/0")).json()["position"] == 2000, "the chip was not made anew"
    entries = (await client.get("audit", params={"limit": 50})).json()["entries"]
    assert [e["subject"] for e in entries if e["action"] in ("wire pins", "remove wires")] == ["go", "go"]


async def test_wires_that_make_no_net_are_refused_and_change_nothing(client: httpx.AsyncClient) -> None:
    await add(client, "one", **NET)
    await add(client, "two", **NET)
    before = (await client.get("wiring")).json()
    for net, pins, said in (
        ("other", [("one", "START"), ("two", "STEP1")], "one START is on net start; remove it there first"),
        ("other", [("one", "STEP1"), ("two", "STEP1")], "steps come from one output, and it has 2"),
        ("start", [("one", "START"), ("two", "DIAG7")], "no pin of two is called 'DIAG7'; known: START, STEP1"),
        ("start", [("one", "START"), ("nobody", "START")], "no emulated device with pins is called 'nobody'"),
        ("start", [("one", "START"), ("one", "START")], "it has two pins of one device"),
    ):
        answer = await wire(client, net, *pins)
        assert answer.status_code in (404, 422), answer.text
        assert said in answer.json()["detail"]
    assert (await wire(client, "Has Blanks", ("one", "START"), ("two", "START"))).status_code == 422
    assert (await client.delete("wiring/nothing")).status_code == 404
    assert (await client.get("wiring")).json() == before


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
    assert (await client.get("straight-line/path")).json() == {"plan": None, "legs": []}
    answer = await client.post("straight-line", json=body)
    assert answer.status_code == 200, answer.text
    await clock.advance(plan["duration_s"] + 0.5)
    state = (await client.get("straight-line")).json()
    assert state["state"] == "done", state
    assert [axis["how"] for axis in state["started"]["axes"]] == ["START wire"] * 2
    assert [(await client.get(f"{device}/axes/0")).json()["position"] for device in (one, two)] == [3000, 1000]
    assert state["off_line"] <= 1 + state["off_line_uncertainty"]
    path = (await client.get("straight-line/path")).json()
    assert path["plan"] == plan
    assert [axis["position"][-1] for axis in path["legs"][0]["axes"]] == [3000, 1000]
    await client.post("straight-line", json={"axes": axes, "points": [[300_000, 100_000]]})
    await clock.advance(0.5)
    stop = await client.delete("straight-line")
    assert stop.json()["state"] in ("aborted", "running"), stop.text
    await clock.advance(2.0)
    assert (await client.get("straight-line")).json()["state"] == "aborted"
    assert not (await client.get(f"{one}/axes/0")).json()["moving"]
