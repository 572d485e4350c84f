"""Pages of other web sites cannot use the bench; scripts can."""

from __future__ import annotations

import httpx
import pytest

from app.api.http.guard import host_is_ours, host_name, origin_is_ours
from app.main import create_app
from app.settings import Settings


@pytest.mark.parametrize(
    ("authority", "name"),
    [
        ("127.0.0.1:8000", "127.0.0.1"),
        ("[::1]:8000", "::1"),
        ("Bench.Local", "bench.local"),
        ("a.com.", "a.com"),
        ("", ""),
    ],
)
def test_the_name_of_an_authority(authority: str, name: str) -> None:
    assert host_name(authority) == name


@pytest.mark.parametrize(
    "authority",
    ["127.0.0.1:8000", "[::1]:8000", "localhost:8000", "192.168.1.20", "bench-pc:8000", "bench.local", "x.localhost:1"],
)
def test_addresses_and_local_names_are_ours(authority: str) -> None:
    assert host_is_ours(authority, frozenset())


LOCAL = ["127.0.0.1:8000", "127.8.9.1", "[::1]:8000", "localhost:8000", "LOCALHOST.", "x.localhost:1"]
ELSEWHERE = ["evil.local", "bench-pc:8000", "192.168.1.20", "[fe80::1]", "localhost.local", "localhostx", "0.0.0.0"]


@pytest.mark.parametrize("authority", LOCAL)
def test_a_server_of_one_machine_takes_the_names_of_that_machine(authority: str) -> None:
    assert host_is_ours(authority, frozenset(), local=True)


@pytest.mark.parametrize("authority", ELSEWHERE)
def test_and_none_that_somebody_in_the_network_can_give_out(authority: str) -> None:
    assert not host_is_ours(authority, frozenset(), local=True)
    assert host_is_ours(authority, frozenset({host_name(authority)}), local=True)


@pytest.mark.parametrize("name", ["evil.local:8000", "bench-pc:8000"])
async def test_a_name_of_the_network_moves_nothing_on_a_server_without_a_token(
    client: httpx.AsyncClient, name: str
) -> None:
    headers = {"host": name, "origin": f"http://{name}"}
    for method, path in (("GET", "devices"), ("POST", "devices/bench/axes/0/move")):
        answer = await client.request(method, path, headers=headers, json={"target": 100})
        assert answer.status_code == 403
        assert "STEPSCOPE_ALLOWED_HOSTS" in answer.json()["detail"]
    assert (await client.get("devices/bench/axes/0")).json()["position"] == 0


async def _with_an_event(client: httpx.AsyncClient) -> str:
    """The address of a register that reading clears, of a chip that nothing else looks at, with something in it."""
    link = {"kind": "emulator"}
    assert (await client.post("devices", json={"name": "Six", "model": "tmc5130", "link": link})).status_code == 201
    return "devices/six/registers/GSTAT"


@pytest.mark.parametrize(
    "headers", [{"sec-fetch-site": "cross-site"}, {"sec-fetch-site": "same-site"}, {"origin": "http://evil.com"}]
)
async def test_a_foreign_page_clears_no_register_by_reading_it(
    client: httpx.AsyncClient, headers: dict[str, str]
) -> None:
    where = await _with_an_event(client)
    answer = await client.get(where, headers=headers)
    assert answer.status_code == 403
    assert answer.json()["type"] == "/problems/foreign-origin"
    assert (await client.get("devices/six/registers/GCONF", headers=headers)).status_code == 200
    assert (await client.get(where, headers={"sec-fetch-site": "same-origin"})).status_code == 200


async def test_neither_does_who_only_looks(client: httpx.AsyncClient) -> None:
    where = await _with_an_event(client)
    anna, otto = ({"stepscope-session": f"session-of-{name}-0001"} for name in ("anna", "otto"))
    assert (await client.get(where, headers=otto)).json()["type"] == "/problems/bench-not-taken"
    assert (await client.post("lease", json={"name": "Anna"}, headers=anna)).status_code == 200
    for headers in (otto, {}):
        assert (await client.get(where, headers=headers)).json()["type"] == "/problems/bench-taken"
    assert (await client.get(where, headers=anna)).status_code == 200
    assert (await client.get("devices/six/registers/GCONF", headers=otto)).status_code == 200


@pytest.mark.parametrize("authority", ["evil.com", "127.0.0.1.evil.com:8000", "localhost.evil.com", "", ":8000"])
def test_names_of_public_dns_are_not(authority: str) -> None:
    assert not host_is_ours(authority, frozenset())


def test_a_name_that_the_settings_allow_is_ours() -> None:
    assert host_is_ours("Bench.Example.com:443", frozenset({"bench.example.com"}))
    assert origin_is_ours("https://bench.example.com", "10.0.0.2:8000", frozenset({"bench.example.com"}))


@pytest.mark.parametrize(
    "origin", ["null", "file://", "http://localhost:5173", "http://127.0.0.1", "chrome-extension://x"]
)
def test_another_origin_is_foreign(origin: str) -> None:
    assert not origin_is_ours(origin, "127.0.0.1:8000", frozenset())


def test_our_own_page_is_not() -> None:
    assert origin_is_ours("http://127.0.0.1:8000", "127.0.0.1:8000", frozenset())


FOREIGN = [
    {"origin": "http://evil.com"},
    {"origin": "null"},
    {"origin": "http://127.0.0.1:9999"},
    {"sec-fetch-site": "cross-site"},
    {"sec-fetch-site": "same-site"},
]


@pytest.mark.parametrize("headers", FOREIGN)
@pytest.mark.parametrize(
    ("method", "path"), [("POST", "stop"), ("PUT", "devices/bench/registers/v_max?axis=0"), ("DELETE", "devices/bench")]
)
async def test_a_foreign_page_changes_nothing(
    client: httpx.AsyncClient, headers: dict[str, str], method: str, path: str
) -> None:
    answer = await client.request(method, path, headers=headers)
    assert answer.status_code == 403
    assert answer.json()["type"] == "/problems/foreign-origin"
    assert (await client.get("devices/bench")).status_code == 200


async def test_a_rebound_name_reads_nothing_either(client: httpx.AsyncClient) -> None:
    answer = await client.get("devices", headers={"host": "evil.com"})
    assert answer.status_code == 403
    assert "STEPSCOPE_ALLOWED_HOSTS" in answer.json()["detail"]


@pytest.mark.parametrize("headers", [{}, {"origin": "http://127.0.0.1:8000"}, {"sec-fetch-site": "same-origin"}])
async def test_scripts_and_our_own_page_may(client: httpx.AsyncClient, headers: dict[str, str]) -> None:
    assert (await client.post("stop", headers=headers)).status_code == 200


def test_allowed_hosts_come_from_a_variable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STEPSCOPE_ALLOWED_HOSTS", "Bench.example.com, 10.0.0.7 ,")
    settings = Settings()
    assert settings.allowed_hosts == ("bench.example.com", "10.0.0.7")
    assert create_app(settings).title == "stepscope"
