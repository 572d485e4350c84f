"""The wire over REST: its log, its budget, who shares it, and the search for modules on it."""

from __future__ import annotations

import asyncio
import time
from typing import Any

import httpx
import pytest

from app.registers.catalog import MODELS
from tests.api.conftest import PORTS
from tests.peers.board import board, shared_board
from tests.peers.emulator_process import EmulatorProcess

__all__ = ["board", "shared_board"]

WAIT_S = 20.0


async def probed(client: httpx.AsyncClient) -> dict[str, Any]:
    """The search when it is over."""
    deadline = time.monotonic() + WAIT_S
    while (state := (await client.get("ports/probe")).json())["running"]:
        assert time.monotonic() < deadline, state
        await asyncio.sleep(0.01)
    return dict(state)


async def add(client: httpx.AsyncClient, name: str, port: str, **link: object) -> dict[str, Any]:
    body = {"name": name, "model": "pd42-1241", "link": {"kind": "serial", "port": port, **link}}
    return dict((await client.post("devices", json=body)).json())


# --- frames -------------------------------------------------------------------------------------


async def test_frames_are_told_decoded_and_in_order(client: httpx.AsyncClient, motor: str) -> None:
    start = (await client.get(f"{motor}/frames")).json()["next"]
    await client.post(f"{motor}/tmcl", json={"line": "SAP 4, 0, 20000"})
    await client.post(f"{motor}/tmcl", json={"line": "GAP 4, 0"})
    await client.post(f"{motor}/tmcl", json={"line": "GAP 99, 0"})
    await client.post(f"{motor}/axes/0/stop")
    log = (await client.get(f"{motor}/frames", params={"after": start})).json()
    texts = {frame["text"]: frame for frame in log["frames"]}
    assert texts["SAP 4, 0, 20000 -> 20000"]["tx"] == "01050400" + "00004e20" + "78"
    assert texts["GAP 4, 0 -> 20000"]["rx"] is not None
    assert texts["GAP 99, 0 -> wrong type (3)"]["error"] is None
    assert [frame["seq"] for frame in log["frames"]] == list(range(start, log["next"]))
    assert next(frame for frame in log["frames"] if frame["text"].startswith("MST"))["priority"] == "stop"
    assert all(frame["time_unix_s"] == pytest.approx(time.time(), abs=60) for frame in log["frames"])
    assert log["lost"] == 0
    again = (await client.get(f"{motor}/frames", params={"after": log["next"]})).json()
    assert all(frame["seq"] >= log["next"] for frame in again["frames"])


async def test_of_more_than_wanted_the_newest_are_told_and_the_others_counted(
    client: httpx.AsyncClient, motor: str
) -> None:
    for _ in range(5):
        await client.post(f"{motor}/tmcl", json={"line": "GAP 1, 0"})
    log = (await client.get(f"{motor}/frames", params={"limit": 3})).json()
    assert len(log["frames"]) == 3
    assert log["frames"][-1]["text"] == "GAP 1, 0 -> 0"
    assert log["lost"] == log["next"] - 3


async def test_a_frame_without_an_answer_says_why(client: httpx.AsyncClient, motor: str) -> None:
    await client.patch(f"{motor}/emulator", json={"faults": {"silence": True}})
    answer = await client.post(f"{motor}/tmcl", json={"line": "GAP 1, 0"})
    assert (answer.status_code, answer.json()["type"]) == (504, "/problems/no-reply")
    log = (await client.get(f"{motor}/frames")).json()
    silent = [frame for frame in log["frames"] if frame["error"]]
    assert silent
    assert silent[-1]["rx"] is None
    assert "no reply" in silent[-1]["error"]
    assert (await client.get(f"{motor}/link")).json()["counts"]["timeouts"] >= 1


async def test_datagrams_of_chips_are_decoded_too(client: httpx.AsyncClient) -> None:
    start = (await client.get("devices/bench/frames")).json()["next"]
    await client.put("devices/bench/registers/v_max", params={"axis": 1}, json={"value": 1234})
    await client.get("devices/bench/registers/pmul_pdiv", params={"axis": 2})
    frames = (await client.get("devices/bench/frames", params={"after": start})).json()["frames"]
    texts = [frame["text"] for frame in frames]
    assert "v_max.1 := 1234" in texts
    assert "read v_max.1 -> 1234" in texts
    assert any(text.startswith("read pmul_pdiv.2 -> 0x") for text in texts)


# --- link ---------------------------------------------------------------------------------------


async def test_an_emulator_has_no_wire_to_run_out_of(client: httpx.AsyncClient, motor: str) -> None:
    for device in (motor, "devices/bench"):
        link = (await client.get(f"{device}/link")).json()
        assert link["kind"] == "emulator"
        assert (link["baud"], link["calls_per_s_possible"], link["share"]) == (None, None, None)
        assert link["calls_per_s"] > 0
        assert link["counts"]["commands"] > 0
        assert (link["incidents"], link["shared_with"]) == ([], [])


