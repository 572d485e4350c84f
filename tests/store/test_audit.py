"""The audit log: in order, bounded, searched, and never in the way."""

from __future__ import annotations

import asyncio
import gc
import logging
import sqlite3
import weakref
from collections.abc import AsyncIterator
from contextvars import ContextVar, copy_context
from pathlib import Path

import pytest
from sqlalchemy import Engine, event

from app.clock import VirtualClock
from app.devices.core.actor import Actor, actor
from app.store import audit as module
from app.store.audit import AuditLog, request_under_way
from app.store.audit_entries import Entry, EntryFilter
from app.store.database import FILE_NAME, Database

ANN = Actor("Ann", "browser", "a secret of the tab", "10.0.0.7")


@pytest.fixture
def clock() -> VirtualClock:
    return VirtualClock(1000.0)


@pytest.fixture
def database(tmp_path: Path) -> Database:
    database = Database(tmp_path)
    database.open()
    return database


@pytest.fixture
async def log(database: Database, clock: VirtualClock) -> AsyncIterator[AuditLog]:
    log = AuditLog(database, clock, lambda: 1e9 + clock.now())
    yield log
    await log.close()
    database.close()


def entry(number: int, **changes: object) -> Entry:
    given: dict[str, object] = {
        "at_unix_s": 1e9 + number,
        "who": "Ann",
        "kind": "browser",
        "address": "::1",
        "device": "bench",
        "axis": 0,
        "action": "write",
        "subject": "v_max",
        "old": number - 1,
        "new": number,
    }
    return Entry(**(given | changes))  # type: ignore[arg-type]


async def found(log: AuditLog, **wanted: object) -> list[object]:
    return [each.new for each in await log.search(EntryFilter(**wanted), 100)]  # type: ignore[arg-type]


def on_disk(path: Path) -> int:
    with sqlite3.connect(path) as file:
        count = file.execute("SELECT count(*) FROM audit").fetchone()[0]
    file.close()
    return int(count)


async def test_entries_reach_the_disk_together_a_moment_later(
    log: AuditLog, clock: VirtualClock, tmp_path: Path
) -> None:
    for number in range(5):
        log.add(entry(number))
    await clock.advance(module.FLUSH_S / 2)
    assert on_disk(tmp_path / FILE_NAME) == 0
    await clock.advance(module.FLUSH_S)
    for _ in range(2000):  # a thread writes them
        if on_disk(tmp_path / FILE_NAME):
            break
        await asyncio.sleep(0.005)
    assert on_disk(tmp_path / FILE_NAME) == 5
    assert module.FLUSH_S <= 0.5  # of the second that a crash may cost


async def test_what_was_added_last_is_found_at_once_newest_first(log: AuditLog) -> None:
    log.add(entry(1))
    log.add(entry(2))
    assert await found(log) == [2, 1]
    log.add(entry(3))
    assert await found(log) == [3, 2, 1]


async def test_a_note_is_by_whoever_this_task_works_for(log: AuditLog, clock: VirtualClock) -> None:
    before = actor.set(ANN)
    log.note("move", "position", device="bench", axis=1, old=0, new=1.5, detail="microsteps")
    actor.reset(before)
    log.note("start", "stepscope")
    server, ann = await log.search(EntryFilter(), 10)
    assert (ann.who, ann.kind, ann.address, ann.at_unix_s) == ("Ann", "browser", "10.0.0.7", 1e9 + clock.now())
    assert (ann.device, ann.axis, ann.old, ann.new, ann.detail) == ("bench", 1, 0, 1.5, "microsteps")
    assert (server.who, server.kind, server.old) == ("stepscope", "server", None)


async def test_every_value_comes_back_as_it_was(log: AuditLog) -> None:
    values = [None, 0, -(1 << 63), 1 << 70, 0.1, "text", "", "ä→😀", "12"]
    for value in values:
        log.add(entry(0, old=value, new=value))
    assert list(reversed(await found(log))) == values


