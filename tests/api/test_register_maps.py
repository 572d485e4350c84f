"""Register maps by REST: kept, looked at, fetched, deleted, dropped into the folder, and refused with the line."""

from __future__ import annotations

import os
from pathlib import Path

import httpx
import pytest

from app.clock import VirtualClock
from app.main import create_app
from app.registers.catalog import MODELS, is_model
from app.settings import Settings
from app.store.register_maps import KEPT_MAX, RegisterMaps
from tests.registers.maps.test_reader import EXAMPLE, SMALL, example

TEXT = EXAMPLE.decode()


@pytest.fixture
def folder(settings: Settings) -> Path:
    path = settings.data_dir / "register-maps"
    path.mkdir(parents=True)
    return path


def mode(path: Path) -> int:
    return path.stat().st_mode & 0o777


async def names(client: httpx.AsyncClient) -> list[str]:
    return [each["name"] for each in (await client.get("register-maps")).json()["maps"]]


async def test_a_map_is_kept_listed_fetched_and_deleted(client: httpx.AsyncClient, folder: Path) -> None:
    assert await names(client) == []
    kept = await client.put("register-maps/ramp-core", json={"text": TEXT})
    assert kept.status_code == 200, kept.text
    assert (kept.json()["title"], kept.json()["registers"], kept.json()["axes"]) == ("Ramp core 2", 7, 1)
    assert (folder / "ramp-core.toml").read_text() == TEXT
    assert mode(folder / "ramp-core.toml") == 0o600
    assert await names(client) == ["ramp-core"]
    assert (await client.get("register-maps/ramp-core")).json()["text"] == TEXT
    assert (await client.delete("register-maps/ramp-core")).status_code == 204
    assert await names(client) == []
    assert (await client.get("register-maps/ramp-core")).status_code == 404
    assert (await client.delete("register-maps/ramp-core")).status_code == 404
    told = (await client.get("audit")).json()["entries"]
    entries = [(entry["action"], entry["subject"]) for entry in told if entry["action"].endswith("register map")]
    assert entries[-2:] == [("delete register map", "ramp-core"), ("keep register map", "ramp-core")]


async def test_every_mistake_is_told_and_nothing_is_changed(client: httpx.AsyncClient, folder: Path) -> None:
    broken = TEXT.replace("width = 23", "width = 33").replace("axes = 1", "axes = 0")
    refused = await client.put("register-maps/ramp-core", json={"text": broken})
    assert (refused.status_code, refused.json()["type"]) == (422, "/problems/unreadable-map")
    lines = broken.split("\n")
    told = refused.json()["facts"]["findings"]
    assert len(told) == 6
    assert {lines[each["line"] - 1].strip() for each in told} == {"axis = 0", "width = 33"}
    assert not (folder / "ramp-core.toml").exists()


@pytest.fixture
async def core(client: httpx.AsyncClient) -> str:
    """An emulated device of the documented map: its address."""
    assert (await client.put("register-maps/ramp-core", json={"text": TEXT})).status_code == 200
    body = {"name": "Core", "model": "ramp-core", "link": {"kind": "emulator"}}
    made = await client.post("devices", json=body)
    assert (made.status_code, made.json()["state"]) == (201, "connected"), made.text
    return "devices/core"


async def test_a_map_is_a_model_with_registers_motion_and_channels(
    client: httpx.AsyncClient, core: str, clock: VirtualClock
) -> None:
    entry = next(each for each in (await client.get("catalog")).json() if each["name"] == "ramp-core")
    assert (entry["tier"], entry["kind"], entry["axes"], entry["registers"]) == ("map", "chip", 1, 7)
    assert [wire["kind"] for wire in entry["wires"]] == ["emulator", "tcp", "spidev"]
    rows = (await client.get("catalog/ramp-core")).json()["rows"]
    assert [row["name"] for row in rows][:2] == ["MODE", "XACTUAL"]
    written = (await client.put(f"{core}/registers/MODE?axis=0", json={"fields": {"shaft": 1}})).json()
    assert (written["value"], written["fields"]["shaft"]) == (0x80, 1)
    for name in ("VMAX", "AMAX"):
        assert (await client.put(f"{core}/registers/{name}?axis=0", json={"value": 1000})).status_code == 200
    assert (await client.post(f"{core}/axes/0/move", json={"target": 2000})).status_code == 200
    await clock.advance(10.0)
    assert (await client.get(f"{core}/axes/0")).json()["position"] == 2000
    channels = {channel["name"] for channel in (await client.get(core)).json()["channels"]}
    assert {"position.0", "velocity.0", "AMAX.0"} <= channels
    refused = await client.put(f"{core}/registers/VMAX?axis=0", json={"value": 8_388_097})
    assert refused.json()["type"] == "/problems/out-of-range"


