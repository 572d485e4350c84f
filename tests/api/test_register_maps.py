"""Register maps by REST: kept, looked at, fetched, deleted, dropped into the folder, and refused with the line."""

from __future__ import annotations

import os
from pathlib import Path

import httpx
import pytest

from app.registers.catalog import MODELS
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
    assert (kept.json()["title"], kept.json()["registers"], kept.json()["axes"]) == ("Ramp core 2", 4, 1)
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
    assert len(told) == 3
    assert {lines[each["line"] - 1].strip() for each in told} == {"axis = 0", "width = 33"}
    assert not (folder / "ramp-core.toml").exists()


async def test_a_dry_run_keeps_nothing(client: httpx.AsyncClient) -> None:
    tried = await client.put("register-maps/ramp-core?dry_run=true", json={"text": TEXT})
    assert (tried.status_code, tried.json()["registers"]) == (200, 4)
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
    assert len(maps.look({})) == KEPT_MAX
    assert maps.passed_over == [f"m{KEPT_MAX}.toml: there are {KEPT_MAX} maps already"]


def test_a_map_stays_as_it_is_while_a_connected_device_uses_it(tmp_path: Path) -> None:
    maps = RegisterMaps(tmp_path, lambda _: False)
    maps.put("chip", SMALL, {})
    path, titled = maps.folder / "chip.toml", SMALL.replace(b'"x"', b'"another"')

    def told(*, connected: bool) -> tuple[str, bool]:
        (kept,) = maps.look({"chip": {"bench": connected}})
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
    assert maps.look({}) == []
