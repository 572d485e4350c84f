"""A recording lived through once more on an emulator: the same motion, and what cannot be done again is told."""

from __future__ import annotations

import asyncio
import time
from typing import Any

import httpx
import pytest

from app.clock import VirtualClock
from tests.api.test_recordings import run, start


async def replayed(client: httpx.AsyncClient, recording: str, **body: object) -> dict[str, Any]:
    """Replay it, and wait for the end."""
    answer = await client.post(f"recordings/{recording}/replay", json=body)
    assert answer.status_code == 202, answer.text
    found: dict[str, Any] = answer.json()
    deadline_s = time.monotonic() + 60
    while found["state"] == "running":
        assert time.monotonic() < deadline_s, found
        await asyncio.sleep(0.02)  # its thread has a clock of its own
        found = (await client.get(f"recordings/{recording}/replay")).json()
    return found


async def compared(client: httpx.AsyncClient, first: str, second: str) -> dict[str, dict[str, Any]]:
    found = (await client.post("recordings/compare", json={"recordings": [first, second]})).json()
    return {channel["channel"]: channel["differences"][0]["figures"] for channel in found["channels"]}


async def test_a_replay_makes_the_same_motion(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await client.post("devices/bench/axes/0/move", json={"target": 300})
    await run(clock, 2.0)
    recording = await start(client, channels=["position.0", "velocity.0", "position.1"], rate_hz=500.0, name="first")
    await run(clock, 0.3)
    await client.post("devices/bench/axes/0/move", json={"target": 2000})
    await run(clock, 0.4)
    await client.put("devices/bench/registers/V_MAX", params={"axis": 0}, json={"value": 300})
    await client.post("devices/bench/axes/1/rotate", json={"velocity": 700})
    await run(clock, 0.4)
    await client.post("devices/bench/axes/1/stop")
    await run(clock, 2.0)
    await client.post(f"recordings/{recording}/stop")
    devices = (await client.get("devices")).json()

    progress = await replayed(client, recording)
    assert (progress["state"], progress["message"]) == ("done", "")
    assert progress["played"] == progress["commands"] >= 4
    assert progress["done_s"] == pytest.approx(progress["duration_s"])
    assert (await client.get("devices")).json() == devices, "it is no device of the bench"
    again = (await client.get(f"recordings/{progress['recording']}")).json()
    assert (again["name"], again["replay_of"], again["state"]) == ("replay of first", recording, "done")
    found = await compared(client, recording, progress["recording"])
    # Commands are marked by the time at which they were told, samples are 2 ms apart.
    assert abs(found["position.0"]["peak"]) <= 10
    assert abs(found["position.1"]["peak"]) <= 10
    assert found["position.0"]["samples"] > 1400


@pytest.mark.parametrize("model", ["tmc5160", "tmc4361", "pd42-1241"])
async def test_other_families(client: httpx.AsyncClient, clock: VirtualClock, model: str) -> None:
    body = {"name": "Other", "model": model, "link": {"kind": "emulator"}}
    assert (await client.post("devices", json=body)).status_code == 201
    if model == "tmc5160":
        assert (await client.post("devices/other/axes/0/start-up", json={})).status_code == 200
    if model == "tmc4361":
        for register, value in {"RAMPMODE": 5, "AMAX": 800_000, "DMAX": 800_000, "VMAX": 256 * 5000}.items():
            written = await client.put(f"devices/other/registers/{register}", params={"axis": 0}, json={"value": value})
            assert written.status_code == 200, written.text
    await run(clock, 0.5)
    recording = await start(client, device="other", channels=["position.0"], rate_hz=200.0)
    await run(clock, 0.2)
    moved = await client.post("devices/other/axes/0/move", json={"target": 3000})
    assert moved.status_code == 200, moved.text
    await run(clock, 1.5)
    turned = await client.post("devices/other/axes/0/rotate", json={"velocity": 2000})
    assert turned.status_code == 200, turned.text
    await run(clock, 0.5)
    await client.post("devices/other/axes/0/stop")
    await run(clock, 0.5)
    await client.post(f"recordings/{recording}/stop")
    progress = await replayed(client, recording)
    assert progress["state"] == "done", progress
    figures = (await client.get(f"recordings/{recording}")).json()["figures"]["position.0"]
    assert figures["maximum"] > 3000
    difference = (await compared(client, recording, progress["recording"]))["position.0"]
    assert abs(difference["peak"]) <= 0.02 * figures["maximum"], progress["left_out"]


async def test_what_cannot_be_done_again_is_told(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await client.post("devices/bench/axes/0/rotate", json={"velocity": 500})
    await run(clock, 0.5)
    recording = await start(client, device="bench")
    await run(clock, 0.5)
    # A datagram as raw bytes: it moves, and nobody but the chip knows how.
    await client.post("devices/bench/exchange", json={"frame": "00000400"})
    await run(clock, 0.5)
    await client.post(f"recordings/{recording}/stop")
    progress = await replayed(client, recording, name="again")
    assert progress["state"] == "done"
    assert any("turning already" in line for line in progress["left_out"]), progress


async def test_a_recording_without_rows_and_without_replay(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client, trigger={"kind": "move", "axis": 0})
    await run(clock, 0.3)
    await client.post(f"recordings/{recording}/stop")
    answer = await client.post(f"recordings/{recording}/replay", json={})
    assert (answer.status_code, "no rows" in answer.text) == (409, True)
    assert (await client.get(f"recordings/{recording}/replay")).json() is None
    assert (await client.get("recordings/20200101-000000-0000/replay")).status_code == 404
    unlike = await client.post(f"recordings/{recording}/replay", json={"device": "nobody"})
    assert unlike.status_code == 404
