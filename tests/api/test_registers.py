"""Registers and raw frames over REST."""

from __future__ import annotations

import asyncio

import httpx
import pytest

from app.registers.catalog import MODELS


async def test_a_write_answers_with_the_read_back(client: httpx.AsyncClient) -> None:
    url = "devices/bench/registers/V_MAX?axis=1"
    written = (await client.put(url, json={"value": 777})).json()
    assert (written["name"], written["axis"], written["value"], written["verified"]) == ("v_max", 1, 777, True)
    assert (await client.get(url)).json()["value"] == 777
    assert (await client.get("devices/bench/registers/v_max?axis=0")).json()["value"] != 777


async def test_a_packed_register_answers_to_its_fields_names(client: httpx.AsyncClient) -> None:
    written = await client.put("devices/bench/registers/pmul?axis=0", json={"value": 99})
    assert written.json()["fields"]["pmul"] == 99
    whole = (await client.get("devices/bench/registers/PMUL_PDIV?axis=0")).json()
    assert whole["fields"]["pmul"] == 99
    changed = await client.put("devices/bench/registers/pmul_pdiv?axis=0", json={"fields": {"pdiv": 7}})
    assert changed.json()["fields"].items() >= {"pmul": 99, "pdiv": 7}.items()


async def test_an_enumerated_value_goes_by_its_name(client: httpx.AsyncClient) -> None:
    body = {"fields": {"rm": "VELOCITY_MODE"}}
    assert (await client.put("devices/bench/registers/lp_ref_conf_rm?axis=2", json=body)).json()["fields"]["rm"] == 2


@pytest.mark.parametrize(("device", "model"), [("bench", "tmc428"), ("slider", "tmc4210")])
async def test_every_readable_register_is_listed(client: httpx.AsyncClient, device: str, model: str) -> None:
    table = MODELS[model].table
    readings = (await client.get(f"devices/{device}/registers")).json()
    assert [(r["name"], r["axis"]) for r in readings] == [(r.name, r.axis) for r in table if r.access.readable]
    of_axis = (await client.get(f"devices/{device}/registers", params={"axis": 0})).json()
    assert {reading["axis"] for reading in of_axis} == {0}
    some = (await client.get(f"devices/{device}/registers", params={"group": ["motion", "chip"]})).json()
    wanted = [r.name for r in table if r.access.readable and r.group in ("motion", "chip")]
    assert wanted
    assert [reading["name"] for reading in some] == wanted


async def test_a_batch_is_written_in_order_and_ends_where_it_fails(client: httpx.AsyncClient) -> None:
    writes = [
        {"name": "v_max", "axis": 0, "value": 1000},
        {"name": "a_max", "axis": 0, "value": 3000},
        {"name": "v_min", "axis": 0, "value": 5},
    ]
    result = (await client.post("devices/bench/registers", json={"writes": writes})).json()
    assert [done["value"] for done in result["done"]] == [1000]
    assert result["failed"]["status"] == 422
    assert result["not_tried"] == 1
    assert (await client.get("devices/bench/registers/v_min?axis=0")).json()["value"] == 1


@pytest.mark.parametrize(
    ("path", "body", "status"),
    [
        ("v_max?axis=0", {"value": 2048}, 422),
        ("v_max?axis=0", {"value": -1}, 422),
        ("v_max?axis=0", {"value": 10**40}, 422),
        ("v_max?axis=0", {"value": 1.5}, 422),
        ("v_max?axis=0", {"value": True}, 422),
        ("v_max?axis=0", {}, 422),
        ("v_max?axis=0", {"value": 1, "fields": {}}, 422),
        ("pmul_pdiv?axis=0", {"fields": {"nothing": 1}}, 404),
        ("pmul_pdiv?axis=0", {"fields": {"pmul": 128}}, 422),
        ("lp_ref_conf_rm?axis=0", {"fields": {"rm": "WARP"}}, 422),
        ("a_actual?axis=0", {"value": 1}, 409),
        ("nothing?axis=0", {"value": 1}, 404),
        ("v_max", {"value": 1}, 422),
        ("v_max?axis=3", {"value": 1}, 404),
        ("v_max?axis=x", {"value": 1}, 422),
    ],
)
async def test_what_cannot_be_written_is_told_and_not_done(
    client: httpx.AsyncClient, path: str, body: dict[str, object], status: int
) -> None:
    before = (await client.get("devices/bench/registers", params={"axis": 0})).json()
    answer = await client.put(f"devices/bench/registers/{path}", json=body)
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert (await client.get("devices/bench/registers", params={"axis": 0})).json() == before


async def test_a_range_is_named(client: httpx.AsyncClient) -> None:
    problem = (await client.put("devices/bench/registers/v_max?axis=0", json={"value": 5000})).json()
    assert problem["type"] == "/problems/out-of-range"
    assert (problem["facts"]["minimum"], problem["facts"]["maximum"]) == (0, 2047)


async def test_a_write_only_register_cannot_be_read(client: httpx.AsyncClient) -> None:
    assert (await client.get("devices/bench/registers/power_down")).status_code == 409


async def test_two_writers_at_once_lose_nothing(client: httpx.AsyncClient) -> None:
    """Two browsers change different fields of one register, again and again: read-modify-write stays whole."""

    async def write(field: str, values: range) -> None:
        url = f"devices/bench/registers/{field}?axis=0"
        for value in values:
            answer = await client.put(url, json={"value": value})
            assert answer.status_code == 200
            assert answer.json()["fields"][field] == value

    await asyncio.gather(write("is_v0", range(8)), write("is_aleat", range(8)), write("a_threshold", range(100, 140)))
    fields = (await client.get("devices/bench/registers/is_agtat_is_aleat_is_v0_a_threshold?axis=0")).json()["fields"]
    assert fields.items() >= {"is_v0": 7, "is_aleat": 7, "a_threshold": 139}.items()


async def test_a_raw_frame_goes_out_as_it_is(client: httpx.AsyncClient) -> None:
    answer = (await client.post("devices/slider/exchange", json={"frame": "73 00 00 00"})).json()
    assert answer["reply"].endswith("429101")
    assert answer["decoded"].items() >= {"address": 0x39, "rw": "read", "data": 0x429101}.items()


@pytest.mark.parametrize("frame", ["", "00", "0000000000", "zz000000", "0 1", "000000001", "\u0660\u0660000000"])
async def test_a_frame_of_another_length_or_no_hex_is_422(client: httpx.AsyncClient, frame: str) -> None:
    answer = await client.post("devices/bench/exchange", json={"frame": frame})
    assert answer.status_code == 422, answer.text
