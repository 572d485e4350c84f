"""A velocity over time, over REST: judged, played, looked at, ended."""

from __future__ import annotations

import httpx

from app.clock import VirtualClock

PROFILE = {"time_s": [0, 0.2, 0.6, 0.8], "velocity_pps": [0, 4000, 4000, 0], "rate_hz": 200}


async def device_of(client: httpx.AsyncClient, model: str) -> str:
    body = {"name": model, "model": model, "link": {"kind": "emulator"}}
    made = (await client.post("devices", json=body)).json()
    return f"devices/{made['id']}/axes/0/velocity-profile"


async def test_it_is_judged_played_and_told(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    path = await device_of(client, "tmc4210")
    assert (await client.get(path)).json()["state"] == "idle"
    assert (await client.get(f"{path}/lateness")).json() == {"time_s": [], "late_ms": []}
    summary = (await client.post(f"{path}/check", json=PROFILE)).json()
    assert (summary["points"], summary["duration_s"], summary["acceleration_pps2"]) == (161, 0.8, 20_000)
    assert abs(summary["end"] - 4000 * 0.6) < 60, "its velocities are whole steps of 244 pps"
    assert (await client.get(path)).json()["state"] == "idle", "a check plays nothing"
    assert (await client.post(path, json=PROFILE)).json()["state"] == "running"
    again = await client.post(path, json=PROFILE)
    assert again.status_code == 409
    await clock.advance(1.0)
    state = (await client.get(path)).json()
    assert (state["state"], state["sent"], state["skipped"]) == ("done", 161, 0)
    assert abs(state["position"] - summary["end"]) < 30
    late = (await client.get(f"{path}/lateness")).json()
    assert len(late["time_s"]) == len(late["late_ms"]) == 161
    assert None not in late["late_ms"]


async def test_a_stop_ends_it(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    path = await device_of(client, "tmc428")
    await client.post(path, json=PROFILE)
    await clock.advance(0.4)
    assert (await client.delete(path)).json()["state"] == "aborted"


async def test_what_cannot_be_played_is_told(client: httpx.AsyncClient) -> None:
    path = await device_of(client, "tmc428")
    ends = await client.post(f"{path}/check", json={"time_s": [0, 1], "velocity_pps": [0, 5]})
    assert (ends.status_code, "ends at rest" in ends.json()["detail"]) == (422, True), ends.json()
    fast = await client.post(f"{path}/check", json={"time_s": [0, 1, 2], "velocity_pps": [0, 1e7, 0]})
    assert (fast.status_code, "velocity_pps" in fast.json()["detail"]) == (422, True), fast.json()
    other = await client.post((await device_of(client, "tmc4361")) + "/check", json=PROFILE)
    assert other.status_code == 409, other.json()
