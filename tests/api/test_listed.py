"""Listed modules by REST: the catalog has them, a connection to one works, and what is not known of them is said."""

from __future__ import annotations

import asyncio
import csv
import io

import httpx
import pytest

from app.clock import VirtualClock
from app.registers import catalog
from app.registers.listed import package
from app.registers.listed.modules import role_of
from app.registers.model import Access, Space
from app.registers.spi_format import SpiFormat, TaggedFormat

LISTED = catalog.listings()
MODEL = LISTED[0]
CHIPS = [
    catalog.find_model(name)
    for name in package.listings()
    if package.listings()[name].spi and name not in catalog.MODELS
]
TAGGED = next(model for model in CHIPS if isinstance(model.spi, TaggedFormat))
FORMED = [model for model in CHIPS if isinstance(model.spi, SpiFormat)]
SEVERAL = next(model for model in LISTED if model.kind == "module" and model.axes > 1)
MOST = max((model for model in LISTED if model.kind == "module"), key=lambda model: model.axes)
"""A module with the most axes, and with outputs."""


def named(role: str) -> str:
    return next(row.name for row in catalog.find_model(SEVERAL.name).table if role_of(row) == role)


@pytest.fixture
async def module(client: httpx.AsyncClient) -> str:
    """An emulated module of several axes: the address of its device."""
    body = {"name": "Module", "model": SEVERAL.name, "link": {"kind": "emulator"}, "start_up": True}
    answer = await client.post("devices", json=body)
    assert answer.status_code == 201, answer.text
    assert (answer.json()["state"], answer.json()["model"]) == ("connected", SEVERAL.name)
    assert len(answer.json()["axes"]) == SEVERAL.axes
    assert any("names are known" in note for note in answer.json()["notes"])
    return "devices/module"


async def test_the_catalog_lists_them_behind_those_that_are_known_well(client: httpx.AsyncClient) -> None:
    entries = (await client.get("catalog")).json()
    assert [entry["name"] for entry in entries] == [*catalog.MODELS, *(model.name for model in LISTED)]
    assert {entry["tier"] for entry in entries[len(catalog.MODELS) :]} == {"names"}
    assert {entry["tier"] for entry in entries[: len(catalog.MODELS)]} == {"full"}
    assert all(entry["title"] and entry["summary"] for entry in entries)


async def test_one_is_read_when_it_is_asked_for(client: httpx.AsyncClient) -> None:
    opened = (await client.get(f"catalog/{MODEL.name}")).json()
    assert opened["registers"] == len(opened["rows"]) == len(catalog.find_model(MODEL.name).table)
    assert {row["reset"] for row in opened["rows"]} == {None}
    assert opened["commands"]


async def test_parameters_motion_and_stop(client: httpx.AsyncClient, module: str, clock: VirtualClock) -> None:
    limit = named("max_speed")
    written = (await client.put(f"{module}/registers/{limit}?axis=1", json={"value": 1234})).json()
    assert (written["value"], written["verified"]) == (1234, True)
    assert (await client.get(f"{module}/registers/{limit}?axis=0")).json()["value"] != 1234
    assert (await client.post(f"{module}/axes/1/move", json={"target": 2000})).status_code == 200
    await clock.advance(10.0)
    state = (await client.get(f"{module}/axes/1")).json()
    assert (state["position"], state["position_reached"]) == (2000, True)
    assert (await client.post(f"{module}/axes/0/rotate", json={"velocity": 50})).status_code == 200
    stopped = await client.post(f"{module}/axes/0/stop")
    assert stopped.status_code == 200, stopped.text
    told = (await client.get(f"{module}/emulator")).json()
    assert told["depth"].startswith("plain")
    assert told["plain_axes"][1]["position"] == 2000


