"""The one SQLite file of the data directory: opening it, bringing it up to date, and working on it off the loop.

Two servers may share it: WAL lets readers read while another writes, and writers wait for each other. What cannot be
opened turns only what is kept in it off, and says so; motors run without it.
"""

from __future__ import annotations

import asyncio
import json
import logging
import sqlite3
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from sqlalchemy import Connection, Engine, create_engine, event, inspect
from sqlalchemy.exc import DatabaseError, DBAPIError, IntegrityError
from sqlalchemy.orm import Session

from ..errors import StoreUnavailable
from .files import aside_name, exclusive
from .tables import Base

if TYPE_CHECKING:  # alembic takes 0.2 s of work to import: only a file that has to be changed needs it
    from alembic.config import Config

log = logging.getLogger("stepscope.store")

FILE_NAME = "stepscope.sqlite3"
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

T = TypeVar("T")


class _Damaged(Exception):
    """The file is no database of ours; the text says why."""


class Database:
    """`open` once, then `read` and `write` as often as wanted. All but `open` and `close` never block the loop."""

    def __init__(self, data_dir: Path) -> None:
        self.path = data_dir / FILE_NAME
        self.problem: StoreUnavailable | None = None
        """Why it is not open; None while it is."""
        self.notes: list[str] = []
        """What was set aside, for people."""
        self._engine: Engine | None = None
        self._opening = threading.Lock()
        self._newer = False
        self._closed = False

    # --- opening --------------------------------------------------------------------------------

    def open(self) -> None:
        """Open the file, make it or bring it up to date. Blocks. Raises nothing: `problem` and the log tell.

        A damaged file is set aside and a new one begun. One of a newer version stays as it is.
        """
        with self._opening:
            if self._engine is not None or self._newer or self._closed:
                return
            try:
                self._engine = self._opened()
                self.problem = None
            except StoreUnavailable as problem:
                if str(problem) != str(self.problem):  # else it was said already
                    log.warning("%s; %s", problem, problem.way_out)
                self.problem = problem

    def close(self) -> None:
        """Let go of the file. What comes afterwards is refused."""
        with self._opening:
            self._closed = True
            if self._engine is not None:
                self._engine.dispose()
                self._engine = None

    def _opened(self) -> Engine:
        try:
            with exclusive(self.path):  # two servers that start at once make it once
                try:
                    return self._brought_up_to_date()
                except _Damaged as damage:
                    aside = self._set_aside()
                    self.notes.append(f"{self.path} is damaged ({damage}); kept as {aside}, and a new one is begun")
                    log.warning("%s", self.notes[-1])
                    return self._brought_up_to_date()
        except (OSError, _Damaged) as error:
            raise StoreUnavailable(f"{self.path} cannot be used: {error}", WRITABLE) from error
        except DBAPIError as error:
            raise self._translated(error) from error

    def _brought_up_to_date(self) -> Engine:
        if self.path.is_dir():
            raise _Damaged("a folder stands in its place")
        if self.path.is_file() and (size := self.path.stat().st_size) < HEADER_BYTES:
            # SQLite would take it for a new one, and write over it without a word.
            raise _Damaged(f"it is only {size} bytes long")
        url = f"sqlite+pysqlite:///{self.path}"
        engine = create_engine(url, connect_args={"timeout": BUSY_S}, json_deserializer=_json_or_none)
        event.listen(engine, "connect", _prepare)
        event.listen(engine, "begin", _begin)
        try:
            with engine.connect() as connection:
                _check(connection)
                current = self._is_current(connection)
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

    def _is_current(self, connection: Connection) -> bool:
        """Whether nothing has to be brought up to date. Raises StoreUnavailable for a file that is newer than that."""
        tables = inspect(connection).get_table_names()
        here: set[str] = set()
        if VERSION_TABLE in tables:
            here.update(connection.exec_driver_sql(f"SELECT version_num FROM {VERSION_TABLE}").scalars())
        known = steps()
        unknown = here - set(known)
        if unknown:
            self._newer = True
            raise StoreUnavailable(
                f"{self.path} is of a newer stepscope (step {', '.join(sorted(unknown))}) and stays untouched",
                "use that version, or another --data-dir; until then there is no audit log and no kept profile",
            )
        if not here and tables:
            raise _Damaged("a database, but none of stepscope's")
        return here == {known[-1]}

    def _set_aside(self) -> Path:
        aside = aside_name(self.path)
        for suffix in ("-wal", "-shm"):  # what was not yet in the file belongs to it, not to the next one
            beside = self.path.with_name(self.path.name + suffix)
            if beside.exists():
                beside.rename(aside.with_name(aside.name + suffix))
        return self.path.rename(aside)

    # --- work -----------------------------------------------------------------------------------

    async def read(self, work: Callable[[Session], T]) -> T:
        """Do `work` in a thread, on what is committed. Raises StoreUnavailable."""
        return await asyncio.to_thread(self.read_now, work)

    async def write(self, work: Callable[[Session], T]) -> T:
        """Do `work` in a thread, in one transaction: all of it, or nothing where it raises. Raises StoreUnavailable."""
        return await asyncio.to_thread(self.write_now, work)

    def read_now(self, work: Callable[[Session], T]) -> T:
        """`read` for those who are in a thread already."""
        with self._session("") as session:
            return work(session)

    def write_now(self, work: Callable[[Session], T]) -> T:
        """`write` for those who are in a thread already."""
        # IMMEDIATE: a transaction that began by reading could not wait for another writer, it would fail.
        with self._session("IMMEDIATE") as session, session.begin():
            return work(session)

    @contextmanager
    def _session(self, begin: str) -> Iterator[Session]:
        self.open()  # a disk that was full, a folder that was not there: they may be by now
        engine = self._engine
        if engine is None:
            raise self.problem or StoreUnavailable(f"{self.path} is closed: stepscope ends", "start it again")
        try:
            with Session(engine.execution_options(**{BEGIN: begin})) as session:
                yield session
        except IntegrityError:
            raise
        except DBAPIError as error:
            raise self._translated(error) from error

    def _translated(self, error: DBAPIError) -> StoreUnavailable:
        code = _code(error)
        if code == sqlite3.SQLITE_FULL:
            return StoreUnavailable(f"the disk of {self.path} is full", "make room on it")
        if code in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
            return StoreUnavailable(f"another program has held {self.path} for {BUSY_S:g} s", "close that program")
        if code in (sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM):
            return StoreUnavailable(f"{self.path} may not be written", WRITABLE)
        if code in DAMAGED:
            return StoreUnavailable(f"{self.path} is damaged: {error.orig}", "start stepscope again: it begins anew")
        return StoreUnavailable(f"{self.path} cannot be used: {error.orig}", "see to its disk")


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
