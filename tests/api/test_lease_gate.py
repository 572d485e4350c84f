"""Nothing that may change something gets past the lease: every route of the program is tried."""

from __future__ import annotations

import re
from collections.abc import Iterator

import httpx
import pytest
from fastapi import FastAPI
from fastapi.routing import iter_route_contexts

from app.api.http.guard import SAFE_METHODS
from app.api.http.policies import CHANGING_METHODS, Policies
from app.api.router import BASE

HOLDER = {"stepscope-session": "the-session-of-the-holder"}
OTHER = {"stepscope-session": "the-session-of-somebody-else"}
NAMES = {"device": "bench", "axis": "0", "name": "v_max", "subject": "units", "parameter": "v_max"}
AXIS = "/devices/{device}/axes/{axis}"
CALCULATORS = (
    "pmul-pdiv",
    "ramp-inverse",
    "units",
    "ramp",
    "coil-current",
    "chopper",
    "microstep-correction",
    "microstep-table",
    "driver-chain",
    "input-filter",
    "serial-encoder",
    "target-sequence",
    "current-scales",
    "scale-current",
    "drive-current",
    "pwm-duty",
    "driver-sync",
    "start-stop",
    "start-stop",
    "driver-sync",
    "drive-current",
    "pwm-duty",
)
FREE = {
    ("POST", "/stop"),
    ("POST", f"{AXIS}/stop"),
    # Aborting a procedure stops its motor.
    ("DELETE", f"{AXIS}/reference-search"),
    ("DELETE", f"{AXIS}/shuttle"),
    ("DELETE", f"{AXIS}/closed-loop-calibration"),
    ("DELETE", f"{AXIS}/step-response"),
    ("DELETE", f"{AXIS}/disturbance"),
    ("DELETE", f"{AXIS}/velocity-profile"),
    # What motors there are moves none.
    ("PUT", "/motors/{motor}"),
    ("DELETE", "/motors/{motor}"),
    # Nor does where panels stand.
    ("POST", "/layouts"),
    ("PUT", "/layouts/{layout}"),
    ("DELETE", "/layouts/{layout}"),
    # Nor do macros that are only kept, or tried on a twin; to end one stops its motors.
    ("POST", "/macros"),
    ("PUT", "/macros/{macro}"),
    ("DELETE", "/macros/{macro}"),
    ("POST", "/devices/{device}/macro-trial"),
    ("DELETE", "/devices/{device}/macro-run"),
    # A profile that is only judged moves nothing.
    ("POST", f"{AXIS}/velocity-profile/check"),
    # A program that is stopped moves no motor, and one that is only assembled goes nowhere.
    ("POST", "/devices/{device}/program/stop"),
    ("DELETE", "/devices/{device}/program/debug"),
    ("POST", "/devices/{device}/program/assemble"),
    ("POST", "/devices/{device}/program/disassemble"),
    ("POST", "/devices/{device}/program/try"),
    # Who may come in moves no motor.
    ("POST", "/access/log-out"),
    ("POST", "/tokens"),
    ("DELETE", "/tokens/{name}"),
    ("POST", "/lease"),
    ("PUT", "/lease"),
    ("DELETE", "/lease"),
    ("POST", "/lease/ask"),
    ("POST", "/lease/leave"),
    ("POST", "/lease/hand-over"),
    *(("POST", f"/calc/{subject}") for subject in CALCULATORS),
    # Recordings and saved documents move no motor.
    ("POST", "/recordings"),
    ("PATCH", "/recordings/{recording}"),
    ("POST", "/recordings/{recording}/stop"),
    ("POST", "/recordings/{recording}/marks"),
    ("POST", "/recordings/{recording}/replay"),
    ("POST", "/recordings/compare"),
    ("POST", "/recordings/{recording}/added"),
    ("PATCH", "/recordings/{recording}/added/{number}"),
    ("POST", "/profiles"),
    ("PATCH", "/profiles/{profile}"),
    ("POST", "/profiles/compare"),
    ("POST", "/profiles/script"),
    # A study that is only planned moves nothing; one that is stopped goes back to how it was.
    ("POST", "/studies/plan"),
    ("POST", "/straight-line/plan"),
    ("DELETE", "/straight-line"),
    ("POST", "/studies/{study}/stop"),
    ("POST", "/studies/{study}/profiles"),
    # To notice the moves of others moves nothing.
    ("PUT", "/devices/{device}/axes/{axis}/noticed-moves"),
    ("DELETE", "/devices/{device}/axes/{axis}/noticed-moves"),
    ("POST", "/twin"),
    ("DELETE", "/twin"),
    ("POST", "/twin/cursor"),
}
"""What may be done without the bench, by this test's own reading: nothing gets free by a slip beside its route."""
TAKEN, NOT_TAKEN = "/problems/bench-taken", "/problems/bench-not-taken"


