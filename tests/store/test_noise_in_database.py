"""Noise anywhere in the database: set aside where SQLite finds it, else only the row that it fell into is lost."""

from __future__ import annotations

import asyncio
import random
from pathlib import Path

import pytest

from app.clock import VirtualClock
from app.store.audit import AuditLog
from app.store.audit_entries import EntryFilter
from app.store.database import FILE_NAME, Database
from app.store.profiles import ProfileStore

CASES, PROFILES, ENTRIES = 120, 20, 200
DOCUMENT = {"model": "tmc428", "version": 1, "device": "bench", "registers": list(range(200))}


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A database with profiles and entries, closed."""
    data_dir = tmp_path_factory.mktemp("kept")

    async def fill() -> None:
        database = Database(data_dir)
        database.open()
        profiles, audit = ProfileStore(database), AuditLog(database, VirtualClock())
        for number in range(PROFILES):
            await profiles.add(f"profile {number}", "a note", dict(DOCUMENT))
        for number in range(ENTRIES):
            audit.note("write", f"V_MAX {number}", device="bench", axis=0, old=number, new=number + 1)
        await audit.close()
        database.close()

    asyncio.run(fill())
    return (data_dir / FILE_NAME).read_bytes()


async def look(data_dir: Path) -> tuple[int, int, list[str]]:
    """How many profiles and entries there are, and the notes; what is added is there, too."""
    database = Database(data_dir)
    database.open()
    profiles, audit = ProfileStore(database), AuditLog(database, VirtualClock())
    found = len(await profiles.all())
    entries = len(await audit.search(EntryFilter(), ENTRIES))
    await audit.known()
    added = await profiles.add("another", "", dict(DOCUMENT))
    assert added.id in [each.id for each in await profiles.all()]
    audit.note("end")
    assert (await audit.search(EntryFilter(), 1))[0].action == "end"
    await audit.close()
    database.close()
    return found, entries, database.notes


async def test_noise_costs_a_row_or_sets_the_file_aside(kept: bytes, tmp_path: Path) -> None:
    chance = random.Random(13)
    aside = rows_lost = 0
    for number in range(CASES):
        at, noise = chance.randrange(len(kept)), chance.randbytes(chance.choice([1, 4, 40, 5000]))
        spoilt = kept[:at] + noise + kept[at + len(noise) :]
        data_dir = tmp_path / f"{number}"
        data_dir.mkdir()
        (data_dir / FILE_NAME).write_bytes(spoilt)
        found, entries, notes = await look(data_dir)
        if any("kept as" in note for note in notes):
            assert (found, entries) == (0, 0)
            assert spoilt in [path.read_bytes() for path in data_dir.iterdir()]
            aside += 1
        else:
            # Each profile that is not there is told; entries of the log lose what fell out of them alone.
            assert (found + len(notes), entries) == (PROFILES, ENTRIES), f"{len(noise)} bytes at {at}"
            rows_lost += len(notes)
    assert aside > CASES / 10
    assert rows_lost


async def test_a_folder_in_its_place_is_set_aside(tmp_path: Path) -> None:
    (tmp_path / FILE_NAME).mkdir()
    (tmp_path / FILE_NAME / "what").write_text("somebody's")
    found, entries, notes = await look(tmp_path)
    assert (found, entries) == (0, 0)
    assert [path.read_text() for path in sorted(tmp_path.glob("stepscope.broken-*/what"))] == ["somebody's"]  # noqa: ASYNC240
    assert "folder" in notes[0]
