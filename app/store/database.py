"""The one SQLite file of the data directory, worked on off the loop.

Two servers may share it: WAL lets readers read while another writes, and writers wait for each other. What cannot be
opened turns only what is kept in it off, and says so; motors run without it.
"""

from __future__ import annotations

import asyncio
import logging
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from ..errors import StoreUnavailable

if TYPE_CHECKING:  # the page is there before the database is: see `database_file`
    from sqlalchemy import Engine
    from sqlalchemy.orm import Session

log = logging.getLogger("stepscope.store")

FILE_NAME = "stepscope.sqlite3"
T = TypeVar("T")


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
            from .database_file import NewerFile, opened

            try:
                self._engine = opened(self.path, self.notes)
                self.problem = None
            except NewerFile as newer:
                log.warning("%s; %s", newer.problem, newer.problem.way_out)
                self._newer, self.problem = True, newer.problem
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
        from .database_file import session_of

        with session_of(engine, self.path, begin) as session:
            yield session