def unsafe_routes(app: FastAPI) -> Iterator[tuple[str, str]]:
    """Method and address under the API of everything that may change something, hidden routes too."""

    for context in iter_route_contexts(app.routes):
        methods, path = getattr(context, "methods", None), getattr(context, "path", None)
        for method in sorted(set(methods or ()) - SAFE_METHODS):
            assert path is not None
            yield method, path


def filled(path: str) -> str:
    return re.sub(r"{([^}:]*)(:int)?[^}]*}", lambda part: NAMES.get(part[1], "1" if part[2] else "x"), path)


def shape(path: str) -> str:
    """An address whatever its parameters are called."""
    return re.sub(r"{[^}]*}", "{}", path)


async def test_every_route_is_refused_or_known_to_be_free(app: FastAPI, pages: httpx.AsyncClient) -> None:
    assert (await pages.post(f"{BASE}/lease", json={"name": "Anna"}, headers=HOLDER)).status_code == 200
    known = {
        (each.method, shape(BASE + each.path))
        for each in Policies(app, BASE).routes
        if each.policy.lease == "free" and each.method in CHANGING_METHODS
    }
    assert known == {(method, shape(BASE + path)) for method, path in FREE}
    tried = refused = 0
    for method, path in unsafe_routes(app):
        free = (method, shape(path)) in known
        if path == f"{BASE}/lease" or path.startswith(f"{BASE}/lease/"):
            assert free
            continue  # they decide for themselves: test_lease_calls
        for headers in ({}, OTHER):
            answer = await pages.request(method, filled(path), headers=headers)
            if answer.status_code == 405:
                continue  # a name that keeps an address from being taken for another: nothing is behind it
            is_refused = (
                answer.headers.get("content-type", "").endswith("problem+json") and answer.json()["type"] == TAKEN
            )
            assert is_refused is not free, f"{method} {path}: {answer.status_code} {answer.text[:200]}"
            if is_refused:
                problem = answer.json()
                assert problem["status"] == answer.status_code == 409
                assert problem["facts"]["holder"] == "Anna"
                assert "Anna" in problem["detail"]
                assert "lease/ask" in problem["way_out"]
        tried += 1
        refused += not free
    assert tried > 50
    assert refused > 30
    lease = (await pages.get(f"{BASE}/lease", headers=HOLDER)).json()
    assert (lease["mine"], lease["holder"]) == (True, "Anna")


async def test_a_session_that_only_looks_is_refused_too(app: FastAPI, pages: httpx.AsyncClient) -> None:
    needs_lease = [
        (method, path) for method, path in unsafe_routes(app) if not Policies(app, BASE).needs_no_lease(method, path)
    ]
    assert len(needs_lease) > 30
    for method, path in needs_lease:
        answer = await pages.request(method, filled(path), headers=OTHER)
        assert (answer.status_code, answer.json()["type"]) == (409, NOT_TAKEN), f"{method} {path}"
        assert "POST /lease" in answer.json()["way_out"]


def test_no_route_changes_anything_by_another_method(app: FastAPI) -> None:
    assert {method for method, _ in unsafe_routes(app)} <= CHANGING_METHODS


