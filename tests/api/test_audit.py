"""The audit log over REST: what is entered for each call, and by whom."""

from __future__ import annotations

import csv
import io
import json
import logging
import sqlite3
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.api.audit import wording as audit_words
from app.api.http.guard import SAFE_METHODS
from app.api.http.policies import Policies
from app.devices.core.events import LimitReached
from app.errors import LinkTimeout
from app.main import bench_of, create_app
from app.settings import Settings
from app.store.database import FILE_NAME

SESSION = "0123456789abcdef-of-a-tab"
Entry = dict[str, Any]


async def entries(client: httpx.AsyncClient, **query: object) -> list[Entry]:
    answer = await client.get("audit", params={"limit": 500, **query})  # type: ignore[dict-item]
    assert answer.status_code == 200, answer.text
    found: list[Entry] = answer.json()["entries"]
    return found


def told(entry: Entry, *names: str) -> tuple[object, ...]:
    return tuple(entry[name] for name in names)


async def test_a_write_is_entered_once_with_old_and_new(client: httpx.AsyncClient) -> None:
    await client.put(
        "devices/bench/registers/V_MAX?axis=1", json={"value": 777}, headers={"Stepscope-Name": "Zo%C3%AB"}
    )
    await client.put("devices/bench/registers/V_MAX?axis=1", json={"value": 778})
    second, first = await entries(client, q="v_max")
    assert told(first, "who", "kind", "device", "axis", "action", "subject", "new", "outcome") == (
        *("Zoë", "client", "bench", 1, "write", "v_max"),
        *(777, "done"),
    )
    assert told(second, "old", "new") == (777, 778)
    assert first["address"] == "127.0.0.1"
    assert second["id"] > first["id"]


async def test_a_field_is_entered_by_its_name(client: httpx.AsyncClient) -> None:
    await client.put("devices/bench/registers/pmul?axis=0", json={"value": 99})
    (entry,) = await entries(client, q="pmul 99")
    assert entry["subject"] == "pmul_pdiv"
    assert "pmul " in entry["detail"]
    assert entry["detail"].endswith("-> 99")


@pytest.mark.parametrize(
    ("path", "body", "subject", "new", "why"),
    [
        ("devices/bench/registers/V_MAX?axis=0", {"value": 99_999}, "V_MAX", 99_999, "allowed is 0..2047"),
        ("devices/bench/registers/nothing", {"value": 1}, "nothing", 1, "no register is called"),
        ("devices/nobody/registers/V_MAX", {"value": 1}, "V_MAX", 1, "no device is called"),
        ("devices/bench/registers/V_MAX?axis=0", {"value": "x"}, "V_MAX", "x", "value"),
    ],
)
async def test_what_is_refused_is_entered_with_its_reason(
    client: httpx.AsyncClient, path: str, body: Entry, subject: str, new: object, why: str
) -> None:
    assert (await client.put(path, json=body)).status_code in (404, 422)
    (entry,) = await entries(client, outcome="refused")
    assert told(entry, "action", "subject", "old", "new") == ("write", subject, None, new)
    assert why in entry["outcome"]


async def test_a_batch_is_entered_as_far_as_it_came(client: httpx.AsyncClient) -> None:
    writes = [
        {"name": "v_min", "axis": 0, "value": 3},
        {"name": "v_min", "axis": 0, "value": 3_000_000},
        {"name": "v_min", "axis": 0, "value": 4},
    ]
    await client.post("devices/bench/registers", json={"writes": writes})
    refused, done = await entries(client, action="write")
    assert told(done, "subject", "new", "outcome") == ("v_min", 3, "done")
    assert told(refused, "subject", "axis", "new") == ("v_min", 0, 3_000_000)
    assert refused["outcome"].startswith("refused: v_min is 3000000")


