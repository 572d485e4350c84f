from __future__ import annotations

from typing import get_args

import httpx
import pytest

from app import __version__
from app.registers.catalog import MODELS
from app.registers.wires import Wire


async def test_health_tells_the_version(client: httpx.AsyncClient) -> None:
    assert (await client.get("health")).json() == {"status": "ok", "version": __version__}


async def test_ports_are_those_of_the_machine_and_the_emulators(client: httpx.AsyncClient) -> None:
    ports = (await client.get("ports")).json()
    assert ports[0]["name"] == "/dev/ttyUSB0"
    assert ports[0]["usb_vid"] == 0x0403
    assert [port["model"] for port in ports[1:]] == list(MODELS)


async def test_the_catalog_lists_every_model(client: httpx.AsyncClient) -> None:
    entries = (await client.get("catalog")).json()[: len(MODELS)]
    assert [entry["name"] for entry in entries] == list(MODELS)
    assert [entry["registers"] for entry in entries] == [len(model.table) for model in MODELS.values()]


async def test_the_catalog_says_what_each_model_is_and_can(client: httpx.AsyncClient) -> None:
    for entry in (await client.get("catalog")).json():  # the listed ones too
        if entry["unreadable"]:
            assert entry["tier"] == "names"
            continue
        model = MODELS[entry["name"]]
        assert set(entry["capabilities"]) == model.capabilities
        assert (entry["family"], entry["description"]) == (model.family, model.description)
        assert (entry["clock_hz_min"], entry["clock_hz_max"]) == (model.clock_hz_min, model.clock_hz_max)
        assert entry["current_scale"] == model.current_scale
        assert (entry["datagram_bits"], entry["uart"]) == (model.datagram_bits, model.uart)
        assert {wire["kind"] for wire in entry["wires"]} == model.wires
        assert all((wire["frames"] == "tmcl") == (model.kind == "module") for wire in entry["wires"])


@pytest.mark.parametrize("name", list(MODELS))
async def test_the_wires_of_a_model_are_those_that_a_connection_takes(client: httpx.AsyncClient, name: str) -> None:
    for kind in get_args(Wire):
        link = {"kind": kind, "host": "127.0.0.1", "port": 1 if kind == "tcp" else "/dev/nothing"}
        wanted = {"tcp": ("kind", "host", "port"), "emulator": ("kind",)}.get(kind, ("kind", "port"))
        link = {key: link[key] for key in wanted}
        if kind == "spidev":
            link = {"kind": kind, "bus": 0, "device": 0}
        if kind == "cover":
            link = {"kind": kind, "device": "nobody"}
        if kind == "can":
            link = {"kind": kind, "interface": "virtual", "channel": "vcan"}
        tried = await client.post("devices/test", json={"model": name, "link": link})
        refused = tried.status_code == 422 or (tried.status_code == 400 and "link" in tried.json()["detail"])
        assert refused == (kind not in MODELS[name].wires), (kind, tried.json())


async def test_every_capability_of_a_model_has_a_title(client: httpx.AsyncClient) -> None:
    titles = {row["name"]: row["title"] for row in (await client.get("catalog/capabilities")).json()}
    for entry in (await client.get("catalog")).json():
        assert all(titles[capability] for capability in entry["capabilities"])


@pytest.mark.parametrize("name", list(MODELS))
async def test_a_model_has_every_row_as_the_table_has_it(client: httpx.AsyncClient, name: str) -> None:
    table = MODELS[name].table
    rows = (await client.get(f"catalog/{name.upper()}")).json()["rows"]
    assert [(row["name"], row["address"], row["axis"]) for row in rows] == [
        (register.name, register.address, register.axis) for register in table
    ]
    for row, register in zip(rows, table, strict=True):
        assert (row["minimum"], row["maximum"], row["access"]) == (register.minimum, register.maximum, register.access)
        assert [field["name"] for field in row["fields"]] == [field.name for field in register.fields]
        assert [row["behaviour"], *(field["behaviour"] for field in row["fields"])] == [
            register.behaviour,
            *(field.behaviour for field in register.fields),
        ]
        assert row["help"]
        assert row["source"]
        for field in row["fields"]:
            assert all(field["minimum"] <= int(value) <= field["maximum"] for value in field["values"])


async def test_an_unknown_model_names_the_known_ones(client: httpx.AsyncClient) -> None:
    answer = await client.get("catalog/tmc9999")
    assert answer.status_code == 404
    assert answer.json()["facts"]["known"] == sorted(MODELS)
