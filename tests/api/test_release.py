"""A removed device is gone wholly, and so is what belonged to it: nothing stays in memory, on a port, in a task."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import AsyncIterator, Callable
from pathlib import Path

import httpx
import pytest

from app.clock import WallClock
from app.emulators.build import build_emulator
from app.emulators.server import serve_tcp
from tests.api import churn
from tests.api.live import live_server
from tests.leaks import app_objects, descriptors, holders, tasks

OF_A_DEVICE = (
    "app.devices.core.device.",
    "app.links.",
    "app.telemetry.",
    "app.conditions.",
    "app.twin.",
    "app.positions",
)
SETTLED_S = 15.0
"""Closed sockets and cut samples come to their end by themselves, within the time limits of a link."""


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[str]:
    async with live_server(tmp_path, demo=False) as url:
        yield url


@pytest.fixture
async def api(server: str) -> AsyncIterator[httpx.AsyncClient]:
    # No connection is kept: one more or less would be one more or less object of the server's.
    limits = httpx.Limits(max_keepalive_connections=0)
    async with httpx.AsyncClient(base_url=f"{server}/api/v1/", timeout=30, limits=limits) as api:
        yield api


async def more_than(before: Counter[str], count: Callable[[], Counter[str]]) -> Counter[str]:
    """What there is more of than before, once that does not get less any more."""
    for _ in range(round(SETTLED_S / 0.25)):
        if not (more := count() - before):
            break
        await asyncio.sleep(0.25)
    return more


def of_devices() -> Counter[str]:
    """Objects that live and die with a device: none of them is a table of its model, which is kept for the next one."""
    return Counter({kind: count for kind, count in app_objects().items() if kind.startswith(OF_A_DEVICE)})


@pytest.mark.parametrize("model", churn.FAMILIES)
async def test_nothing_of_a_removed_device_stays(server: str, api: httpx.AsyncClient, model: str) -> None:
    await api.get("health")
    before = of_devices()
    device = await churn.add(api, model)
    await churn.live(server, api, device)
    await churn.remove(api, device)
    more = await more_than(before, of_devices)
    assert not more, (more, [holders(kind) for kind in list(more)[:3]])


async def test_nothing_stays_of_one_behind_a_socket_or_of_one_that_never_answered(
    server: str, api: httpx.AsyncClient, unused_tcp_port: int
) -> None:
    far = await serve_tcp(build_emulator("tmc428", WallClock()), "127.0.0.1", 0)
    await api.get("audit")  # its file is open from now on
    before, before_fds = of_devices(), descriptors()
    link: dict[str, object] = {"kind": "tcp", "host": "127.0.0.1", "port": far.sockets[0].getsockname()[1]}
    answers = await churn.add(api, "tmc428", link)
    silent = await churn.add(api, "tmc428", {**link, "port": unused_tcp_port})
    async with churn.tab(server, answers):
        await churn.remove(api, answers)
    await churn.remove(api, silent)
    more = await more_than(before, of_devices)
    assert not more, (more, [holders(kind) for kind in list(more)[:3]])
    assert not await more_than(before_fds, descriptors)
    far.close()
    await far.wait_closed()


async def test_devices_tabs_and_recordings_come_and_go_without_a_trace(server: str, api: httpx.AsyncClient) -> None:
    models = ("tmc428", "pd42-1241")  # the others, one by one, are above
    for model in models:  # its tables are made once
        await churn.one_round(server, api, model)
    before = await settled(app_objects), await settled(tasks), await settled(descriptors)
    for model in models * 2:
        await churn.one_round(server, api, model)
    for count, then in zip((app_objects, tasks, descriptors), before, strict=True):
        more = await more_than(then, count)
        assert not more, (more, [holders(kind) for kind in list(more)[:3]])


async def settled(count: Callable[[], Counter[str]]) -> Counter[str]:
    """What there is once it does not change any more."""
    latest = count()
    for _ in range(round(SETTLED_S / 0.5)):
        await asyncio.sleep(0.5)
        latest, earlier = count(), latest
        if latest == earlier:
            break
    return latest
