"""Programs of a module over REST: assembled, stored, run, looked at, and what is told of mistakes."""

from __future__ import annotations

import httpx
import pytest

from app.clock import VirtualClock
from tests.calc.tmcl_programs import ROUTINES


async def test_a_program_from_its_text_to_its_end(client: httpx.AsyncClient, motor: str, clock: VirtualClock) -> None:
    stored = await client.put(f"{motor}/program", json={"text": ROUTINES})
    assert stored.status_code == 200, stored.text
    assert (stored.json()["commands"], stored.json()["labels"]["Func2"]) == (16, 1)
    held = (await client.get(f"{motor}/program", params={"count": 16})).json()
    assembled = (await client.post(f"{motor}/program/assemble", json={"text": held["text"]})).json()
    original = (await client.post(f"{motor}/program/assemble", json={"text": ROUTINES})).json()
    bytes_of = [
        [line.split("  ")[1] for line in made["listing"].split("\n\n")[0].splitlines()]
        for made in (assembled, original)
    ]
    assert bytes_of[0] == bytes_of[1]
    assert (await client.post(f"{motor}/program/run", json={"address": 1})).status_code == 204
    await clock.advance(0.1)
    state = (await client.get(f"{motor}/program/state", params={"variable": [0, 7]})).json()
    assert (state["status"], state["counter"], state["variables"]) == ("running", 9, {"0": 0, "7": 0})
    assert (await client.post(f"{motor}/program/stop")).status_code == 204
    assert (await client.post(f"{motor}/program/step")).status_code == 204
    assert (await client.get(f"{motor}/program/state")).json()["status"] == "stepping"
    assert (await client.post(f"{motor}/program/reset")).status_code == 204
    state = (await client.get(f"{motor}/program/state")).json()
    assert (state["status"], state["counter"], state["accumulator"], state["x"]) == ("stopped", 0, 0, 0)


async def test_mistakes_are_told_all_at_once(client: httpx.AsyncClient, motor: str) -> None:
    body = {"text": "#include a.tmc\nROX 0\nJA Nowhere", "name": "my.tmc", "files": {"a.tmc": "STOP 1"}}
    told = (await client.post(f"{motor}/program/assemble", json=body)).json()
    assert [(each["file"], each["line"], each["column"]) for each in told["problems"]] == [
        ("my.tmc", 2, 1),
        ("my.tmc", 3, 4),
        ("a.tmc", 1, 1),
    ]
    refused = await client.put(f"{motor}/program", json=body)
    assert refused.status_code == 422
    assert "my.tmc:2:1" in refused.json()["detail"]
    assert "a.tmc:1:1" in refused.json()["detail"]


@pytest.mark.parametrize(
    ("method", "path", "body", "status"),
    [
        ("POST", "run", {"address": 2048}, 422),
        ("POST", "run", {"address": -1}, 422),
        ("GET", "?address=2047&count=2", None, 422),
        ("GET", "state?variable=256", None, 422),
    ],
)
async def test_what_is_beyond_the_memory(
    client: httpx.AsyncClient, motor: str, method: str, path: str, body: object, status: int
) -> None:
    address = f"{motor}/program{path}" if path.startswith("?") else f"{motor}/program/{path}"
    assert (await client.request(method, address, json=body)).status_code == status


async def test_soft_limits_hold_for_programs(client: httpx.AsyncClient, motor: str) -> None:
    limits = {"axes": [{"limits": {"position_min": -1000, "position_max": 1000}}]}
    changed = await client.patch(motor, json=limits)
    assert changed.status_code == 200, changed.text
    refused = await client.put(f"{motor}/program", json={"text": "MVP ABS, 0, 5000\nSTOP"})
    assert (refused.status_code, refused.json()["type"]) == (422, "/problems/soft-limit")
    assert (await client.get(motor)).json()["state"] == "connected"


async def test_a_chip_has_no_program(client: httpx.AsyncClient) -> None:
    answer = await client.get("devices/bench/program/state")
    assert answer.status_code == 409
    assert "no memory for programs" in answer.json()["detail"]
