"""The one SQLite file: made once, brought up to date, never lost, and never in the way of the bench."""

from __future__ import annotations

import logging
import multiprocessing
import os
import sqlite3
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from alembic import command
from alembic.script import ScriptDirectory
from sqlalchemy import Engine, create_engine, event, func, select
from sqlalchemy.orm import Session

from app.errors import StoreUnavailable
from app.store.database import FILE_NAME, Database
from app.store.database_file import MIGRATIONS, config_for, steps
from app.store.tables import AuditRow, ProfileRow

ROOT = Path(__file__).parents[2]
STEPS = [step.revision for step in reversed(list(ScriptDirectory(str(MIGRATIONS)).walk_revisions()))]
"""All revisions, the oldest first."""


def profile(name: str = "soft") -> ProfileRow:
    return ProfileRow(name=name, model="tmc428", created_unix_s=1.5, note="", document={"a": [1, "ä"]}, version=1)


def keep(database: Database, name: str = "soft") -> None:
    database.write_now(lambda session: session.add(profile(name)))


def names(database: Database) -> list[str]:
    return database.read_now(lambda session: list(session.scalars(select(ProfileRow.name).order_by(ProfileRow.id))))


@contextmanager
def opened(data_dir: Path) -> Iterator[Database]:
    database = Database(data_dir)
    database.open()
    try:
        yield database
    finally:
        database.close()


@contextmanager
def every_connection(pragma: str) -> Iterator[None]:
    """SQLite itself refuses, as it does on a disk that is full or may not be written."""

    def prepare(connection: sqlite3.Connection, _: object) -> None:
        connection.execute(f"PRAGMA {pragma}")

    event.listen(Engine, "connect", prepare)
    try:
        yield
    finally:
        event.remove(Engine, "connect", prepare)


def test_what_was_kept_is_there_after_a_restart(tmp_path: Path) -> None:
    with opened(tmp_path / "deep" / "down") as database:
        keep(database)
        assert database.problem is None
    with opened(tmp_path / "deep" / "down") as database:
        row = database.read_now(lambda session: session.scalars(select(ProfileRow)).one().document)
        assert row == {"a": [1, "ä"]}


def test_it_is_in_wal_mode_and_knows_foreign_keys(tmp_path: Path) -> None:
    with opened(tmp_path) as database:
        for pragma, wanted in (("journal_mode", "wal"), ("foreign_keys", 1)):
            got = database.read_now(
                lambda session, pragma=pragma: (
                    session.connection()
                    .exec_driver_sql(  # type: ignore[misc]
                        f"PRAGMA {pragma}"
                    )
                    .scalar()
                )
            )
            assert got == wanted


async def test_work_is_done_in_a_thread_and_whole_or_not_at_all(tmp_path: Path) -> None:
    with opened(tmp_path) as database:

        def half(session: Session) -> None:
            session.add(profile())
            session.flush()
            raise ZeroDivisionError

        with pytest.raises(ZeroDivisionError):
            await database.write(half)
        assert await database.read(lambda session: session.scalar(select(func.count(ProfileRow.id)))) == 0


# --- migrations ---------------------------------------------------------------------------------


def at_step(path: Path, revision: str) -> None:
    """A file as the version of stepscope had it that knew `revision` as its last."""
    engine = create_engine(f"sqlite+pysqlite:///{path}")
    with engine.begin() as connection:
        command.upgrade(config_for(connection), revision)
    engine.dispose()


BEFORE: dict[str, Callable[[sqlite3.Connection], object]] = {
    "0001": lambda db: (
        db.execute("INSERT INTO profiles VALUES (7, 'kept', 'tmc428', 1.5, 'n', '{\"x\": 1}', 1)"),
        db.execute(
            "INSERT INTO audit VALUES (3, 9.5, 'Ann', 'browser', '::1', 'bench', 0, 'write', 'v_max', '1', '2', 'done')"
        ),
    ),
    "0002": lambda db: (
        db.execute("INSERT INTO profiles VALUES (7, 'kept', 'tmc428', 1.5, 'n', '{\"x\": 1}', 1)"),
        db.execute(
            "INSERT INTO audit VALUES (3, 9.5, 'Ann', 'browser', '::1', 'bench', 0, 'write', 'v_max', '1', '2',"
            " 'done', '')"
        ),
    ),
    "0003": lambda db: (
        db.execute("INSERT INTO profiles VALUES (7, 'kept', 'tmc428', 1.5, 'n', '{\"x\": 1}', 1)"),
        db.execute(
            "INSERT INTO audit VALUES (3, 9.5, 'Ann', 'browser', '::1', 'bench', 0, 'write', 'v_max', '1', '2',"
            " 'done', '', 17)"
        ),
    ),
}
"""What each older version would have put into its file: a new step needs its own line here."""


