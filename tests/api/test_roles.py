"""What each role may do: every operation of the contract, every hidden route and every socket, with every role."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator, Iterator

import httpx
import pytest
from fastapi import FastAPI
from fastapi.routing import iter_route_contexts
from hypothesis import given
from hypothesis import strategies as st

from app.api.http.guard import SAFE_METHODS
from app.api.http.policies import Policies
from app.api.router import BASE
from app.clock import VirtualClock
from app.main import bench_of, create_app
from app.settings import Settings
from app.store.tokens import ROLES, Role, at_least
from tests.api.test_lease_gate import filled

TOO_LOW = "/problems/role-too-low"
PROCEDURES = (
    "/reference-search",
    "/shuttle",
    "/velocity-profile",
    "/closed-loop-calibration",
    "/step-response",
    "/disturbance",
    "/program/debug",
    "/macro-run",
)
METHODS = ("GET", "HEAD", "OPTIONS", "POST", "PUT", "PATCH", "DELETE")


@pytest.fixture
async def guarded(settings: Settings, clock: VirtualClock) -> AsyncIterator[tuple[FastAPI, dict[Role, str]]]:
    """A server with its own token, and a named token of each role."""
    app = create_app(Settings.model_validate({**settings.model_dump(), "token": "correct horse"}), clock)
    async with app.router.lifespan_context(app):
        yield app, {role: await bench_of(app).tokens.add(f"{role} only", role) for role in ROLES}


def as_one(app: FastAPI, token: str) -> httpx.AsyncClient:
    transport = httpx.ASGITransport(app, raise_app_exceptions=False)
    headers = {"authorization": f"Bearer {token}"}
    return httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000", headers=headers)


def all_routes(app: FastAPI) -> Iterator[tuple[str, str]]:
    """Method and address of everything, hidden routes too."""
    for context in iter_route_contexts(app.routes):
        path = getattr(context, "path", None)
        for method in sorted(getattr(context, "methods", None) or ()):
            assert path is not None
            yield method, path


def expected(method: str, path: str) -> Role:
    """The least role, by this test's own reading of what the roles are for."""
    short = path.removeprefix(BASE)
    if short.startswith("/tokens"):
        return "administer"
    if method in SAFE_METHODS:
        return "look"
    if (method, short) == ("DELETE", "/straight-line"):
        return "look"
    if method == "POST" and re.fullmatch("/(straight-line|studies)/plan|/studies/[^/]+/stop", short):
        return "look"
    stops = short == "/stop" or (
        short.startswith("/devices/")
        and ((method == "POST" and short.endswith("/stop")) or (method == "DELETE" and short.endswith(PROCEDURES)))
    )
    computes = short.startswith("/calc/") or short in ("/recordings/compare", "/profiles/compare")
    free = ("/program/assemble", "/program/disassemble", "/program/try", "/velocity-profile/check")
    computes = computes or short.endswith(free)
    return "look" if stops or (method == "POST" and (computes or short == "/access/log-out")) else "drive"


async def test_every_route_with_every_role(guarded: tuple[FastAPI, dict[Role, str]]) -> None:
    app, tokens = guarded
    tried = 0
    for role in ROLES:
        async with as_one(app, tokens[role]) as client:
            for method, path in all_routes(app):
                answer = await client.request(method, filled(path))
                refused = answer.status_code == 403
                needed = expected(method, path)
                assert refused is not at_least(role, needed), f"{role}: {method} {path}: {answer.status_code}"
                tried += 1
                if refused:
                    problem = answer.json()
                    assert problem["type"] == TOO_LOW
                    assert f"{role} only" in problem["detail"]
                    assert (problem["facts"]["role"], problem["facts"]["needed"]) == (role, needed)
                    assert f"--role {needed}" in problem["way_out"]
    assert tried > 300


async def test_the_contract_names_the_role_of_every_operation(guarded: tuple[FastAPI, dict[Role, str]]) -> None:
    app, _ = guarded
    operations = [
        (method.upper(), path, operation)
        for path, methods in app.openapi()["paths"].items()
        for method, operation in methods.items()
    ]
    assert len(operations) > 100
    for method, path, operation in operations:
        assert operation["x-required-role"] == expected(method, path), f"{method} {path}"
        told = TOO_LOW in operation["responses"]["403"]["description"]
        assert told or operation["x-required-role"] == "look", f"{method} {path}"


@pytest.fixture(scope="module")
def policies() -> Policies:
    return Policies(create_app(Settings()), BASE)


