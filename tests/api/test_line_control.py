"""The control port of an emulated line, without a socket: REST in, modules and cable changed."""

from __future__ import annotations

import threading
from collections.abc import AsyncIterator, Iterator
from typing import cast

import httpx
import pytest

from app.clock import WallClock
from app.emulator_server.line_control import Several, make_control_app
from app.emulators.line.line import Line
from app.emulators.line.server import LineServer
from app.emulators.tmcl.family import FAMILY
from app.emulators.tmcl.module import EmulatedModule
from app.emulators.tmcl.options import TmclOptions


@pytest.fixture(params=[(1,), (1, 7)], ids=["one module", "two modules"])
def addresses(request: pytest.FixtureRequest) -> tuple[int, ...]:
    addresses: tuple[int, ...] = request.param
    return addresses


@pytest.fixture
def controlled(addresses: tuple[int, ...]) -> Iterator[Several]:
    """A line that a thread serves, as in the program, though without an end."""
    clock = WallClock()
    modules = {address: EmulatedModule("pd42-1241", clock, TmclOptions(address=address)) for address in addresses}
    with LineServer(Line(list(modules.values()), clock, addresses=addresses), []) as server:
        thread = threading.Thread(target=server.run)
        thread.start()
        yield Several(server, FAMILY, modules)
        server.stop()
        thread.join()


@pytest.fixture
async def api(controlled: Several) -> AsyncIterator[httpx.AsyncClient]:
    transport = httpx.ASGITransport(make_control_app(controlled))
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:9000") as client:
        yield client


async def test_one_module_needs_no_address_and_several_do(api: httpx.AsyncClient, addresses: tuple[int, ...]) -> None:
    answer = await api.get("/emulator")
    if len(addresses) == 1:
        assert answer.json()["address"] == 1
    else:
        assert answer.status_code == 409
        assert "/emulator/7" in answer.json()["detail"]
    for address in addresses:
        assert (await api.get(f"/emulator/{address}")).json()["address"] == address
    assert (await api.get("/emulator/9")).status_code == 404
    assert (await api.patch("/emulator/9", json={})).json()["type"] == "/problems/unknown-thing"


async def test_a_patch_changes_what_it_names(api: httpx.AsyncClient, controlled: Several) -> None:
    change = {"faults": {"silence": True, "late_reply_s": 0.5}, "load_torque_nm": 0.2}
    state = (await api.patch("/emulator/1", json=change)).json()
    assert (state["faults"]["silence"], state["faults"]["late_reply_s"], state["load_torque_nm"]) == (True, 0.5, 0.2)
    assert cast("EmulatedModule", controlled.emulators[1]).faults.silence
    assert (await api.get("/emulator/1")).json()["faults"]["unplugged"] is False


@pytest.mark.parametrize(
    "body", [{"faults": {"silence": "loud"}}, {"nonsense": 1}, {"faults": {"bit_error_rate": 2}}, [], {"faults": 1}]
)
async def test_what_cannot_be_is_a_problem_document(api: httpx.AsyncClient, body: object) -> None:
    answer = await api.patch("/emulator/1", json=body)
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["facts"]["errors"]


async def test_the_line_itself(api: httpx.AsyncClient, controlled: Several, addresses: tuple[int, ...]) -> None:
    state = (await api.get("/line")).json()
    assert (state["baud"], state["addresses"], state["plugged"]) == (None, list(addresses), True)
    state = (await api.patch("/line", json={"baud": 9600, "faults": {"unplugged": True}})).json()
    assert (state["baud"], state["plugged"], controlled.line.plugged) == (9600, False, False)
    assert (await api.patch("/line", json={"baud": 1})).status_code == 422


async def test_foreign_pages_are_kept_out(api: httpx.AsyncClient) -> None:
    foreign = await api.patch("/line", json={}, headers={"Origin": "http://elsewhere.example"})
    assert foreign.status_code == 403
    rebound = await api.get("/line", headers={"Host": "elsewhere.example"})
    assert rebound.status_code == 403


async def test_a_wrong_address_or_method_is_told(api: httpx.AsyncClient) -> None:
    assert (await api.get("/nothing")).json()["type"] == "/problems/no-such-path"
    wrong = await api.delete("/line")
    assert (wrong.status_code, wrong.headers["allow"]) == (405, "GET, PATCH")