@pytest.mark.parametrize("revision", STEPS)
def test_a_file_of_any_older_version_comes_up_with_all_that_is_in_it(tmp_path: Path, revision: str) -> None:
    at_step(tmp_path / FILE_NAME, revision)
    with sqlite3.connect(tmp_path / FILE_NAME) as old:
        BEFORE[revision](old)
    old.close()
    with opened(tmp_path) as database:
        assert database.problem is None
        kept = database.read_now(lambda session: session.get(ProfileRow, 7))
        assert kept is not None
        assert (kept.name, kept.document) == ("kept", {"x": 1})
        entry = database.read_now(lambda session: session.get(AuditRow, 3))
        assert entry is not None
        assert (entry.who, entry.old, entry.new, entry.detail) == ("Ann", 1, 2, "")
        keep(database, "new")
        assert names(database) == ["kept", "new"]


def test_the_tables_are_those_that_the_steps_make(tmp_path: Path) -> None:
    with opened(tmp_path):
        pass
    engine = create_engine(f"sqlite+pysqlite:///{tmp_path / FILE_NAME}")
    try:
        with engine.connect() as connection:
            command.check(config_for(connection))  # raises where a step is missing
    finally:
        engine.dispose()


def test_a_step_that_fails_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    at_step(tmp_path / FILE_NAME, STEPS[0])
    with sqlite3.connect(tmp_path / FILE_NAME) as old:
        old.execute("ALTER TABLE audit ADD COLUMN detail VARCHAR")  # so the next step cannot add it
    old.close()
    before = (tmp_path / FILE_NAME).read_bytes()
    with opened(tmp_path) as database:
        assert "cannot be used" in str(database.problem)
        with pytest.raises(StoreUnavailable):
            keep(database)
    with sqlite3.connect(tmp_path / FILE_NAME) as now:
        assert now.execute("SELECT version_num FROM alembic_version").fetchall() == [(STEPS[0],)]
    now.close()
    assert len(before) == len((tmp_path / FILE_NAME).read_bytes())


# --- what goes wrong ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "content", [b"no database at all, but a text of some length\n" * 40, b"SQLite format 3\0garbage"]
)
def test_a_damaged_file_is_set_aside_and_a_new_one_begun(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, content: bytes
) -> None:
    (tmp_path / FILE_NAME).write_bytes(content)
    (tmp_path / f"{FILE_NAME}-wal").write_bytes(b"what was not yet in it")
    with opened(tmp_path) as database:
        keep(database)
        assert names(database) == ["soft"]
    aside = list(tmp_path.glob("stepscope.broken-*.sqlite3"))
    assert [path.read_bytes() for path in aside] == [content]
    assert str(aside[0]) in caplog.text


def test_pages_that_got_lost_are_noticed(tmp_path: Path) -> None:
    with opened(tmp_path) as database:
        for number in range(200):
            keep(database, f"name {number}" * 20)
    path = tmp_path / FILE_NAME
    content = bytearray(path.read_bytes())
    content[8192:-8192] = bytes(len(content) - 16384)
    path.write_bytes(content)
    with opened(tmp_path) as database:
        assert database.problem is None
        assert names(database) == []
    assert len(list(tmp_path.glob("stepscope.broken-*.sqlite3"))) == 1


def test_somebody_elses_database_is_set_aside_too(tmp_path: Path) -> None:
    with sqlite3.connect(tmp_path / FILE_NAME) as other:
        other.execute("CREATE TABLE songs (title)")
    other.close()
    with opened(tmp_path) as database:
        keep(database)
    with sqlite3.connect(next(iter(tmp_path.glob("stepscope.broken-*.sqlite3")))) as aside:
        assert aside.execute("SELECT count(*) FROM songs").fetchone() == (0,)
    aside.close()