async def test_ports_and_global_parameters_are_recorded(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    body = {"name": "Module", "model": MOST.name, "link": {"kind": "emulator"}}
    assert (await client.post("devices", json=body)).status_code == 201
    module, table, last = "devices/module", catalog.find_model(MOST.name).table, MOST.axes - 1
    output = next(row.name for row in table if row.space is Space.OUTPUT)
    setting = next(row.name for row in table if row.space is Space.GLOBAL_0)
    current = next(row.name for row in table if row.axis == last and role_of(row) == "max_speed")
    written = {f"{output}.0": 1, f"{setting}.0": 4711, f"{current}.{last}": 77}
    assert {channel["name"] for channel in (await client.get(module)).json()["channels"]} >= set(written)
    started = await client.post("recordings", json={"device": "module", "channels": list(written), "rate_hz": 100})
    assert started.status_code == 201, started.text
    recording = started.json()["id"]
    for _ in range(10):
        await clock.advance(0.05)
    for channel, value in written.items():
        name, axis = channel.split(".")
        assert (await client.put(f"{module}/registers/{name}?axis={axis}", json={"value": value})).status_code == 200
    for _ in range(10):
        await clock.advance(0.05)
    assert (await client.post(f"recordings/{recording}/stop")).status_code == 200
    text = (await client.get(f"recordings/{recording}?format=csv")).text
    rows = [row for row in csv.reader(io.StringIO(text)) if row and not row[0].startswith("#")]
    for channel, value in written.items():
        column = [float(row[rows[0].index(channel)]) for row in rows[1:]]
        assert (column[0] != value, column[-1]) == (True, value), channel


async def test_the_emulator_can_be_disturbed(client: httpx.AsyncClient, module: str) -> None:
    assert (await client.patch(f"{module}/emulator", json={"faults": {"silence": True}})).status_code == 200
    assert (await client.get(f"{module}/registers/{named('max_speed')}?axis=0")).status_code >= 500
    assert (await client.patch(f"{module}/emulator", json={"faults": {"silence": False}})).status_code == 200
    assert (await client.patch(f"{module}/emulator", json={"supply_v": 12})).status_code in (400, 422)


async def test_a_link_is_tried_and_one_that_does_not_suit_is_refused(client: httpx.AsyncClient) -> None:
    tried = await client.post("devices/test", json={"model": MODEL.name, "link": {"kind": "emulator"}})
    assert tried.json()["ok"], tried.text
    for link in ({"kind": "spidev", "bus": 0, "device": 0}, {"kind": "emulator", "supply_v": 12}):
        refused = await client.post("devices", json={"name": "No", "model": MODEL.name, "link": link})
        assert refused.status_code == 422, refused.text


async def test_a_connection_is_changed_to_a_listed_model_and_back(client: httpx.AsyncClient) -> None:
    body = {"name": "Module", "model": "pd42-1241", "link": {"kind": "tcp", "host": "127.0.0.1", "port": 1}}
    assert (await client.post("devices", json=body)).status_code == 201
    for model in (MODEL.name, "pd42-1241"):
        changed = await client.patch("devices/module", json={"model": model})
        assert (changed.status_code, changed.json()["model"]) == (200, model)


async def test_what_is_not_known_is_said(client: httpx.AsyncClient, module: str) -> None:
    profile = await client.get(f"{module}/profile")
    assert (profile.status_code, profile.json()["type"].split("/")[-1]) == (409, "wrong-state"), profile.text
    assert "profile/try" in profile.json()["way_out"]
    started = await client.post(f"{module}/start-up", json={"dry_run": True})
    assert started.status_code == 422
    assert "parameters" in started.json()["detail"]


async def test_nothing_is_captured_while_it_is_tried_what_can_be_set(client: httpx.AsyncClient, module: str) -> None:
    tried, *answers = await asyncio.gather(
        client.post(f"{module}/profile/try"),
        client.get(f"{module}/profile"),
        client.post("profiles", json={"device": "module"}),
    )
    assert [answer.status_code for answer in answers] == [409, 409]
    assert [answer.json()["way_out"] for answer in answers] == ["wait until that is over"] * 2
    assert len((await client.get(f"{module}/profile")).json()["parameters"]) == tried.json()["settable"]


async def test_a_profile_is_captured_kept_compared_applied_and_exported(client: httpx.AsyncClient, module: str) -> None:
    tried = (await client.post(f"{module}/profile/try")).json()
    assert (tried["settable"] > 60, tried["refused"]) == (True, [])
    speed = named("max_speed")
    assert (await client.put(f"{module}/registers/{speed}?axis=1", json={"value": 1500})).status_code == 200
    kept = (await client.post("profiles", json={"device": "module", "name": "quiet"})).json()
    assert (kept["model"], kept["title"], kept["registers"]) == (SEVERAL.name, SEVERAL.title, tried["settable"])
    document = (await client.get(f"profiles/{kept['id']}")).json()["document"]
    assert (await client.put(f"{module}/registers/{speed}?axis=1", json={"value": 1600})).status_code == 200
    dry = (await client.put(f"{module}/profile?dry_run=true", json=document)).json()
    assert [(each["name"], each["axis"], each["left"], each["right"]) for each in dry["differences"]] == [
        (speed, 1, 1600, 1500)
    ]
    assert (await client.put(f"{module}/profile", json=document)).json()["state"] == "applied"
    assert (await client.get(f"{module}/registers/{speed}?axis=1")).json()["value"] == 1500
    small = {**document, "parameters": [each for each in document["parameters"] if each["name"] == speed]}
    for language in ("python", "curl", "tmcl"):
        script = await client.post("profiles/script", json={"document": small, "language": language})
        assert script.status_code == 200, script.text
        assert speed in script.json()["text"]
    assert script.json()["checked"]["how"] == "sent", "an emulated module of which only names are known stores none"


async def test_without_the_package_the_cure_is_told(client: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(package, "PACKAGE", "no_such_package_as_this")
    package.listings.cache_clear()
    package.version.cache_clear()
    try:
        body = {"name": "Module", "model": "tmcm-0000", "link": {"kind": "emulator"}}
        refused = await client.post("devices", json=body)
        assert refused.status_code == 422
        assert "pip install" in refused.text
        assert [entry["tier"] for entry in (await client.get("catalog")).json()] == ["full"] * len(catalog.MODELS)
    finally:
        monkeypatch.undo()
        package.listings.cache_clear()
        package.version.cache_clear()


async def test_a_chip_whose_readings_write_has_no_channels_and_leaves_those_of_others_alone(
    client: httpx.AsyncClient, module: str, clock: VirtualClock, caplog: pytest.LogCaptureFixture
) -> None:
    body = {"name": "Tagged", "model": TAGGED.name, "link": {"kind": "emulator"}}
    assert (await client.post("devices", json=body)).json()["state"] == "connected"
    await clock.advance(2.0)
    assert (await client.get("devices/tagged")).json()["channels"] == []
    assert (await client.get(module)).json()["channels"]
    assert not [record for record in caplog.records if record.levelname == "ERROR"], caplog.text
    written, status = (next(row for row in TAGGED.table if row.access is way) for way in (Access.W, Access.R))
    refused = await client.get(f"devices/tagged/registers/{status.name}")
    assert (refused.status_code, refused.json()["way_out"]) == (409, "write register 0xf once")
    selecting = TAGGED.table.at(0xF, write=True)
    assert selecting is not None
    done = (await client.put(f"devices/tagged/registers/{selecting.name}", json={"value": 0x40})).json()
    assert (done["verified"], done["value"]) == (None, 0x40)
    assert (await client.get(f"devices/tagged/registers/{status.name}")).status_code == 200
    assert (await client.get(f"devices/tagged/registers/{written.name}")).json()["type"] == "/problems/wrong-state"
    entry = (await client.get(f"catalog/{TAGGED.name}")).json()
    assert (entry["tagged"], entry["spi"], entry["datagram_bits"]) == ({"written": 8, "tag_lsb": 17}, None, 20)


async def test_the_frame_log_says_datagrams_of_a_told_format(client: httpx.AsyncClient) -> None:
    for model in FORMED:
        await client.post("devices", json={"name": model.name, "model": model.name, "link": {"kind": "emulator"}})
        row = next(row for row in model.table if row.access.writable and row.axis is None and not row.read_clears)
        await client.put(f"devices/{model.name}/registers/{row.name}", json={"value": 1})
        told = (await client.get(f"devices/{model.name}/frames")).json()
        texts = [frame["text"] for frame in told["frames"]]
        assert any(text.startswith(f"{row.name} := ") for text in texts), texts
        assert any(text.startswith(f"read {row.name}") for text in texts), texts