async def test_a_real_line_tells_its_budget_and_who_shares_it(client: httpx.AsyncClient, far_line: str) -> None:
    one = await add(client, "one", far_line, baud=115_200)
    two = await add(client, "two", far_line, baud=115_200, address=2)
    assert (one["state"], two["state"]) == ("connected", "connected")
    link = (await client.get("devices/one/link")).json()
    assert link["kind"] == "serial"
    assert link["shared_with"] == ["two"]
    assert link["calls_per_s"] > 0
    # 18 bytes a call, ten bits each; a terminal that is faster than it says has no limit.
    assert link["calls_per_s_possible"] in (None, pytest.approx(115_200 / 180))
    assert link["counts"]["commands"] > 0
    assert (await client.get("devices/two/registers/gp0_66")).json()["value"] == 2
    assert (await client.delete("devices/two")).status_code == 204
    assert (await client.get("devices/one/link")).json()["shared_with"] == []


async def test_a_port_tells_who_uses_it(client: httpx.AsyncClient) -> None:
    port = PORTS[0].name
    assert (await client.get("ports")).json()[0]["in_use_by"] == []
    device = await add(client, "far", port)
    assert device["state"] in ("connecting", "failed")  # this machine has no such port
    assert device["problem"]["status"] == 409
    listed = (await client.get("ports")).json()
    assert (listed[0]["name"], listed[0]["in_use_by"]) == (port, ["far"])
    assert {entry["model"] for entry in listed if entry["kind"] == "emulator"} == set(MODELS)
    await client.post("devices/far/disconnect")
    assert (await client.get("ports")).json()[0]["in_use_by"] == []


# --- probing ------------------------------------------------------------------------------------


async def test_modules_are_found_by_rate_and_address(client: httpx.AsyncClient, far_line: str) -> None:
    body = {"port": far_line, "bauds": [115_200], "addresses": [1, 2, 3]}
    assert not (await client.get("ports/probe")).json()["running"]
    started = await client.post("ports/probe", json=body)
    assert started.status_code == 202
    assert started.json()["running"]
    state = await probed(client)
    assert (state["port"], state["done"], state["total"]) == (far_line, 3, 3)
    assert [(found["address"], found["baud"]) for found in state["found"]] == [(1, 115_200), (2, 115_200)]
    for found in state["found"]:
        assert (found["model"], found["module"], found["version"]) == ("pd42-1241", 1241, "1241V144")
        assert (found["port"], found["board"]) == (far_line, None)
    assert state["message"] == "2 found"


async def test_an_evaluation_board_is_found_with_its_chip(client: httpx.AsyncClient, board: EmulatorProcess) -> None:
    await client.post("ports/probe", json={"port": str(board.pty), "bauds": [115_200], "addresses": [1]})
    (found,) = (await probed(client))["found"]
    assert (found["model"], found["module"], found["version"]) == ("tmc4361", 12, "0012V310")
    assert found["board"] == "Landungsbrücke with TMC4361A and TMC2660"


async def test_one_search_at_a_time_and_it_can_be_ended(client: httpx.AsyncClient, far_line: str) -> None:
    body = {"port": far_line, "bauds": [115_200], "addresses": list(range(100, 256))}
    assert (await client.post("ports/probe", json=body)).status_code == 202
    second = await client.post("ports/probe", json=body)
    assert second.status_code == 409
    assert "DELETE" in second.json()["way_out"]
    ended = (await client.delete("ports/probe")).json()
    assert (ended["running"], ended["message"]) == (False, "ended on request")
    assert ended["done"] < ended["total"] or ended["total"] == 0
    # The port is free again, and so is the job.
    assert (await client.post("ports/probe", json={**body, "addresses": [1]})).status_code == 202
    assert (await probed(client))["message"] == "1 found"
    assert (await client.delete("ports/probe")).json()["message"] == "1 found"


async def test_a_line_in_use_is_asked_as_it_is(client: httpx.AsyncClient, far_line: str) -> None:
    await add(client, "one", far_line, baud=115_200)
    await client.post("ports/probe", json={"port": far_line, "addresses": [2]})
    assert [found["address"] for found in (await probed(client))["found"]] == [2]
    await client.post("ports/probe", json={"port": far_line, "bauds": [9600], "addresses": [2]})
    assert "115200" in (await probed(client))["message"]
    assert (await client.get("devices/one")).json()["state"] == "connected"


async def test_where_nobody_is_the_search_says_so(client: httpx.AsyncClient, far_line: str) -> None:
    await client.post("ports/probe", json={"port": far_line, "bauds": [115_200], "addresses": [7]})
    state = await probed(client)
    assert (state["found"], state["message"]) == ([], "nothing answered")
    await client.post("ports/probe", json={"port": "/dev/ttyNOBODY"})
    assert "/dev/ttyNOBODY" in (await probed(client))["message"]


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"port": ""},
        {"port": "alt:///dev/null"},
        {"port": "x", "bauds": []},
        {"port": "x", "bauds": [1]},
        {"port": "x", "addresses": [0]},
        {"port": "x", "addresses": [1.5]},
        {"port": "x", "speed": 9600},
    ],
)
async def test_what_cannot_be_searched_is_refused(client: httpx.AsyncClient, body: dict[str, object]) -> None:
    assert (await client.post("ports/probe", json=body)).status_code == 422
    assert not (await client.get("ports/probe")).json()["running"]
