"""A device's history and undo over REST: one change a request, previews, others' writes, and what cannot be undone."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any, cast

import httpx
from fastapi import FastAPI

from app.clock import VirtualClock
from app.links import datagram32
from app.links.emulator import EmulatorPort
from app.main import bench_of

ANN, BOB = {"stepscope-name": "Ann"}, {"stepscope-name": "Bob"}
DRY = {"dry_run": "true"}


async def write(client: httpx.AsyncClient, name: str, value: int, who: dict[str, str] = ANN, axis: int = 1) -> None:
    answer = await client.put(
        f"devices/bench/registers/{name}", params={"axis": axis}, json={"value": value}, headers=who
    )
    assert answer.status_code == 200, answer.text


async def value(client: httpx.AsyncClient, name: str, axis: int = 1) -> int:
    reading = (await client.get(f"devices/bench/registers/{name}", params={"axis": axis})).json()
    return int(reading["value"])


async def changes(client: httpx.AsyncClient, **query: int) -> list[dict[str, Any]]:
    answer = await client.get("devices/bench/history", params=query)
    assert answer.status_code == 200, answer.text
    found: list[dict[str, Any]] = answer.json()["changes"]
    return found


async def undo(
    client: httpx.AsyncClient, body: dict[str, Any], *, dry: bool = False, who: dict[str, str] = ANN
) -> dict[str, Any]:
    answer = await client.post("devices/bench/undo", params=DRY if dry else {}, json=body, headers=who)
    assert answer.status_code == 200, answer.text
    told: dict[str, Any] = answer.json()
    return told


def states(told: dict[str, Any]) -> dict[str, str]:
    return {each["name"]: each["state"] for each in told["registers"]}


async def test_a_request_is_one_change_however_many_registers_it_writes(client: httpx.AsyncClient) -> None:
    document = (await client.get("devices/bench/profile")).json()
    await write(client, "v_max", 777)
    await write(client, "a_max", 99)
    await client.put("devices/bench/profile", json=document | {"name": "quiet"}, headers=ANN)
    applied, second, first = (await changes(client))[:3]
    assert (applied["entry"]["action"], applied["entry"]["subject"], applied["writes"]) == ("apply profile", "quiet", 2)
    assert (second["entry"]["subject"], first["entry"]["subject"]) == ("a_max", "v_max")
    assert (first["entry"]["new"], first["entry"]["who"], first["writes"]) == (777, "Ann", 1)
    assert applied["first"] < applied["last"]
    older = await changes(client, limit=1, before=applied["first"])
    assert older == [second]


async def test_an_applied_profile_is_undone_and_that_is_undone_again(client: httpx.AsyncClient) -> None:
    document = (await client.get("devices/bench/profile")).json()
    was = await value(client, "v_max")
    await write(client, "v_max", 777)
    document["axes"][0]["gear_ratio"] = 2.5
    await client.put("devices/bench/profile", json=document, headers=ANN)
    assert await value(client, "v_max") == was
    applied = (await changes(client))[0]
    preview = await undo(client, {"without": applied["last"]}, dry=True)
    assert (preview["state"], states(preview)) == ("dry run", {"v_max": "ready", "gear_ratio": "ready"})
    assert preview["registers"][0]["was_physical"].endswith("pps")
    assert await value(client, "v_max") == was
    done = await undo(client, {"without": applied["last"]})
    assert (done["state"], [each["name"] for each in done["applied"]["written"]]) == ("applied", ["v_max"])
    assert await value(client, "v_max") == 777
    assert (await client.get("devices/bench")).json()["axes"][0]["gear_ratio"] == 1.0
    undone = (await changes(client))[0]
    assert (undone["entry"]["action"], undone["entry"]["subject"]) == ("undo", f"without entry {applied['last']}")
    await undo(client, {"without": undone["last"]})
    assert await value(client, "v_max") == was
    assert (await client.get("devices/bench")).json()["axes"][0]["gear_ratio"] == 2.5


async def test_as_it_was_at_a_time(client: httpx.AsyncClient) -> None:
    was = await value(client, "v_max")
    await write(client, "v_max", 500)
    then = datetime.now(UTC).isoformat()
    await write(client, "v_max", 600)
    await write(client, "a_max", 77)
    await undo(client, {"since": then})
    assert await value(client, "v_max") == 500
    assert was != 500
    refused = await client.post("devices/bench/undo", params=DRY, json={"since": "2001-01-01T00:00:00Z"})
    assert (refused.status_code, refused.json()["type"]) == (422, "/problems/unusable-request")


async def test_what_somebody_else_has_written_since_is_put_back_only_by_its_name(client: httpx.AsyncClient) -> None:
    was = await value(client, "v_max"), await value(client, "a_max")
    await write(client, "v_max", 700)
    mine = (await changes(client))[0]["last"]
    await write(client, "a_max", 99)
    await write(client, "v_max", 800, BOB)
    preview = await undo(client, {"before": mine}, dry=True)
    assert states(preview) == {"v_max": "ask", "a_max": "ready"}
    (asked,) = [each for each in preview["registers"] if each["name"] == "v_max"]
    assert "Bob" in asked["why"]
    assert [(entry["who"], entry["new"]) for entry in asked["since"]] == [("Bob", 800)]
    await undo(client, {"before": mine})
    assert (await value(client, "v_max"), await value(client, "a_max")) == (800, was[1])
    place = {"name": "v_max", "axis": 1}
    await undo(client, {"before": mine, "registers": [place]})
    assert await value(client, "v_max") == was[0]


async def test_a_later_write_of_the_same_register_is_asked_about(client: httpx.AsyncClient) -> None:
    await write(client, "v_max", 700)
    first = (await changes(client))[0]["last"]
    await write(client, "v_max", 800)
    assert states(await undo(client, {"without": first}, dry=True)) == {"v_max": "ask"}


async def test_a_write_behind_the_preview_ends_it(client: httpx.AsyncClient) -> None:
    await write(client, "v_max", 700)
    mine = (await changes(client))[0]["last"]
    preview = await undo(client, {"before": mine}, dry=True)
    await write(client, "v_max", 800, BOB)
    place = {"name": "v_max", "axis": 1}
    order = {"before": mine, "registers": [place], "seen": preview["seen"]}
    refused = await client.post("devices/bench/undo", json=order, headers=ANN)
    assert (refused.status_code, refused.json()["type"]) == (409, "/problems/wrong-state")
    assert "Bob" in refused.json()["detail"]
    assert await value(client, "v_max") == 800


async def test_what_was_changed_past_the_log_is_asked_about(client: httpx.AsyncClient, app: FastAPI) -> None:
    await write(client, "v_max", 700)
    mine = (await changes(client))[0]["last"]
    device = bench_of(app).manager.get("bench")
    port = cast("EmulatorPort", device.session.port)
    port.wire.exchange(datagram32.write(device.family.table.get("v_max", 1).address, 900), port.take_turn())
    preview = await undo(client, {"before": mine + 1}, dry=True)
    assert {"v_max": "ask"}.items() <= states(preview).items()
    assert "past the log" in next(each["why"] for each in preview["registers"] if each["name"] == "v_max")


async def test_motion_and_state_are_told_and_never_claimed(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await write(client, "v_max", 700)
    mine = (await changes(client))[0]["last"]
    await client.post("devices/bench/axes/1/move", json={"target": 100}, headers=ANN)
    await clock.advance(5.0)
    await write(client, "x_actual", 5)
    await client.post("devices/bench/axes/1/stop", headers=ANN)
    await clock.advance(5.0)
    told = await undo(client, {"before": mine})
    assert {"v_max": "ready", "x_actual": "cannot"}.items() <= states(told).items()
    (moved,) = [each for each in told["rest"] if each["action"] == "move"]
    assert "motion" in moved["why"]
    refused = await client.post(
        "devices/bench/undo", json={"before": mine, "registers": [{"name": "x_actual", "axis": 1}]}, headers=ANN
    )
    assert (refused.status_code, "state" in refused.json()["detail"]) == (422, True)


async def test_what_the_log_has_never_seen_is_told_as_unseen(client: httpx.AsyncClient) -> None:
    await write(client, "v_max", 700)
    mine = (await changes(client))[0]["last"]
    unseen = {(each["name"], each["axis"]) for each in (await undo(client, {"before": mine}, dry=True))["unseen"]}
    assert ("v_max", 1) not in unseen
    assert ("v_max", 2) in unseen


async def test_an_order_says_one_thing_and_an_entry_of_this_device(client: httpx.AsyncClient) -> None:
    assert (await client.post("devices/bench/undo", json={})).status_code == 422
    assert (await client.post("devices/bench/undo", json={"before": 1, "without": 1})).status_code == 422
    missing = await client.post("devices/bench/undo", params=DRY, json={"without": 999_999})
    assert (missing.status_code, missing.json()["type"]) == (404, "/problems/unknown-thing")


async def test_the_history_begins_where_the_device_was_added(client: httpx.AsyncClient) -> None:
    for value_ in (300, 400):
        added = await client.post("devices", json={"name": "Again", "model": "tmc428", "link": {"kind": "emulator"}})
        assert added.status_code == 201, added.text
        await client.put("devices/again/registers/v_max", params={"axis": 0}, json={"value": value_}, headers=ANN)
        told = (await client.get("devices/again/history")).json()
        assert [each["entry"]["action"] for each in told["changes"]] == ["write", "add device"]
        assert (told["changes"][0]["entry"]["new"], told["more"]) == (value_, False)
        before = told["changes"][-1]["first"]
        refused = await client.post("devices/again/undo", params=DRY, json={"before": before})
        assert (refused.status_code, "is there since" in refused.json()["detail"]) == (422, True)
        await client.delete("devices/again")
