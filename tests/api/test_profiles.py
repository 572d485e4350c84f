"""Profiles over REST: out of a device, into it, compared and kept."""

from __future__ import annotations

import json
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from app.links.emulator import EmulatorPort
from app.main import bench_of


async def profile_of(client: httpx.AsyncClient, device: str = "bench") -> dict[str, Any]:
    answer = await client.get(f"devices/{device}/profile")
    assert answer.status_code == 200, answer.text
    document: dict[str, Any] = answer.json()
    return document


async def value(client: httpx.AsyncClient, name: str, axis: int = 0, device: str = "bench") -> int:
    reading = (await client.get(f"devices/{device}/registers/{name}", params={"axis": axis})).json()
    return int(reading["value"])


@pytest.mark.parametrize("device", ["bench", "slider"])
async def test_a_profile_is_the_whole_configuration(client: httpx.AsyncClient, device: str) -> None:
    document = await profile_of(client, device)
    assert (document["format"], document["version"]) == ("stepscope-profile", 1)
    held = {(entry["name"].casefold(), entry["axis"]): entry["value"] for entry in document["registers"]}
    assert held["v_max", 0] == await value(client, "v_max", device=device)
    assert (document["tables"]["microstep"] is None) == (device == "slider")


async def test_a_dry_run_tells_what_would_change_and_changes_nothing(client: httpx.AsyncClient) -> None:
    document = await profile_of(client)
    await client.put("devices/bench/registers/v_max", params={"axis": 1}, json={"value": 777})
    answer = (await client.put("devices/bench/profile", params={"dry_run": True}, json=document)).json()
    assert answer["state"] == "dry run"
    (difference,) = answer["differences"]
    assert (difference["name"], difference["axis"], difference["left"]) == ("v_max", 1, 777)
    assert difference["right_physical"].endswith("pps")
    assert await value(client, "v_max", 1) == 777


async def test_applying_brings_it_back_and_says_what_it_wrote(client: httpx.AsyncClient) -> None:
    document = await profile_of(client)
    before = await value(client, "v_max", 1)
    await client.put("devices/bench/registers/v_max", params={"axis": 1}, json={"value": 777})
    answer = (await client.put("devices/bench/profile", json=document)).json()
    assert (answer["state"], [change["name"] for change in answer["written"]]) == ("applied", ["v_max"])
    assert (answer["written"][0]["was"], answer["written"][0]["now"]) == (777, before)
    assert await profile_of(client) == {
        **document,
        "captured_unix_s": pytest.approx(document["captured_unix_s"], abs=60),
    }
    again = (await client.put("devices/bench/profile", json=document)).json()
    assert (again["state"], again["written"]) == ("unchanged", [])
    assert (await client.get("devices/bench/profile/apply")).json()["state"] == "idle"


async def test_the_thresholds_of_an_axis_stay_when_a_profile_is_applied(client: httpx.AsyncClient) -> None:
    axes: list[dict[str, Any]] = [{"name": axis["name"]} for axis in (await client.get("devices/bench")).json()["axes"]]
    axes[0] |= {"lost_steps_microsteps": 77, "following_error_microsteps": 88}
    assert (await client.patch("devices/bench", json={"axes": axes})).status_code == 200
    document = await profile_of(client)
    document["axes"][0] |= {"gear_ratio": 2.5}
    assert (await client.put("devices/bench/profile", json=document)).json()["state"] == "applied"
    axis = (await client.get("devices/bench")).json()["axes"][0]
    assert (axis["gear_ratio"], axis["lost_steps_microsteps"], axis["following_error_microsteps"]) == (2.5, 77, 88)


async def test_mechanics_come_with_it_and_limits_only_on_request(client: httpx.AsyncClient) -> None:
    document = await profile_of(client)
    document["axes"][0] |= {"gear_ratio": 2.5, "limits": {"velocity_max_pps": 30_000.0}}
    answer = (await client.put("devices/bench/profile", json=document)).json()
    assert (answer["state"], [entry["name"] for entry in answer["settings"]]) == ("applied", ["gear_ratio"])
    axis = (await client.get("devices/bench")).json()["axes"][0]
    assert (axis["gear_ratio"], axis["limits"]["velocity_max_pps"]) == (2.5, None)
    await client.put("devices/bench/profile", params={"limits": True}, json=document)
    assert (await client.get("devices/bench")).json()["axes"][0]["limits"]["velocity_max_pps"] == 30_000.0


