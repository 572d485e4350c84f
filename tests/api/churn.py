"""Devices, tabs and recordings that come and go: what a day of a busy bench does, for tests and for `make bench`."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator

import httpx
from websockets.asyncio.client import connect

FAMILIES = ("tmc428", "tmc4210", "tmc4361", "tmc5160", "pd42-1241")


@contextlib.asynccontextmanager
async def tab(server: str, device: str) -> AsyncIterator[None]:
    """A page that looks at `device`: its conditions and its telemetry; the first of each has come."""
    sockets = f"{server.replace('http', 'ws', 1)}/api/v1"
    telemetry = f"{sockets}/devices/{device}/telemetry?channels=position.0,velocity.0&rate_hz=200&history_s=60"
    # Without a bound on its queue: a client that reads no more would not see the end of a socket either.
    async with (
        connect(f"{sockets}/conditions", max_queue=None) as conditions,
        connect(telemetry, max_queue=None, compression=None) as samples,
    ):
        await conditions.recv()
        for _ in range(3):
            await samples.recv()
        yield


async def live(server: str, api: httpx.AsyncClient, device: str) -> None:
    """Everything that is remembered of a device is asked for once: looks, procedures, a recording, a watched axis."""
    axis = f"devices/{device}/axes/0"
    for path in ("", "/profile", "/axes/0", "/axes/0/stops", "/axes/0/prediction"):
        (await api.get(f"devices/{device}{path}")).raise_for_status()
    (await api.post(f"devices/{device}/start-up", json={})).raise_for_status()
    wanted = {"device": device, "channels": ["position.0"], "rate_hz": 100}
    recording = (await api.post("recordings", json=wanted)).raise_for_status().json()["id"]
    async with tab(server, device):
        (await api.put(f"{axis}/extended-position", json={"watch": True})).raise_for_status()
        (await api.post(f"{axis}/shuttle", json={"first": 0, "second": 4000})).raise_for_status()
        async with tab(server, device):
            (await api.delete(f"{axis}/shuttle")).raise_for_status()
        await api.post(f"{axis}/reference-search", json={})  # some have to be told of a switch first
        (await api.post("stop")).raise_for_status()
    (await api.post(f"recordings/{recording}/stop")).raise_for_status()
    (await api.delete(f"recordings/{recording}")).raise_for_status()


async def add(api: httpx.AsyncClient, model: str, link: dict[str, object] | None = None) -> str:
    """A new device, by default an emulated one: its id."""
    wanted = {"name": "Churn", "model": model, "link": link or {"kind": "emulator"}}
    added = (await api.post("devices", json=wanted)).raise_for_status()
    device: str = added.json()["id"]
    return device


async def remove(api: httpx.AsyncClient, device: str) -> None:
    """It goes."""
    (await api.delete(f"devices/{device}")).raise_for_status()


async def one_round(server: str, api: httpx.AsyncClient, model: str) -> None:
    """A device comes, is used, gets another name and another link, is looked at while it goes, and is gone."""
    device = await add(api, model)
    await live(server, api, device)
    (await api.post(f"devices/{device}/disconnect")).raise_for_status()
    (await api.post(f"devices/{device}/connect")).raise_for_status()
    renamed = (await api.patch(f"devices/{device}", json={"name": "Renamed"})).raise_for_status().json()["id"]
    wanted = {"link": {"kind": "emulator", "time_scale": 2.0}}
    (await api.patch(f"devices/{renamed}", json=wanted)).raise_for_status()
    async with tab(server, renamed):
        await remove(api, renamed)
