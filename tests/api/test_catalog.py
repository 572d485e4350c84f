from __future__ import annotations

import httpx
import pytest

from app import __version__
from app.registers.catalog import MODELS


async def test_health_tells_the_version(client: httpx.AsyncClient) -> None:
    assert (await client.get("health")).json() == {"status": "ok", "version": __version__}


async def test_ports_are_those_of_the_machine_and_the_emulators(client: httpx.AsyncClient) -> None:
    ports = (await client.get("ports")).json()
    assert ports[0]["name"] == "/dev/ttyUSB0"
    assert ports[0]["usb_vid"] == 0x0403
    assert [port["model"] for port in ports[1:]] == list(MODELS)


async def test_the_catalog_lists_every_model(client: httpx.AsyncClient) -> None:
    entries = (await client.get("catalog")).json()
    assert [entry["name"] for entry in entries] == list(MODELS)
    assert [entry["registers"] for entry in entries] == [len(model.table) for model in MODELS.values()]


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
        assert row["help"]
        assert row["source"]
        for field in row["fields"]:
            assert all(field["minimum"] <= int(value) <= field["maximum"] for value in field["values"])


async def test_an_unknown_model_names_the_known_ones(client: httpx.AsyncClient) -> None:
    answer = await client.get("catalog/tmc9999")
    assert answer.status_code == 404
    assert answer.json()["facts"]["known"] == sorted(MODELS)