@pytest.mark.parametrize(("method", "path"), [("PUT", "lease/leave"), ("PATCH", "stop"), ("DELETE", "devices")])
async def test_an_address_without_that_method_is_405_whoever_has_the_bench(
    pages: httpx.AsyncClient, method: str, path: str
) -> None:
    assert (await pages.post(f"{BASE}/lease", json={"name": "Anna"}, headers=HOLDER)).status_code == 200
    assert (await pages.request(method, f"{BASE}/{path}", headers=OTHER)).status_code == 405
    assert (await pages.request(method, f"{BASE}/nothing", headers=OTHER)).status_code == 404


@pytest.mark.parametrize("method", ["QUERY", "TRACE", "PROPFIND", "LINK"])
async def test_a_method_of_no_route_is_405_whoever_has_the_bench(pages: httpx.AsyncClient, method: str) -> None:
    assert (await pages.post(f"{BASE}/lease", json={"name": "Anna"}, headers=HOLDER)).status_code == 200
    for path in ("stop", "lease/leave", "devices/bench/registers/v_max"):
        assert (await pages.request(method, f"{BASE}/{path}", headers=OTHER)).status_code == 405


def test_every_refusal_is_in_the_schema(app: FastAPI) -> None:
    for path, operations in app.openapi()["paths"].items():
        for method, operation in operations.items():
            told = TAKEN in operation["responses"].get("409", {}).get("description", "")
            own = path == f"{BASE}/lease" or path.startswith(f"{BASE}/lease/")
            if not own:
                assert told is not Policies(app, BASE).needs_no_lease(method.upper(), path), f"{method} {path}"


@pytest.mark.parametrize(
    ("method", "path", "query", "free"),
    [
        ("POST", "/api/v1/stop", b"", True),
        ("POST", "/api/v1/stop/", b"", False),
        ("POST", "/api/v1//stop", b"", False),
        ("POST", "/api/v1/stop\n", b"", False),
        ("POST", "/api/v1/devices/a/b/axes/0/stop", b"", False),
        ("POST", "/api/v1/devices/bench/axes/0/stop", b"", True),
        ("POST", "/api/v1/devices/stop", b"", False),
        ("PUT", "/api/v1/stop", b"", False),
        ("POST", "/api/v1/calc/ramp", b"", True),
        ("POST", "/api/v1/calc/ramp/../../devices", b"", False),
        ("POST", "/api/v1/devices", b"", False),
        ("PURGE", "/api/v1/devices", b"", True),
        ("post", "/api/v1/devices", b"", True),
        ("POST", "/elsewhere", b"", False),
        ("PUT", "/api/v1/devices/bench/profile", b"", False),
        ("PUT", "/api/v1/devices/bench/profile", b"dry_run=true", True),
        ("PUT", "/api/v1/devices/bench/profile", b"dry_run=false", False),
        ("PUT", "/api/v1/devices/bench/profile", b"dry_run=true&dry_run=false", False),
        ("PUT", "/api/v1/devices/bench/profile", b"dry_run=true&dry_run", False),
        ("PUT", "/api/v1/devices/bench/profile", b"dry_ru%6e=false&dry_run=true", False),
        ("GET", "/api/v1/devices/bench/profile", b"", True),
        ("POST", "/api/v1/devices/bench/start-up", b"", False),
        ("POST", "/api/v1/devices/bench/undo", b"dry_run=true", True),
        ("POST", "/api/v1/devices/bench/undo", b"", False),
        ("POST", "/api/v1/devices/bench/start-up", b"dry_run=true", True),
        ("POST", "/api/v1/devices/bench/start-up", b"dry_run=true&dry_run=false", False),
    ],
)
def test_what_is_free_is_exactly_that(app: FastAPI, method: str, path: str, query: bytes, free: bool) -> None:
    assert Policies(app, BASE).needs_no_lease(method, path, query) is free
