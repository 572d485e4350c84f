"""The SQLite file itself, through SQLAlchemy: opened, brought up to date, its errors in our words.

Apart from `database`, which imports it when it is first worked on: SQLAlchemy is a tenth of what a start imports.
"""

from __future__ import annotations

import json
import logging
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sqlalchemy import Connection, Engine, create_engine, event, inspect
from sqlalchemy.exc import DatabaseError, DBAPIError, IntegrityError
from sqlalchemy.orm import Session

from ..errors import StoreUnavailable
from .files import aside_name, exclusive
from .tables import Base

if TYPE_CHECKING:  # alembic takes 0.2 s of work to import: only a file that has to be changed needs it
    from alembic.config import Config

log = logging.getLogger("stepscope.store")

MIGRATIONS = Path(__file__).with_name("migrations")
VERSION_TABLE = "alembic_version"
"""Where alembic keeps which steps a file has behind it."""
HEADER_BYTES = 100
"""What every database begins with."""
BUSY_S = 5.0
"""How long to wait for another writer [s]: all of ours are done within milliseconds."""
BEGIN = "stepscope_begin"
WRITABLE = "give stepscope a data directory that it may write to"
DAMAGED = frozenset({sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB})


class NewerFile(Exception):
    """The file is of a newer stepscope: it stays as it is. `problem` is what to tell of it."""

    def __init__(self, problem: StoreUnavailable) -> None:
        super().__init__(str(problem))
        self.problem = problem


class _Damaged(Exception):
    """The file is no database of ours; the text says why."""


def opened(path: Path, notes: list[str]) -> Engine:
    """The file, made or brought up to date. A damaged one is set aside, which `notes` tells, and a new one begun.

    Raises StoreUnavailable, NewerFile.
    """
    try:
        with exclusive(path):  # two servers that start at once make it once
            try:
                return _brought_up_to_date(path)
            except _Damaged as damage:
                aside = _set_aside(path)
                notes.append(f"{path} is damaged ({damage}); kept as {aside}, and a new one is begun")
                log.warning("%s", notes[-1])
                return _brought_up_to_date(path)
    except (OSError, _Damaged) as error:
        raise StoreUnavailable(f"{path} cannot be used: {error}", WRITABLE) from error
    except DBAPIError as error:
        raise _translated(path, error) from error


@contextmanager
def session_of(engine: Engine, path: Path, begin: str) -> Iterator[Session]:
    """Work on it; `begin` is what a transaction begins with. Raises StoreUnavailable."""
    try:
        with Session(engine.execution_options(**{BEGIN: begin})) as session:
            yield session
    except IntegrityError:
        raise
    except DBAPIError as error:
        raise _translated(path, error) from error


def _brought_up_to_date(path: Path) -> Engine:
    if path.is_dir():
        raise _Damaged("a folder stands in its place")
    if path.is_file() and (size := path.stat().st_size) < HEADER_BYTES:
        # SQLite would take it for a new one, and write over it without a word.
        raise _Damaged(f"it is only {size} bytes long")
    url = f"sqlite+pysqlite:///{path}"
    engine = create_engine(url, connect_args={"timeout": BUSY_S}, json_deserializer=_json_or_none)
    event.listen(engine, "connect", _prepare)
    event.listen(engine, "begin", _begin)
    try:
        with engine.connect() as connection:
            _check(connection)
            current = _is_current(path, connection)
        if not current:  # only then: a file that may not be written can be read all the same
            with engine.execution_options(**{BEGIN: "IMMEDIATE"}).begin() as connection:
                from alembic import command

                command.upgrade(config_for(connection), "head")
    except DatabaseError as error:
        engine.dispose()
        if _code(error) in DAMAGED:
            raise _Damaged(str(error.orig)) from error
        raise
    except UnicodeDecodeError as error:  # SQLite's own message quotes what it could not read
        engine.dispose()
        raise _Damaged("what it says of its tables is no text") from error
    except BaseException:
        engine.dispose()
        raise
    return engine


def _is_current(path: Path, connection: Connection) -> bool:
    """Whether nothing has to be brought up to date. Raises NewerFile for a file that is newer than that."""
    tables = inspect(connection).get_table_names()
    here: set[str] = set()
    if VERSION_TABLE in tables:
        here.update(connection.exec_driver_sql(f"SELECT version_num FROM {VERSION_TABLE}").scalars())
    known = steps()
    unknown = here - set(known)
    if unknown:
        problem = StoreUnavailable(
            f"{path} is of a newer stepscope (step {', '.join(sorted(unknown))}) and stays untouched",
            "use that version, or another --data-dir; until then there is no audit log and no kept profile",
        )
        raise NewerFile(problem)
    if not here and tables:
        raise _Damaged("a database, but none of stepscope's")
    return here == {known[-1]}


def _set_aside(path: Path) -> Path:
    aside = aside_name(path)
    for suffix in ("-wal", "-shm"):  # what was not yet in the file belongs to it, not to the next one
        beside = path.with_name(path.name + suffix)
        if beside.exists():
            beside.rename(aside.with_name(aside.name + suffix))
    return path.rename(aside)


def _translated(path: Path, error: DBAPIError) -> StoreUnavailable:
    code = _code(error)
    if code == sqlite3.SQLITE_FULL:
        return StoreUnavailable(f"the disk of {path} is full", "make room on it")
    if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
        return StoreUnavailable(f"another program has held {path} for {BUSY_S:g} s", "close that program")
    if code in (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM):
        return StoreUnavailable(f"{path} may not be written", WRITABLE)
    if code in DAMAGED:
        return StoreUnavailable(f"{path} is damaged: {error.orig}", "start stepscope again: it begins anew")
    return StoreUnavailable(f"{path} cannot be used: {error.orig}", "see to its disk")


def steps() -> list[str]:
    """The numbers of all steps, in their order: each is a file `r<number>_<what>.py` that follows the one before."""
    return sorted(file.stem[1:].partition("_")[0] for file in (MIGRATIONS / "versions").glob("r*.py"))


def config_for(connection: Connection) -> Config:
    """Alembic's configuration for work on `connection`; needs no file."""
    from alembic.config import Config

    config = Config(attributes={"connection": connection, "metadata": Base.metadata})
    config.set_main_option("script_location", str(MIGRATIONS).replace("%", "%%"))
    return config


def _text(data: bytes) -> str:
    return data.decode("utf-8", "replace")


def _json_or_none(text: str) -> Any:
    """What a column of JSON holds; None where that is none any more."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


def _check(connection: Connection) -> None:
    found = connection.exec_driver_sql("PRAGMA quick_check(1)").scalar()
    if found != "ok":
        raise _Damaged(str(found))


def _code(error: DBAPIError) -> int | None:
    """SQLite's primary error code."""
    code = getattr(error.orig, "sqlite_errorcode", None)
    return None if code is None else int(code) & 0xFF


def _prepare(dbapi_connection: sqlite3.Connection, _: Any) -> None:
    # The module's own transactions leave DDL out of them: SQLAlchemy begins ours (`_begin`).
    dbapi_connection.isolation_level = None
    # Noise within a row passes SQLite's own check: one bad text must not cost all the others.
    dbapi_connection.text_factory = _text
    for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
        dbapi_connection.execute(f"PRAGMA {pragma}")


def _begin(connection: Connection) -> None:
    connection.exec_driver_sql(f"BEGIN {connection.get_execution_options().get(BEGIN, '')}")
