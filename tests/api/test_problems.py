"""Every error leaves as one documented shape."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator, Iterator

import httpx
import pytest
from fastapi import FastAPI

from app.api.http.problems import KINDS, kind_of, problem_of
from app.errors import BadReply, BenchError, LinkDown, LinkTimeout, OutOfRange, UnknownThing, WriteRefused, WrongState
from app.links.queue import SampleDropped


def tree(root: type[BenchError] = BenchError) -> Iterator[type[BenchError]]:
    yield root
    for child in root.__subclasses__():
        yield from tree(child)


@pytest.mark.parametrize("error", [*tree()])
def test_every_error_of_the_tree_has_a_translation_of_its_own(error: type[BenchError]) -> None:
    # SampleDropped never reaches the edge: the sampler counts it.
    assert error in KINDS or error is SampleDropped


@pytest.mark.parametrize(
    ("error", "status", "facts"),
    [
        (UnknownThing("device", "x", ["a", "b"]), 404, {"kind": "device", "name": "x", "known": ["a", "b"]}),
        (WrongState("busy", "wait"), 409, {}),
        (WriteRefused("V_MAX", 5, 4, "masked"), 409, {"register": "V_MAX", "written": 5, "read_back": 4}),
        (LinkDown("tcp x:1", "refused"), 409, {"link": "tcp x:1"}),
        (OutOfRange("v_max", 5000, 0, 2047), 422, {"name": "v_max", "value": 5000, "minimum": 0, "maximum": 2047}),
        (OutOfRange("x", float("nan"), None, 1), 422, {"value": "nan"}),
        (OutOfRange("x", 10**30, None, 1), 422, {"value": str(10**30)}),
        (BadReply("tcp x:1", "short", b"\x01\x02"), 502, {"link": "tcp x:1", "reply": "01 02"}),
        (LinkTimeout("tcp x:1", 0.5, "a read"), 504, {"link": "tcp x:1", "waited_s": 0.5, "what": "a read"}),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, BenchError) else "",
)
def test_an_error_tells_code_its_facts_and_people_the_way_out(
    error: BenchError, status: int, facts: dict[str, object]
) -> None:
    problem = problem_of(error, "/here")
    assert problem.status == status
    assert problem.detail == str(error)
    assert problem.instance == "/here"
    assert problem.type.startswith("/problems/")
    assert problem.facts.items() >= facts.items()
    json.dumps(problem.model_dump(), allow_nan=False)


def test_the_way_out_of_the_error_wins_over_that_of_its_kind() -> None:
    assert problem_of(WrongState("busy", "wait a second")).way_out == "wait a second"
    assert problem_of(LinkDown("x", "refused")).way_out == KINDS[LinkDown].way_out


def test_what_is_not_ours_is_a_failure_of_ours() -> None:
    assert kind_of(ZeroDivisionError).status == 500


def is_problem(answer: httpx.Response, status: int, kind: str) -> dict[str, object]:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem: dict[str, object] = answer.json()
    assert problem["type"] == f"/problems/{kind}"
    assert problem["status"] == status
    return problem


async def test_what_is_no_json_is_400(client: httpx.AsyncClient) -> None:
    url = "devices/bench/axes/0/move"
    for body in (b"{", b"\xff\xfe\x00", b"[" * 50_000, b'{"target": 1e}', b"1" * 5000):
        answer = await client.post(url, content=body, headers={"content-type": "application/json"})
        if body.isdigit():
            assert answer.status_code in (400, 422)
        else:
            is_problem(answer, 400, "undecodable-body")


async def test_another_content_type_is_no_json(client: httpx.AsyncClient) -> None:
    answer = await client.post(
        "devices/bench/axes/0/move", content=b'{"target": 5}', headers={"content-type": "text/plain"}
    )
    is_problem(answer, 422, "invalid-request")


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999"])
async def test_nan_and_infinity_are_no_numbers(client: httpx.AsyncClient, number: str) -> None:
    for url, body in (
        ("devices/bench/axes/0/move", f'{{"target": {number}}}'),
        ("devices/bench/axes/0/rotate", f'{{"velocity": {number}}}'),
        ("calc/pmul-pdiv", f'{{"a_max": 1, "ramp_div": 1, "pulse_div": 1, "reduction": {number}}}'),
        ("calc/ramp", f'{{"model": "trapezoid", "parameters": {{"vmax": {number}, "amax": 1}}, "distance": 1}}'),
    ):
        answer = await client.post(url, content=body, headers={"content-type": "application/json"})
        is_problem(answer, 422, "invalid-request")


@pytest.mark.parametrize("body", [{"target": True}, {"target": "5"}, {"target": None}, {}, {"target": 1, "speed": 2}])
async def test_types_are_strict_and_unknown_keys_errors(client: httpx.AsyncClient, body: dict[str, object]) -> None:
    problem = is_problem(await client.post("devices/bench/axes/0/move", json=body), 422, "invalid-request")
    assert "body" in str(problem["detail"])


async def test_a_table_of_63_entries_names_the_range(client: httpx.AsyncClient) -> None:
    answer = await client.put("devices/bench/microstep-table", json={"values": [1] * 63})
    problem = is_problem(answer, 422, "invalid-request")
    assert "64" in str(problem["detail"])
    assert problem["facts"] == {
        "errors": [
            {
                "where": "body.quarter.values",
                "message": "List should have at least 64 items after validation, not 63",
                "rule": "too_short",
                "minimum_length": 64,
            }
        ]
    }


async def test_a_long_body_is_413_and_not_read(client: httpx.AsyncClient) -> None:
    url = "devices/bench/axes/0/move"
    declared = await client.post(url, content=b" " * 100_001, headers={"content-type": "application/json"})
    is_problem(declared, 413, "body-too-large")

    sent = 0

    async def endless() -> AsyncIterator[bytes]:
        nonlocal sent
        while sent < 100_000_000:
            sent += 10_000
            yield b" " * 10_000

    chunked = await client.post(url, content=endless(), headers={"content-type": "application/json"})
    is_problem(chunked, 413, "body-too-large")


async def test_an_unknown_path_of_the_api_is_a_problem_and_no_page(pages: httpx.AsyncClient) -> None:
    for path in ("/api", "/api/", "/api/v1", "/api/v1/nothing", "/api/v2/health", "/api/v1/devices/"):
        is_problem(await pages.get(path), 404, "no-such-path")


@pytest.mark.parametrize(
    ("method", "path", "allow"),
    [
        ("PUT", "/api/v1/health", "GET"),
        ("DELETE", "/api/v1/devices", "GET, POST"),
        ("GET", "/api/v1/stop", "POST"),
        ("PUT", "/api/v1/devices/bench", "DELETE, GET, PATCH"),
        ("GET", "/api/v1/devices/test", "POST"),
        ("POST", "/api/v1/devices/bench/registers/v_max", "GET, PUT"),
    ],
)
async def test_a_wrong_method_is_405_and_tells_all_right_ones(
    pages: httpx.AsyncClient, method: str, path: str, allow: str
) -> None:
    answer = await pages.request(method, path)
    is_problem(answer, 405, "method-not-allowed")
    assert answer.headers["allow"] == allow


async def test_a_mistake_of_ours_is_a_problem_too(app: FastAPI, pages: httpx.AsyncClient) -> None:
    async def broken() -> None:
        raise ZeroDivisionError("secret")

    app.add_api_route("/api/v1/broken", broken)
    problem = is_problem(await pages.get("/api/v1/broken"), 500, "internal")
    assert "secret" not in str(problem)
