"""Kept profiles: found by any word, renamed with their document, and gone when they are deleted."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from app.errors import StoreUnavailable, UnknownThing
from app.store.database import Database
from app.store.profiles import ProfileStore


def document(**more: Any) -> dict[str, Any]:
    return {
        "format": "stepscope-profile",
        "version": 1,
        "model": "tmc5160",
        "device": "Mill X",
        "registers": [],
        **more,
    }


async def test_what_is_kept_outlives_the_server_and_is_found_by_its_words(tmp_path: Path) -> None:
    database = Database(tmp_path)
    store = ProfileStore(database, lambda: 5.0)
    first = await store.add("quiet", "for the NIGHT shift", document())
    second = await store.add("fast", "", document(model="tmc428"))
    assert (first.created_unix_s, first.version, first.document["name"]) == (5.0, 1, "quiet")
    database.close()

    store = ProfileStore(Database(tmp_path))
    assert [saved.id for saved in await store.all()] == [second.id, first.id]
    assert [saved.name for saved in await store.all("night mill")] == ["quiet"]
    assert [saved.name for saved in await store.all(model="tmc428")] == ["fast"]
    assert await store.all("night fast") == []
    changed = await store.edit(first.id, note="for nobody")
    assert (changed.name, changed.note, changed.document["note"]) == ("quiet", "for nobody", "for nobody")
    await store.delete(second.id)
    for call in (store.get(second.id), store.edit(second.id, "x"), store.delete(second.id), store.get(2**63)):
        with pytest.raises(UnknownThing):
            await call
    assert [saved.id for saved in await store.all()] == [first.id]


async def test_without_a_database_it_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    store = ProfileStore(Database(tmp_path / "file"))
    with pytest.raises(StoreUnavailable):
        await store.all()