async def test_a_write_without_an_answer_is_not_proven_and_entered_once(
    app: FastAPI, client: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    device = bench_of(app).manager.get("bench")
    exchange = device.session.port.exchange
    written = False

    async def silent(frame: bytes, *given: Any, **more: Any) -> bytes:
        nonlocal written
        if written or frame[0] == 0x06:  # the write of v_max of axis 0, and everything behind it
            written = True
            raise LinkTimeout("emulator", 0.1, "a write")
        return await exchange(frame, *given, **more)

    monkeypatch.setattr(device.session.port, "exchange", silent)
    assert (await client.put("devices/bench/registers/v_max?axis=0", json={"value": 7})).status_code == 504
    (entry,) = await entries(client, q="v_max")
    assert told(entry, "subject", "new") == ("v_max", 7)
    assert entry["old"] is not None
    assert entry["outcome"].startswith("not proven: ")


async def test_moves_rotations_and_stops(client: httpx.AsyncClient) -> None:
    await client.post("devices/bench/axes/0/move", json={"target": 2000})
    await client.post("devices/bench/axes/0/move", json={"target": 2e9})
    await client.post("devices/bench/axes/1/rotate", json={"velocity": 200, "unit": "pps"})
    await client.post("devices/bench/axes/1/stop", json={"mode": "immediate"})
    await client.post("stop")
    everything, stop, rotate, refused, move = (await entries(client))[:5]
    assert told(move, "action", "subject", "axis", "old", "new", "outcome") == ("move", "position", 0, 0, 2000, "done")
    assert told(refused, "action", "new") == ("move", 2e9)
    assert refused["outcome"].startswith("refused: target of axis 0")
    assert told(rotate, "action", "axis", "new", "detail") == ("rotate", 1, 200, "pps")
    assert told(stop, "action", "axis", "detail") == ("stop", 1, "mode: immediate")
    assert told(everything, "action", "device", "outcome") == ("stop everything", None, "done")


async def test_each_axis_of_a_common_move_is_entered(client: httpx.AsyncClient) -> None:
    body = {"moves": [{"axis": 0, "target": 100}, {"axis": 2, "target": -50}]}
    assert (await client.post("devices/bench/move", json=body)).status_code == 200
    assert [told(entry, "axis", "new") for entry in await entries(client, action="move")] == [(2, -50), (0, 100)]


async def test_each_setting_of_a_connection_that_is_edited_is_entered(client: httpx.AsyncClient) -> None:
    await client.patch("devices/slider", json={"clock_hz": 8e6})
    device = (await client.get("devices/slider")).json()
    axes = [
        {name: axis[name] for name in ("name", "full_steps_per_rev", "driver_microsteps", "travel_mm_per_rev")}
        | {"gear_ratio": 2.5}
        for axis in device["axes"]
    ]
    assert (await client.patch("devices/slider", json={"axes": axes})).status_code == 200
    by_setting = {entry["subject"]: told(entry, "old", "new") for entry in await entries(client, action="edit device")}
    assert by_setting == {"clock_hz": (16e6, 8e6), "axes.0.gear_ratio": (1.0, 2.5)}


async def test_connections_come_and_go(client: httpx.AsyncClient) -> None:
    body = {"name": "New one", "model": "tmc5160", "link": {"kind": "emulator"}}
    await client.post("devices", json=body)
    await client.post("devices/new-one/disconnect")
    await client.post("devices/new-one/connect")
    await client.delete("devices/new-one")
    found = [told(entry, "action", "device", "subject", "detail") for entry in (await entries(client))[:4]]
    assert found == [
        ("remove device", "new-one", "", ""),
        ("connect", "new-one", "", ""),
        ("disconnect", "new-one", "", ""),
        ("add device", "new-one", "New one", "tmc5160, emulator"),
    ]


async def test_a_raw_frame_is_entered_by_what_it_wrote(client: httpx.AsyncClient, motor: str) -> None:
    await client.post("devices/bench/exchange", json={"frame": "04000009"})  # v_min of axis 0
    await client.post("devices/bench/exchange", json={"frame": "05000000"})  # reads it
    await client.post(f"{motor}/tmcl", json={"command": "SAP", "type": 4, "value": 1234})
    await client.post(f"{motor}/tmcl", json={"command": "ROR", "value": 500})
    turned, speed, v_min = (await entries(client))[:3]
    assert told(v_min, "action", "subject", "new") == ("write", "v_min", 9)
    assert v_min["outcome"].startswith("not proven: a raw frame")
    assert told(speed, "action", "subject", "new") == ("write", "maximum_positioning_speed", 1234)
    assert told(turned, "action", "device") == ("TMCL", "motor")
    assert "ROR" in turned["subject"]


async def test_the_lease_tells_of_itself_and_keeps_its_secret(client: httpx.AsyncClient) -> None:
    secret = {"Stepscope-Session": SESSION}
    await client.post("lease", json={"name": "Zoë"}, headers=secret)
    await client.put("lease", json={}, headers=secret)
    refused = await client.put("devices/bench/registers/V_MAX?axis=0", json={"value": 5})
    assert refused.status_code == 409
    await client.put("devices/bench/registers/V_MAX?axis=0", json={"value": 5}, headers=secret)
    await client.delete("lease", headers=secret)
    back, write, no, taken = (await entries(client))[:4]
    assert told(taken, "action", "who", "subject") == ("lease taken", "Zoë", "Zoë")
    assert told(no, "action", "subject") == ("write", "V_MAX")
    assert no["outcome"].startswith("refused: Zoë has the bench")
    assert told(write, "who", "new") == ("Zoë", 5)
    assert told(back, "action", "who") == ("lease given back", "Zoë")


async def test_a_holder_that_vanished_is_nobodys_doing(client: httpx.AsyncClient, clock: Any) -> None:
    await client.post("lease", json={"name": "Zoë"}, headers={"Stepscope-Session": SESSION})
    await clock.advance(60)
    await client.get("lease")
    (entry,) = await entries(client, action="lease vanished")
    assert told(entry, "who", "kind", "subject") == ("stepscope", "server", "Zoë")


async def test_what_changes_nothing_is_not_entered(client: httpx.AsyncClient) -> None:
    before = len(await entries(client))
    await client.get("devices")
    await client.post("calc/pmul-pdiv", json={"chip": "tmc428", "a_max": 500, "ramp_div": 7, "pulse_div": 5})
    await client.post("devices/test", json={"model": "tmc428", "link": {"kind": "emulator"}})
    await client.get("audit")
    assert len(await entries(client)) == before


async def test_what_the_demo_sets_up_is_nobodys_doing(client: httpx.AsyncClient) -> None:
    (start,) = await entries(client)
    assert told(start, "action", "who", "kind") == ("start", "stepscope", "server")


def test_no_address_is_forgotten(app: FastAPI) -> None:
    """Each call that may change something is silent by intent, or has words; those of a device name it."""
    unnamed = {"device": "bench", "axis": "1", "name": "v_max"}
    policies = Policies(app, "/api/v1")
    for path, methods in app.openapi()["paths"].items():
        for method in methods:
            if method.upper() in SAFE_METHODS:
                continue
            address = path.removeprefix("/api/v1/").format_map(_Names(unnamed))
            call = audit_words.taken_apart(method.upper(), address, b"", policies.plain)
            policy = policies.of_call(call.key)
            if audit_words.is_silent(policy, call):
                continue
            said = audit_words.in_words(policy, call)
            assert said.action.strip(), path
            assert call.device == ("bench" if "{device}" in path else None), path
            assert call.axis == (1 if "{axis}" in path else None), path


class _Names(dict[str, str]):
    def __missing__(self, name: str) -> str:
        return "7"


# --- looking ------------------------------------------------------------------------------------


async def write_some(client: httpx.AsyncClient, count: int) -> None:
    for number in range(count):
        await client.put("devices/bench/registers/v_min?axis=0", json={"value": number})


async def test_it_comes_in_pages(client: httpx.AsyncClient) -> None:
    await write_some(client, 5)
    first = (await client.get("audit", params={"q": "v_min", "limit": 2})).json()
    assert [entry["new"] for entry in first["entries"]] == [4, 3]
    assert first["more"] is True
    last = first["entries"][-1]["id"]
    rest = (await client.get("audit", params={"q": "v_min", "before": last})).json()
    assert [entry["new"] for entry in rest["entries"]] == [2, 1, 0]
    assert rest["more"] is False
    newer = (await client.get("audit", params={"q": "v_min", "after": last})).json()
    assert [entry["new"] for entry in newer["entries"]] == [4]


async def test_times_are_understood_as_people_write_them(client: httpx.AsyncClient) -> None:
    await write_some(client, 1)
    (entry,) = await entries(client, q="v_min")
    for since in (entry["time"], entry["time"].replace("Z", "+00:00")):
        assert (await client.get(f"audit?q=v_min&since={since}")).json()["entries"], since
        assert not (await client.get(f"audit?q=v_min&until={since}")).json()["entries"], since
    for other in ("yesterday", "1700000000", "0.5"):
        assert (await client.get(f"audit?since={other}")).status_code == 422, other


async def test_it_comes_as_csv_that_no_spreadsheet_runs(
    client: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.api.audit.routes.PIECE", 2)
    monkeypatch.setattr("app.audit.csv_text.PIECE", 2)
    await client.put(
        "devices/bench/registers/v_min?axis=0", json={"value": 9}, headers={"Stepscope-Name": "=HYPERLINK(1)"}
    )
    await write_some(client, 4)
    await client.post("devices/bench/axes/0/move", json={"target": -5})
    answer = await client.get("audit", params={"format": "csv", "device": "bench"})
    assert answer.headers["content-type"].startswith("text/csv")
    assert "attachment" in answer.headers["content-disposition"]
    rows = list(csv.DictReader(io.StringIO(answer.text)))
    assert [row["new"] for row in rows] == ["-5", "3", "2", "1", "0", "9"]
    assert rows[-1]["who"] == "'=HYPERLINK(1)"


async def test_there_is_a_list_of_what_to_filter_by(client: httpx.AsyncClient) -> None:
    await write_some(client, 1)
    await client.post("stop")
    known = (await client.get("audit/filters")).json()
    assert known["devices"] == ["bench"]
    assert known["actions"] == ["start", "stop everything", "write"]
    assert "stepscope" in known["who"]


async def test_a_database_of_a_newer_version_stops_no_motor(settings: Settings) -> None:
    settings.data_dir.mkdir()
    with sqlite3.connect(settings.data_dir / FILE_NAME) as newer:
        newer.execute("CREATE TABLE alembic_version (version_num VARCHAR)")
        newer.execute("INSERT INTO alembic_version VALUES ('9999')")
    newer.close()
    app = create_app(settings)
    async with app.router.lifespan_context(app):
        transport = httpx.ASGITransport(app)
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000/api/v1/") as client:
            written = await client.put("devices/bench/registers/v_min?axis=0", json={"value": 9})
            assert written.json()["verified"]
            answer = await client.get("audit")
            assert answer.status_code == 503
            assert answer.json()["type"] == "/problems/store-unavailable"
            assert "newer stepscope" in answer.json()["detail"]
            assert "--data-dir" in answer.json()["way_out"]


async def test_no_token_and_no_session_gets_into_log_or_database(
    settings: Settings, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    token = "a-token-that-nobody-guesses"
    settings = Settings.model_validate({**settings.model_dump(), "token": token})
    app = create_app(settings)
    headers = {"Authorization": f"Bearer {token}", "Stepscope-Session": SESSION, "Stepscope-Name": "Ann"}
    async with app.router.lifespan_context(app):
        transport = httpx.ASGITransport(app)
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000/api/v1/") as client:
            client.headers.update(headers)
            for call in (
                client.post("lease", json={"name": "Ann"}),
                client.put("devices/bench/registers/v_min?axis=0", json={"value": 9}),
                client.put("devices/bench/registers/v_min?axis=0", json={"value": 99_999}),
                client.post("devices/bench/axes/0/move", json={"target": 5}),
                client.patch("devices/bench", json={"clock_hz": 8e6}),
                client.post("devices/bench/nowhere", json={"a": 1}),
                client.post(f"devices/bench/axes/0/stop?token={token}"),
                client.delete("lease"),
            ):
                assert (await call).status_code != 401
            shown = json.dumps((await client.get("audit")).json())
            shown += (await client.get("audit?format=csv")).text
    assert "Ann" in shown
    kept = b"".join(_contents(settings.data_dir))
    for secret in (token, SESSION):
        assert secret not in shown
        assert not [record for record in caplog.records if secret in record.getMessage() and record.name != "httpx"]
        assert secret.encode() not in kept


def _contents(folder: Path) -> list[bytes]:
    return [path.read_bytes() for path in folder.rglob("*") if path.is_file()]


async def test_a_stop_at_a_limit_is_the_servers_own(app: FastAPI, client: httpx.AsyncClient) -> None:
    bench_of(app).manager.get("bench").stopped_by_limit(LimitReached(1, "position_max", 5000, 4990))
    (entry,) = await entries(client, action="stop at limit")
    assert told(entry, "who", "device", "axis", "subject", "new") == ("stepscope", "bench", 1, "position_max", 5000)