def test_every_socket_has_a_role(policies: Policies) -> None:
    sockets = {each.path: each.policy.role for each in policies.routes if not each.method}
    assert sockets == dict.fromkeys(
        ("/devices/{device}/telemetry", "/devices/{device}/program/watch", "/conditions"), "look"
    )


@given(st.sampled_from(METHODS), st.text(), st.data())
def test_no_address_gets_past_the_roles(policies: Policies, method: str, text: str, data: st.DataObject) -> None:
    """Whatever stands in an address: only those calls that are named are for `look`, and tokens for nobody else."""
    path = data.draw(st.sampled_from([f"{BASE}/{text}", f"{BASE}/devices/{text}", f"{BASE}/tokens/{text}", text]))
    needed = policies.role(method, path)
    if path.startswith(f"{BASE}/tokens"):
        assert needed == "administer"
    elif method in SAFE_METHODS:
        assert needed == "look"
    elif needed == "look":
        looks = (each.path for each in policies.routes if each.method == method and each.policy.role == "look")
        named = (re.sub(r"{[^}]*}", "[^/]+", BASE + each) for each in looks)
        assert any(re.fullmatch(pattern, path) for pattern in named)
    else:
        assert needed == "drive"


@given(st.text(st.characters(exclude_characters="/"), min_size=1))
def test_a_stop_is_for_every_role_whatever_the_device_is_called(policies: Policies, name: str) -> None:
    stops = [(each.method, each.path) for each in policies.routes if each.policy.stops]
    assert len(stops) == 5 + len(PROCEDURES)  # of everything, an axis, a program, a study and a straight line
    for method, path in stops:
        assert policies.role(method, BASE + re.sub("{[^}]*}", lambda _: name, path)) == "look"


async def test_look_reads_and_stops_and_changes_nothing(guarded: tuple[FastAPI, dict[Role, str]]) -> None:
    app, tokens = guarded
    async with as_one(app, tokens["look"]) as look, as_one(app, tokens["drive"]) as drive:
        moved = await drive.post(f"{BASE}/devices/bench/axes/0/move", json={"target": 100_000})
        assert moved.is_success, moved.text
        assert (await look.get(f"{BASE}/devices/bench/axes/0")).json()["moving"]
        refused = await look.post(f"{BASE}/devices/bench/axes/0/move", json={"target": 0})
        assert refused.json()["type"] == TOO_LOW
        lease = await look.post(f"{BASE}/lease", json={"name": "x"}, headers={"stepscope-session": "s" * 20})
        assert lease.json()["type"] == TOO_LOW
        assert (await look.get(f"{BASE}/lease")).json()["state"] == "free"
        assert (await look.post(f"{BASE}/stop")).json()["results"]
        assert (await look.post(f"{BASE}/devices/bench/axes/0/stop")).status_code == 200


async def test_reading_what_reading_clears_is_no_looking(guarded: tuple[FastAPI, dict[Role, str]]) -> None:
    app, tokens = guarded
    async with as_one(app, tokens["drive"]) as drive, as_one(app, tokens["look"]) as look:
        body = {"name": "S", "model": "tmc4361", "link": {"kind": "emulator"}}
        assert (await drive.post(f"{BASE}/devices", json=body)).status_code == 201
        refused = await look.get(f"{BASE}/devices/s/registers/EVENTS")
        assert (refused.status_code, refused.json()["type"]) == (403, TOO_LOW)
        assert (await look.get(f"{BASE}/devices/s/registers/XACTUAL")).status_code == 200
        assert (await drive.get(f"{BASE}/devices/s/registers/EVENTS")).status_code == 200


async def test_the_tokens_name_is_in_the_lease_and_in_the_audit_log(guarded: tuple[FastAPI, dict[Role, str]]) -> None:
    app, tokens = guarded
    session = {"stepscope-session": "a-session-of-somebody", "stepscope-name": "The%20Boss"}
    async with as_one(app, tokens["drive"]) as drive, as_one(app, tokens["look"]) as look:
        taken = await drive.post(f"{BASE}/lease", json={"name": "The Boss"}, headers=session)
        assert taken.json()["holder"] == "drive only", "who one is, the token says"
        written = await drive.put(f"{BASE}/devices/bench/registers/V_MAX?axis=0", json={"value": 1000}, headers=session)
        assert written.is_success, written.text
        await look.put(f"{BASE}/devices/bench/registers/V_MAX?axis=0", json={"value": 1}, headers=session)
        entries = (await look.get(f"{BASE}/audit")).json()["entries"]
    mine = [(entry["who"], entry["action"], entry["outcome"].partition(":")[0]) for entry in entries]
    assert ("drive only", "lease taken", "done") in mine
    assert ("drive only", "write", "done") in mine
    assert ("look only", "write", "refused") in mine