def test_a_file_of_a_newer_version_stays_as_it_is(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with opened(tmp_path) as database:
        keep(database)
    with sqlite3.connect(tmp_path / FILE_NAME) as newer:
        newer.execute("UPDATE alembic_version SET version_num = '9999'")
    newer.close()
    before = (tmp_path / FILE_NAME).read_bytes()
    with opened(tmp_path) as database:
        with pytest.raises(StoreUnavailable, match="newer stepscope") as caught:
            names(database)
        assert "--data-dir" in caught.value.way_out
        with pytest.raises(StoreUnavailable):
            keep(database)
    assert (tmp_path / FILE_NAME).read_bytes() == before
    assert not list(tmp_path.glob("*.broken-*"))
    assert caplog.text.count("newer stepscope") == 1


def unwritable(tmp_path: Path) -> Path:
    """A folder in which nothing can be made, whoever runs the tests."""
    folder = tmp_path / "locked"
    folder.mkdir()
    folder.chmod(0o555)
    return Path("/proc/stepscope") if os.access(folder, os.W_OK) else folder  # root may write anywhere but there


@pytest.mark.skipif(sys.platform != "linux", reason="/proc")
def test_a_folder_that_may_not_be_written_is_told_once_and_tried_again(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    database = Database(unwritable(tmp_path))
    database.open()
    for _ in range(2):
        with pytest.raises(StoreUnavailable, match="cannot be used"):
            keep(database)
    assert caplog.text.count("cannot be used") == 1
    database.path = tmp_path / "better" / FILE_NAME  # as when somebody mends it
    keep(database)
    assert names(database) == ["soft"]
    database.close()


def test_a_file_that_may_not_be_written_can_be_read(tmp_path: Path) -> None:
    with opened(tmp_path) as database:
        keep(database)
    with every_connection("query_only=1"), opened(tmp_path) as database:
        assert names(database) == ["soft"]
        with pytest.raises(StoreUnavailable, match="may not be written"):
            keep(database)


def test_a_full_disk_loses_nothing_that_is_there(tmp_path: Path) -> None:
    with opened(tmp_path) as database:
        keep(database)
    with every_connection("max_page_count=1"), opened(tmp_path) as database:  # no more than there are
        with pytest.raises(StoreUnavailable, match="full") as caught:
            keep(database, "x" * 100_000)
        assert "make room" in caught.value.way_out
        assert names(database) == ["soft"]
    with opened(tmp_path) as database:
        keep(database, "y" * 100_000)
        assert len(names(database)) == 2


def test_one_that_is_closed_says_so(tmp_path: Path) -> None:
    with opened(tmp_path) as database:
        pass
    with pytest.raises(StoreUnavailable, match="closed"):
        names(database)


def test_a_writer_waits_for_another_one_and_gives_up_with_its_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.store.database_file.BUSY_S", 0.05)
    with opened(tmp_path) as database:
        other = sqlite3.connect(tmp_path / FILE_NAME, isolation_level=None)
        other.execute("BEGIN IMMEDIATE")
        assert names(database) == []  # readers need not wait
        with pytest.raises(StoreUnavailable, match="another program"):
            keep(database)
        other.execute("COMMIT")
        other.close()
        keep(database)


def _write_many(data_dir: Path, who: str, begin: object) -> None:
    logging.disable()
    begin.wait()  # type: ignore[attr-defined]
    with opened(data_dir) as database:
        for number in range(40):
            keep(database, f"{who} {number}")


def test_two_servers_that_start_on_one_empty_folder_lose_nothing(tmp_path: Path) -> None:
    context = multiprocessing.get_context("spawn")
    begin = context.Barrier(2)
    servers = [context.Process(target=_write_many, args=(tmp_path, who, begin)) for who in ("a", "b")]
    for server in servers:
        server.start()
    for server in servers:
        server.join(60)
        assert server.exitcode == 0
    with opened(tmp_path) as database:
        kept = names(database)
    assert sorted(kept) == sorted(f"{who} {number}" for who in ("a", "b") for number in range(40))
    assert not list(tmp_path.glob("*.broken-*"))


def test_alembic_reads_the_same_steps_in_the_same_order() -> None:
    assert steps() == STEPS
