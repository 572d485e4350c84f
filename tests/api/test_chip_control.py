"""The control port of chips on an emulated UART, without a socket."""

from __future__ import annotations

import threading
from collections.abc import AsyncIterator, Iterator

import httpx
import pytest

from app.clock import WallClock
from app.emulator_server.line_control import Several, make_control_app
from app.emulators.line.server import LineServer
from app.emulators.line.uart import uart_line
from app.emulators.tmc5xxx import EmulatedTmc5xxx
from app.emulators.tmc5xxx.family import FAMILY
from app.links.datagram_uart import UartForm


@pytest.fixture
def chips() -> dict[int, EmulatedTmc5xxx]:
    clock = WallClock()
    return {0: EmulatedTmc5xxx("tmc5160", clock), 3: EmulatedTmc5xxx("tmc5160", clock)}


@pytest.fixture
def server(chips: dict[int, EmulatedTmc5xxx]) -> Iterator[LineServer]:
    """A line that a thread serves, as in the program, though without an end."""
    with LineServer(uart_line(list(chips.values()), WallClock(), nodes=tuple(chips)), []) as server:
        thread = threading.Thread(target=server.run)
        thread.start()
        yield server
        server.stop()
        thread.join()


@pytest.fixture
async def api(server: LineServer, chips: dict[int, EmulatedTmc5xxx]) -> AsyncIterator[httpx.AsyncClient]:
    transport = httpx.ASGITransport(make_control_app(Several(server, FAMILY, chips, "chip", range(255))))
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:9000") as client:
        yield client


async def test_chips_are_told_apart_by_the_node_that_they_were_started_with(api: httpx.AsyncClient) -> None:
    answer = await api.get("/emulator")
    assert answer.status_code == 409
    assert "several chips" in answer.json()["detail"]
    assert "/emulator/3" in answer.json()["detail"]
    assert (await api.get("/emulator/0")).json()["model"] == "tmc5160"
    assert (await api.get("/emulator/1")).status_code == 404
    assert (await api.patch("/emulator/255", json={})).status_code == 422


async def test_a_patch_changes_one_chip(api: httpx.AsyncClient, chips: dict[int, EmulatedTmc5xxx]) -> None:
    state = (await api.patch("/emulator/3", json={"faults": {"silence": True}})).json()
    assert state["faults"]["silence"] is True
    with pytest.raises(TimeoutError):
        chips[3].uart(UartForm(0).read(0))
    assert chips[0].uart(UartForm(0).read(0))


async def test_a_chip_alone_needs_no_node(server: LineServer, chips: dict[int, EmulatedTmc5xxx]) -> None:
    transport = httpx.ASGITransport(make_control_app(Several(server, FAMILY, {0: chips[0]}, "chip", range(255))))
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:9000") as api:
        assert (await api.get("/emulator")).status_code == 200
        changed = await api.patch("/emulator", json={"axes": [{"axis": 0, "blocked": True}]})
        assert changed.status_code == 200, changed.text
        assert (await api.patch("/emulator", json={"axes": [{"axis": 1, "blocked": True}]})).status_code == 422
        assert (await api.get("/line")).json()["addresses"] == [0, 3]
