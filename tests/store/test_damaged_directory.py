"""Whatever is wrong with a file of the data directory, the server starts, tells what it set aside, and keeps the rest.

Each file is cut off at many places, overwritten, given a byte-order mark, and filled with JSON of the wrong types; or a
folder stands in its place. Nothing that was kept is overwritten: its bytes are still in the directory afterwards.
"""

from __future__ import annotations

import asyncio
import json
import logging
import random
import shutil
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.api.health.details import health_of
from app.api.server_state import ServerState
from app.clock import VirtualClock
from app.main import bench_of, create_app
from app.settings import Settings
from app.store.tokens import TokenStore

CASES, PARTS = 200, 4
"""A start each."""
BOM = b"\xef\xbb\xbf"
HOSTILE = ("null", "5", "[]", '"text"', "{}", "1e999", "[" * 5000, '{"format": 5}', '{"format": null, "version": []}')
DATABASE = "stepscope.sqlite3"


@dataclass(frozen=True)
class Damage:
    """`content` instead of the file; None: a folder in its place."""

    file: str
    what: str
    content: bytes | None


@asynccontextmanager
async def server(data_dir: Path) -> AsyncIterator[FastAPI]:
    """The whole program on that directory, in this process."""
    app = create_app(Settings(data_dir=data_dir, web_dir=data_dir / "no-web", demo=False), VirtualClock(1000.0))
    async with app.router.lifespan_context(app):
        yield app


async def state(bench: ServerState) -> dict[str, object]:
    """What a user finds again, by the file that keeps it. Not by requests: each application builds its routes anew."""
    devices = bench.manager.devices
    return {
        "connections.json": [device.name for device in devices],
        DATABASE: [profile.name for profile in await bench.profile_store.all()],
        "recordings": [entry.id for entry in bench.recordings.library.page().entries],
        "positions.json": [(await bench.positions.state(device, 0)).watching for device in devices],
    }


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data directory with something of every kind in it, left by a server that ended."""
    data_dir = tmp_path_factory.mktemp("kept") / "data"

    async def fill() -> None:
        transport = httpx.ASGITransport
        async with (
            server(data_dir) as app,
            httpx.AsyncClient(transport=transport(app), base_url="http://127.0.0.1:8000/api/v1/") as api,
        ):
            for name, model in (("Stage", "tmc428"), ("Motor", "pd42-1241")):
                wanted = {"name": name, "model": model, "link": {"kind": "emulator"}}
                (await api.post("devices", json=wanted)).raise_for_status()

            profile = (await api.get("devices/stage/profile")).raise_for_status().json()
            (await api.post("profiles", json={"name": "kept", "document": profile})).raise_for_status()
            wanted = {"device": "stage", "channels": ["position.0"]}
            recording = (await api.post("recordings", json=wanted)).raise_for_status().json()["id"]
            (await api.post(f"recordings/{recording}/marks", json={"text": "here"})).raise_for_status()
            (await api.post(f"recordings/{recording}/stop")).raise_for_status()
            watch = {"watch": True}
            (await api.put("devices/stage/axes/0/extended-position", json=watch)).raise_for_status()

    asyncio.run(fill())
    TokenStore(data_dir).add("Ada", "drive")
    return data_dir


def damages(kept: Path) -> Iterator[Damage]:
    """`CASES` of them, spread over all files."""
    chance = random.Random(13)
    files = sorted(
        path.relative_to(kept).as_posix() for path in kept.rglob("*") if path.is_file() and path.suffix != ".lock"
    )
    assert {Path(name).suffix for name in files} >= {".json", ".sqlite3", ".arrows", ".marks"}
    number = 0
    while number < CASES:
        for file in files:
            whole = (kept / file).read_bytes()
            at = chance.randrange(len(whole)) if whole else 0
            noise = chance.randbytes(chance.choice([1, 40, 5000]))
            choices = [
                Damage(file, f"cut off at {at}", whole[:at]),
                Damage(file, "empty", b""),
                Damage(file, "noise", noise),
                Damage(file, f"noise at {at}", whole[:at] + noise + whole[at + len(noise) :]),
                Damage(file, "a mark before it", BOM + whole),
                Damage(file, "a folder", None),
                Damage(file, "zeros", bytes(len(whole))),
                *(Damage(file, text[:30], text.encode()) for text in HOSTILE),
            ]
            yield chance.choice(choices)
            number += 1


def apply(damage: Damage, data_dir: Path) -> None:
    path = data_dir / damage.file
    path.unlink()
    if damage.content is None:
        path.mkdir()
    else:
        path.write_bytes(damage.content)


@pytest.mark.parametrize("part", range(PARTS))
async def test_a_damaged_file_costs_nothing_but_itself(
    kept: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture, part: int
) -> None:
    async with server(kept) as app:
        whole = await state(bench_of(app))
    assert all(whole.values()), whole
    wrong: list[str] = []
    for number, damage in enumerate(islice(damages(kept), part, CASES, PARTS)):
        data_dir = tmp_path / f"{number}"
        shutil.copytree(kept, data_dir)
        apply(damage, data_dir)
        caplog.clear()
        try:
            with caplog.at_level(logging.WARNING):
                async with server(data_dir) as app:
                    found = await state(bench_of(app))
                    notes = (await health_of(bench_of(app))).storage.notes
            wrong += [f"{damage.file}, {damage.what}: {each}" for each in _wrong(damage, data_dir, whole, found)]
            lost = {name for name in whole if found[name] != whole[name]}
            told = " ".join([*notes, caplog.text])
            if lost and Path(damage.file).name not in told and not damage.file.startswith("recordings"):
                wrong.append(f"{damage.file}, {damage.what}: {lost} lost and not told")
        except Exception as error:
            wrong.append(f"{damage.file}, {damage.what}: {error!r}"[:300])
        shutil.rmtree(data_dir)
    assert not wrong, "\n".join([f"{len(wrong)} of {CASES // PARTS}", *wrong[:40]])


def _wrong(damage: Damage, data_dir: Path, whole: dict[str, Any], found: dict[str, Any]) -> Iterator[str]:
    """What should not have happened."""
    for name in whole:
        of_it = damage.file.startswith((name, "recordings" if name == "recordings" else name))
        depends = name == "positions.json" and damage.file == "connections.json"
        if not of_it and not depends and found[name] != whole[name]:
            yield f"{name} is another one: {found[name]}"
    if damage.content and not damage.file.endswith(("-wal", "-shm")):
        contents = [path.read_bytes() for path in data_dir.rglob("*") if path.is_file()]
        if damage.content not in contents and found != whole:
            yield "its bytes are nowhere any more"


def test_the_document_of_json_is_what_the_damages_are_of(kept: Path) -> None:
    assert json.loads((kept / "connections.json").read_text())["connections"]