async def test_a_map_of_a_device_changes_only_while_that_is_disconnected(client: httpx.AsyncClient, core: str) -> None:
    other = TEXT.replace('"GSTAT"', '"STATUS"')
    refused = await client.put("register-maps/ramp-core", json={"text": other})
    assert (refused.status_code, refused.json()["way_out"]) == (409, "disconnect first")
    assert (await client.delete("register-maps/ramp-core")).status_code == 409
    assert (await client.get(f"{core}/registers/GSTAT")).status_code == 200
    assert (await client.post(f"{core}/disconnect")).status_code == 200
    assert (await client.put("register-maps/ramp-core", json={"text": other})).status_code == 200
    assert (await client.post(f"{core}/connect")).json()["state"] == "connected"
    assert (await client.get(f"{core}/registers/STATUS")).status_code == 200
    assert (await client.get(f"{core}/registers/GSTAT")).status_code == 404
    assert (await client.delete(core)).status_code == 204
    assert (await client.delete("register-maps/ramp-core")).status_code == 204
    assert not is_model("ramp-core")


async def test_maps_and_their_devices_are_there_after_a_restart(settings: Settings, clock: VirtualClock) -> None:
    for restarted in (False, True):
        app = create_app(settings, clock, list)
        transport = httpx.ASGITransport(app)
        async with (
            app.router.lifespan_context(app),
            httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000/api/v1/") as client,
        ):
            if not restarted:
                await client.put("register-maps/ramp-core", json={"text": TEXT})
                body = {"name": "Core", "model": "ramp-core", "link": {"kind": "emulator"}}
                assert (await client.post("devices", json=body)).status_code == 201
            found = (await client.get("devices/core")).json()
            assert (found["model"], found["title"]) == ("ramp-core", "Ramp core 2")
        assert not is_model("ramp-core")


async def test_a_dry_run_keeps_nothing(client: httpx.AsyncClient) -> None:
    tried = await client.put("register-maps/ramp-core?dry_run=true", json={"text": TEXT})
    assert (tried.status_code, tried.json()["registers"]) == (200, 7)
    assert await names(client) == []


async def test_a_table_is_kept_as_a_map(client: httpx.AsyncClient) -> None:
    kept = await client.put("register-maps/table", json={"text": example("csv").decode(), "format": "csv"})
    assert (kept.status_code, kept.json()["registers"]) == (200, 2)
    assert "[[register]]" in (await client.get("register-maps/table")).json()["text"]


@pytest.mark.parametrize("name", ["A", "a_b", "-a", "a" * 41, "..", next(iter(MODELS))])
async def test_a_name_that_no_map_can_have_is_refused(client: httpx.AsyncClient, name: str) -> None:
    assert (await client.put(f"register-maps/{name}", json={"text": TEXT})).status_code in (404, 405, 422)
    assert await names(client) == []


async def test_files_are_found_changed_and_gone_as_the_folder_is(client: httpx.AsyncClient, folder: Path) -> None:
    (folder / "dropped.toml").write_bytes(SMALL)
    (folder / "broken.toml").write_text("format = 1\ntitle")
    (folder / "Not A Name.toml").write_bytes(SMALL)
    os.mkfifo(folder / "pipe.toml")
    (folder / "link.toml").symlink_to(folder)
    (folder / "notes.txt").write_text("nothing")
    told = (await client.get("register-maps")).json()
    assert [(each["name"], [finding["line"] for finding in each["findings"]]) for each in told["maps"]] == [
        ("broken", [2]),
        ("dropped", []),
    ]
    assert len(told["passed_over"]) == 3
    (folder / "broken.toml").write_bytes(SMALL.replace(b'"x"', b'"mended"'))
    (folder / "dropped.toml").unlink()
    told = (await client.get("register-maps")).json()
    assert [(each["name"], each["title"]) for each in told["maps"]] == [("broken", "mended")]


def test_there_are_no_more_than_so_many(tmp_path: Path) -> None:
    maps = RegisterMaps(tmp_path, lambda _: False)
    maps.folder.mkdir()
    for index in range(KEPT_MAX + 1):
        (maps.folder / f"m{index:03}.toml").write_bytes(SMALL)
    assert len(maps.scan({})) == KEPT_MAX
    assert maps.passed_over == [f"m{KEPT_MAX}.toml: there are {KEPT_MAX} maps already"]


def test_a_map_stays_as_it_is_while_a_connected_device_uses_it(tmp_path: Path) -> None:
    maps = RegisterMaps(tmp_path, lambda _: False)
    maps.put("chip", SMALL, {})
    path, titled = maps.folder / "chip.toml", SMALL.replace(b'"x"', b'"another"')

    def told(*, connected: bool) -> tuple[str, bool]:
        (kept,) = maps.scan({"chip": {"bench": connected}})
        assert not isinstance(kept.found, Exception)
        return kept.found.head.title, bool(kept.behind)

    path.write_bytes(titled)
    assert told(connected=True) == ("x", True)
    assert told(connected=False) == ("another", False)
    path.write_bytes(b"broken")
    assert told(connected=False) == ("another", True)
    path.unlink()
    assert told(connected=False) == ("another", True)
    path.write_bytes(SMALL)
    assert told(connected=False) == ("x", False)
    path.unlink()
    assert maps.scan({}) == []
