"""The condition of an axis over REST: of every model, and what became of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import httpx
import pytest

from app.clock import VirtualClock
from app.emulators.build import build_emulator
from app.emulators.server import serve_tcp
from app.registers.catalog import MODELS

CHIPS = [name for name, model in MODELS.items() if model.kind == "chip" and model.counts_position]
STEPPED = [name for name, model in MODELS.items() if model.can("own_velocity")]
"""They are ready to turn after power-on, and count no position."""


async def added(client: httpx.AsyncClient, model: str, **link: object) -> str:
    """An emulated device: the address of its first axis."""
    answer = await client.post("devices", json={"name": model, "model": model, "link": {"kind": "emulator", **link}})
    assert answer.status_code == 201, answer.text
    return f"devices/{answer.json()['id']}/axes/0"


@pytest.mark.parametrize("model", CHIPS)
async def test_a_device_as_after_power_on_says_that_it_cannot_move_and_the_remedy_is_a_call_that_helps(
    client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    url = await added(client, model)
    await client.patch(f"{url.split('/axes')[0]}/emulator", json={"power_cycle": True})
    state = (await client.get(url)).json()
    condition = state["condition"]
    assert (condition["kind"], condition["remedy"]["label"]) == ("cannot_move", "start up")
    assert condition["cause"].endswith(": no command can move this axis")
    zeros = [piece["what"] for piece in condition["evidence"]]
    assert [name for name in zeros if name.upper().replace("_", "") == "VMAX"]
    assert state["ground_truth"]["summary"]
    listed = {device["id"]: device for device in (await client.get("devices")).json()}
    assert listed[url.split("/")[1]]["axes"][0]["condition"] == condition
    if model == "tmc4361":  # it is in velocity mode then, and VMAX alone would make it turn
        assert len(condition["remedies"]) == 1
        return
    for remedy in condition["remedies"][1:]:  # one register at a time, where nobody wants all of a start-up
        done = await client.request(remedy["method"], remedy["path"].removeprefix("/api/v1/"), json=remedy["body"])
        assert done.status_code == 200, done.text
    assert (await client.get(url)).json()["condition"]["kind"] in ("ready", "unknown")  # unknown: it was reset


@pytest.mark.parametrize("model", CHIPS)
async def test_the_start_up_that_is_offered_after_a_power_cycle_lets_it_move(
    client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    url = await added(client, model)
    await client.patch(f"{url.split('/axes')[0]}/emulator", json={"power_cycle": True})
    remedy = (await client.get(url)).json()["condition"]["remedy"]
    done = await client.request(remedy["method"], remedy["path"].removeprefix("/api/v1/"), json=remedy["body"])
    assert done.status_code == 200, done.text
    moved = await client.post(f"{url}/move", json={"target": 500, "relative": True})
    assert moved.status_code == 200, moved.text
    await clock.advance(10)
    assert (await client.get(url)).json()["condition"]["kind"] == "on_target"


async def does(client: httpx.AsyncClient, remedy: dict[str, Any]) -> None:
    """Call what a condition offers."""
    done = await client.request(remedy["method"], remedy["path"].removeprefix("/api/v1/"), json=remedy["body"])
    assert done.status_code == 200, done.text


@pytest.mark.parametrize("model", STEPPED)
async def test_after_a_power_cycle_what_is_stepped_is_unknown_until_it_is_started_up(
    client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    url = await added(client, model)
    assert (await client.get(url)).json()["condition"]["kind"] == "ready"
    await client.patch(f"{url.split('/axes')[0]}/emulator", json={"power_cycle": True})
    unknown = (await client.get(url)).json()["condition"]
    assert (unknown["kind"], "position" in unknown["cause"]) == ("unknown", False)
    assert [remedy["label"] for remedy in unknown["remedies"]] == ["start up"]
    await clock.advance(5)
    assert (await client.get(url)).json()["condition"]["kind"] == "unknown", "nobody has seen to it yet"
    await does(client, unknown["remedy"])
    assert (await client.get(url)).json()["condition"]["kind"] == "ready"
    turning = await client.post(f"{url}/rotate", json={"velocity": 20_000})
    assert turning.status_code == 200, turning.text
    await clock.advance(1)
    assert (await client.get(url)).json()["condition"]["kind"] == "moving"
    await client.post(f"{url}/stop")
    await clock.advance(1)
    assert (await client.get(url)).json()["condition"]["kind"] == "ready"


@pytest.mark.parametrize("remedy", [0, 1])
@pytest.mark.parametrize("model", STEPPED)
async def test_what_is_stepped_says_that_its_driver_is_off_and_each_remedy_helps(
    client: httpx.AsyncClient, model: str, remedy: int
) -> None:
    url = await added(client, model)
    off = {"fields": {"toff": 0}}
    assert (await client.put(f"{url.split('/axes')[0]}/registers/CHOPCONF", json=off)).status_code == 200
    condition = (await client.get(url)).json()["condition"]
    assert (condition["kind"], len(condition["remedies"])) == ("cannot_move", 2)
    assert condition["cause"].endswith(": no command can move this axis")
    assert (await client.post(f"{url}/rotate", json={"velocity": 20_000})).status_code == 409
    await does(client, condition["remedies"][remedy])
    assert (await client.get(url)).json()["condition"]["kind"] == "ready"
    assert (await client.post(f"{url}/rotate", json={"velocity": 20_000})).status_code == 200


async def test_arrival_names_what_would_not_be_seen(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    url = "devices/bench/axes/0"
    assert (await client.get(url)).json()["condition"]["kind"] == "ready"
    await client.post(f"{url}/move", json={"target": 3000})
    assert (await client.get(url)).json()["condition"]["kind"] == "moving"
    await clock.advance(10)
    found = (await client.get(url)).json()["condition"]
    assert (found["kind"], found["cause"]) == ("on_target", "at its target; lost steps would not be seen")
    assert found["since_s"] == (await client.get(url)).json()["condition"]["since_s"]


async def test_a_connection_that_is_gone_is_told_with_the_error(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    url = await added(client, "tmc5160")
    device = url.split("/axes")[0]
    await client.patch(f"{device}/emulator", json={"faults": {"unplugged": True}})
    refused = await client.get(url)
    condition = refused.json()["condition"]
    assert (refused.status_code, condition["kind"]) == (409, "not_connected")
    assert condition["remedy"] == {
        "label": "connect",
        "method": "POST",
        "path": f"/api/v1/{device}/connect",
        "body": None,
        "moves": False,
    }
    assert (await client.get(device)).json()["axes"][0]["condition"]["kind"] == "not_connected"
    await client.patch(f"{device}/emulator", json={"faults": {"unplugged": False}})
    assert (await client.post(condition["remedy"]["path"].removeprefix("/api/v1/"))).json()["state"] == "connected"
    assert (await client.get(url)).json()["condition"]["kind"] in ("ready", "cannot_move")


def test_the_judge_knows_no_family() -> None:
    import app.conditions

    names = {*MODELS, "tmc5xxx", "pd42", "tmcl"}
    for path in Path(app.conditions.__file__).parent.glob("*.py"):
        assert not [name for name in names if name in path.read_text().lower()], path


async def test_a_module_in_download_mode_answers_and_cannot_move_until_it_is_left(
    client: httpx.AsyncClient, clock: VirtualClock, motor: str
) -> None:
    await client.post(f"{motor}/tmcl", json={"command": 132, "type": 0, "motor": 0, "value": 0})
    await clock.advance(0.5)
    condition = (await client.get(motor)).json()["axes"][0]["condition"]
    assert condition["kind"] == "cannot_move"
    assert condition["cause"].startswith("download mode")
    remedy = condition["remedy"]
    assert (remedy["label"], remedy["moves"]) == ("leave download mode", False)
    answer = await client.request(remedy["method"], remedy["path"].removeprefix("/api/v1/"), json=remedy["body"])
    assert answer.status_code == 200, answer.text
    await clock.advance(0.5)
    assert (await client.get(motor)).json()["axes"][0]["condition"]["kind"] == "ready"


async def test_another_chip_answers_and_cannot_move_until_the_model_is_changed(
    client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    server = await serve_tcp(build_emulator("tmc5160", clock), "127.0.0.1", 0)
    try:
        link = {"kind": "tcp", "host": "127.0.0.1", "port": server.sockets[0].getsockname()[1]}
        body = {"name": "Chip", "model": "tmc5130", "link": link}
        added = (await client.post("devices", json=body)).json()
        condition = added["axes"][0]["condition"]
        assert (condition["kind"], condition["remedy"]["label"]) == ("cannot_move", "change the model to TMC5160")
        remedy = condition["remedy"]
        changed = await client.request(remedy["method"], remedy["path"].removeprefix("/api/v1/"), json=remedy["body"])
        assert changed.status_code == 200, changed.text
        assert changed.json()["model"] == "tmc5160"
        assert (await client.get("devices/chip/axes/0")).json()["condition"]["remedy"]["label"] == "start up"
    finally:
        server.close()
        await server.wait_closed()