async def test_a_write_beyond_a_soft_limit_is_refused_before_the_first(client: httpx.AsyncClient) -> None:
    document = await profile_of(client)
    await client.put("devices/bench/registers/v_max", params={"axis": 0}, json={"value": 100})
    await client.put("devices/bench/registers/v_min", params={"axis": 0}, json={"value": 2})
    axes = (await client.get("devices/bench")).json()["axes"]
    limited = [{"name": axis["name"], "limits": {"velocity_max_pps": 5000.0}} for axis in axes[:1]]
    assert (await client.patch("devices/bench", json={"axes": [*limited, {}, {}]})).status_code == 200
    refused = await client.put("devices/bench/profile", json=document)
    assert (refused.status_code, refused.json()["type"]) == (422, "/problems/soft-limit")
    assert await value(client, "v_min") == 2


async def test_a_motor_that_moves_is_left_alone(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    document = await profile_of(client)
    await client.put("devices/bench/registers/v_max", params={"axis": 0}, json={"value": 700})
    await client.post("devices/bench/axes/0/move", json={"target": 100_000})
    await clock.advance(0.1)
    refused = await client.put("devices/bench/profile", json=document)
    assert (refused.status_code, refused.json()["type"]) == (409, "/problems/wrong-state")
    assert "stop" in refused.json()["way_out"]


async def test_another_model_or_clock_is_refused_with_the_reason(client: httpx.AsyncClient) -> None:
    document = await profile_of(client)
    refused = await client.put("devices/slider/profile", json=document)
    assert (refused.status_code, refused.json()["type"]) == (409, "/problems/profile-misfit")
    assert "TMC428" in refused.json()["detail"]
    refused = await client.put("devices/bench/profile", json=document | {"clock_hz": 8e6})
    assert "8 MHz" in refused.json()["detail"]


async def test_what_is_wrong_with_a_document_is_told_with_its_place(client: httpx.AsyncClient) -> None:
    """Every kind of mistake is in tests/profiles; here, how one arrives."""
    document = await profile_of(client)
    before = await value(client, "v_max")
    for change, words in (
        ({"version": 2}, "newer"),
        ({"color": 1}, "color"),
        ({"registers": [{"name": "v_max", "axis": 0, "value": "12"}]}, "registers.0.value"),
        ({"registers": [{"name": "v_macs", "axis": 0, "value": 12}]}, "registers[0].name"),
        ({"registers": [{"name": "pmul_pdiv", "axis": 0, "value": 4, "fields": {"pdiv": 5}}]}, "pdiv 4 or 5"),
    ):
        refused = await client.put("devices/bench/profile", json=document | change)
        assert refused.status_code == 422, refused.text
        assert words in refused.json()["detail"]
    del document["version"]
    assert "version is missing" in (await client.put("devices/bench/profile", json=document)).json()["detail"]
    assert await value(client, "v_max") == before


async def test_what_is_left_is_in_the_problem_and_can_be_brought_back(
    client: httpx.AsyncClient, app: FastAPI, clock: VirtualClock
) -> None:
    document = await profile_of(client)
    for axis in range(3):
        await client.put("devices/bench/registers/v_max", params={"axis": axis}, json={"value": 700})
    port = bench_of(app).manager.get("bench").session.port
    assert isinstance(port, EmulatorPort)
    emulator = port.wire

    class Unplugging:
        """Gone before the third write."""

        model, clock = emulator.model, emulator.clock
        writes = 0

        def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
            self.writes += frame[0] & 1 == 0
            if self.writes >= 3:
                raise ConnectionError("unplugged")
            return emulator.exchange(frame, at_s)

    port.wire = Unplugging()
    answer = await client.put("devices/bench/profile", json=document)
    assert (answer.status_code, answer.json()["type"]) == (502, "/problems/profile-left")
    facts = answer.json()["facts"]
    assert (facts["failed"]["name"], facts["failed"]["axis"]) == ("v_max", 2)
    assert [(each["axis"], each["was"]) for each in facts["left"]] == [(2, 700), (1, 700), (0, 700)]
    assert facts["left"][0]["now"] is None, "written or not, nobody knows"
    assert (await client.get("devices/bench/profile/apply")).json()["unfinished"]["crashed"] is False
    audited = (await client.get("audit", params={"action": "apply profile"})).json()["entries"]
    assert ["refused" in entry["outcome"] or "not proven" in entry["outcome"] for entry in audited] == [True]

    port.wire = emulator
    await clock.advance(5.0)
    back = await client.post("devices/bench/profile/apply/way-back")
    assert back.status_code == 200, back.text
    assert [await value(client, "v_max", axis) for axis in range(3)] == [700] * 3
    assert (await client.get("devices/bench/profile/apply")).json()["state"] == "idle"


async def test_profiles_are_kept_found_renamed_and_deleted(client: httpx.AsyncClient) -> None:
    saved = (await client.post("profiles", json={"device": "bench", "name": "before", "note": "as delivered"})).json()
    assert (saved["name"], saved["model"], saved["device"]) == ("before", "tmc428", "bench")
    document = await profile_of(client)
    document["registers"] = [{"name": "v_max", "axis": 0, "value": 99}]
    other = (await client.post("profiles", json={"document": document, "name": "slow"})).json()
    listed = (await client.get("profiles")).json()["profiles"]
    assert [each["id"] for each in listed] == [other["id"], saved["id"]]
    assert [
        each["name"] for each in (await client.get("profiles", params={"search": "DELIVERED bench"})).json()["profiles"]
    ] == ["before"]
    assert (await client.get("profiles", params={"model": "tmc4210"})).json()["profiles"] == []
    renamed = (await client.patch(f"profiles/{saved['id']}", json={"name": "factory"})).json()
    assert (renamed["name"], renamed["note"]) == ("factory", "as delivered")
    kept = (await client.get(f"profiles/{saved['id']}")).json()
    assert kept["document"]["name"] == "factory"
    compared = (await client.post("profiles/compare", json={"left": saved["id"], "right": other["id"]})).json()
    assert any(each["name"] == "v_max" and each["right"] == 99 for each in compared["differences"])
    assert (await client.delete(f"profiles/{saved['id']}")).status_code == 204
    assert (await client.get(f"profiles/{saved['id']}")).status_code == 404
    assert (await client.delete(f"profiles/{saved['id']}")).status_code == 404


async def test_an_exported_file_comes_back_as_it_was(client: httpx.AsyncClient) -> None:
    saved = (await client.post("profiles", json={"device": "bench", "name": "round"})).json()
    file = await client.get(f"profiles/{saved['id']}/file")
    assert "attachment" in file.headers["content-disposition"]
    lines = file.text.splitlines()
    assert sum('"name": "v_max"' in line for line in lines) == 3, "one register a line"
    again = (await client.post("profiles", json={"document": json.loads(file.text)})).json()
    kept = [(await client.get(f"profiles/{each['id']}")).json()["document"] for each in (saved, again)]
    assert kept[0] == kept[1]


async def test_no_profile_is_kept_that_no_device_could_take(client: httpx.AsyncClient) -> None:
    document = await profile_of(client)
    document["registers"][0]["name"] = "nothing"
    assert (await client.post("profiles", json={"document": document})).status_code == 422
    assert (await client.post("profiles", json={})).status_code == 422
    assert (await client.post("profiles", json={"device": "nobody"})).status_code == 404
    assert (await client.get("profiles")).json()["profiles"] == []


async def test_a_profile_carries_a_program_from_one_module_to_another(client: httpx.AsyncClient) -> None:
    """Downloaded, captured with all else, exported, compared, and applied where there was another."""
    for name in ("one", "two"):
        answer = await client.post("devices", json={"name": name, "model": "pd42-1241", "link": {"kind": "emulator"}})
        assert answer.status_code == 201, answer.text
    source = "Loop: MVP ABS, 0, 5000\nWAIT POS, 0, 0\nJA Loop\n"
    assert (await client.put("devices/one/program", json={"text": source})).status_code == 200
    document = await profile_of(client, "one")
    assert document["program"]["source"][0] == "L0:"
    silent = (await client.get("devices/one/profile", params={"program": False})).json()
    assert silent["program"] is None

    saved = (await client.post("profiles", json={"device": "one", "name": "there and back"})).json()
    file = json.loads((await client.get(f"profiles/{saved['id']}/file")).text)
    assert file["program"]["source"] == document["program"]["source"]
    assert "files" not in file["program"]
    mine = file | {"program": {"name": "mine.tmc", "source": ["#include speeds", "SAP 4, 0, FAST", "STOP"]}}
    mine["program"]["files"] = {"speeds": "FAST = 20000"}
    attached = (await client.post("profiles", json={"document": mine, "name": "mine"})).json()
    wrong = await client.post("profiles", json={"document": mine | {"program": {"source": ["ROX 1"]}}})
    assert (wrong.status_code, "no command is called ROX" in wrong.json()["detail"]) == (422, True)
    compared = (await client.post("profiles/compare", json={"left": saved["id"], "right": attached["id"]})).json()
    assert compared["program"]["commands"][0] == {
        "address": 0,
        "left": "MVP ABS, 0, 5000",
        "right": "SAP 4, 0, 20000",
    }

    told = (await client.put("devices/two/profile", params={"dry_run": True}, json=file)).json()
    assert (told["state"], told["program"]["left_commands"], told["program"]["right_commands"]) == ("dry run", 0, 3)
    assert "MVP" not in (await client.get("devices/two/program", params={"count": 1})).json()["text"]
    done = await client.put("devices/two/profile", json=file)
    assert (done.status_code, done.json()["state"], done.json()["stored_commands"]) == (200, "applied", 3), done.text
    assert "MVP ABS, 0, 5000" in (await client.get("devices/two/program", params={"count": 1})).json()["text"]
    again = (await client.put("devices/two/profile", json=file)).json()
    assert (again["state"], again["program"], again["stored_commands"]) == ("unchanged", None, None)