async def test_it_is_searched_by_words_people_devices_and_time(log: AuditLog) -> None:
    log.add(entry(1, subject="V_MAX", who="Ann"))
    log.add(entry(2, subject="A_MAX", who="Bob", device="slider", detail="toff 3 -> 4"))
    log.add(entry(3, subject="100%_sure", action="move", outcome="refused: too far away", address="10.1.2.3"))
    assert await found(log, text="max v_") == [1]
    assert await found(log, text="MAX") == [2, 1]
    assert await found(log, text="toff") == [2]
    assert await found(log, text="10.1.2") == [3]
    assert await found(log, text="0%_s") == [3]
    assert await found(log, text="%") == [3]
    assert await found(log, text="far refused") == [3]
    assert await found(log, text="nothing of it") == []
    assert await found(log, who="Bob") == [2]
    assert await found(log, device="bench") == [3, 1]
    assert await found(log, action="write", device="bench") == [1]
    assert await found(log, outcome="refused") == [3]
    assert await found(log, outcome="done") == [2, 1]
    assert await found(log, since_unix_s=1e9 + 2) == [3, 2]
    assert await found(log, until_unix_s=1e9 + 2) == [1]
    newest, middle, oldest = await log.search(EntryFilter(), 10)
    assert await found(log, after=oldest.id) == [3, 2]
    assert [each.new for each in await log.search(EntryFilter(), 1, before=newest.id)] == [middle.new]
    known = await log.known()
    assert (known.devices, known.who, known.actions) == (["bench", "slider"], ["Ann", "Bob"], ["move", "write"])


async def test_texts_from_outside_are_cut_and_made_storable(log: AuditLog) -> None:
    log.add(entry(1, who="\udcff" + "x" * 500, subject="y" * 5000))
    (kept,) = await log.search(EntryFilter(), 10)
    assert kept.who.startswith("?x")
    assert len(kept.who) == 100
    assert len(kept.subject) == 200
    assert kept.subject.endswith("…")


async def test_the_oldest_go(log: AuditLog, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "KEPT", 50)
    monkeypatch.setattr(module, "TRIMMED_EVERY", 10)
    for number in range(120):
        log.add(entry(number))
        if number % 7 == 0:
            await log.search(EntryFilter(), 1)
    kept = await log.search(EntryFilter(), 1000)
    assert 50 <= len(kept) <= 60
    assert kept[0].new == 119


async def test_what_the_database_does_not_take_waits(
    log: AuditLog,
    clock: VirtualClock,
    tmp_path: Path,
    caplog: pytest.LogCaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "WAITING_MAX", 20)
    caplog.set_level(logging.WARNING)
    full = {"full": True}

    def no_room(connection: sqlite3.Connection, _: object, __: object) -> None:
        connection.execute(f"PRAGMA max_page_count={1 if full['full'] else 1_000_000}")

    event.listen(Engine, "checkout", no_room)
    try:
        for number in range(30):
            log.add(entry(number, detail="z" * 500))
        assert await log.search(EntryFilter(), 100) == []  # nothing pretends that it is there
        assert caplog.text.count("is not written") == 1
        full["full"] = False
        kept = await log.search(EntryFilter(), 100)
    finally:
        event.remove(Engine, "checkout", no_room)
    assert [each.new for each in kept[:20]] == list(range(29, 9, -1))
    assert (kept[20].action, kept[20].new) == ("lost entries", 10)
    assert "written again" in caplog.text


async def test_closing_writes_what_waits(database: Database, clock: VirtualClock, tmp_path: Path) -> None:
    log = AuditLog(database, clock)
    log.add(entry(1))
    await asyncio.sleep(0)  # its task sleeps on a clock that nobody moves
    await log.close()
    assert on_disk(tmp_path / FILE_NAME) == 1
    log.add(entry(2))  # too late, and no harm
    database.close()


async def test_a_request_knows_what_was_entered_for_it(log: AuditLog) -> None:
    with request_under_way() as request:
        log.add(entry(1))
        log.add(entry(2, outcome="not proven: no reply"))
    log.add(entry(3, outcome="refused: no"))
    assert (request.changes, request.failures) == (2, 1)


async def test_no_secret_gets_in(log: AuditLog, tmp_path: Path) -> None:
    before = actor.set(ANN)
    log.note("write", "v_max")
    actor.reset(before)
    await log.search(EntryFilter(), 1)
    assert ANN.session is not None
    for file in (tmp_path / FILE_NAME, tmp_path / f"{FILE_NAME}-wal"):
        assert ANN.session.encode() not in await asyncio.to_thread(file.read_bytes)


async def test_writing_keeps_nothing_of_the_request_that_was_noted(log: AuditLog) -> None:
    class Subject:
        """Something that belongs to a request."""

    whose, subject = ContextVar[object]("whose"), Subject()
    kept = weakref.ref(subject)

    def request(what: Subject) -> None:
        whose.set(what)
        log.note("start", "stepscope")

    copy_context().run(request, subject)
    del subject
    gc.collect()
    assert kept() is None
