"""Work that takes long, in a process of its own: the server's loop has stops and samples to see to."""

from __future__ import annotations

import asyncio
import contextlib
import multiprocessing
import os
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import TypeVar

from .clock import Clock, WallClock

T = TypeVar("T")
NICENESS = 5
"""The server and its motors come first."""


class NotWorkedOut(Exception):
    """It took too long, or its process is gone. The message says which."""


async def in_process(work: Callable[..., T], *arguments: object, within_s: float) -> T:
    """What `work` returns; it and its arguments can be pickled. What it raises is raised. Raises NotWorkedOut."""
    pool = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), _begin)
    try:
        async with asyncio.timeout(within_s):
            return await asyncio.get_running_loop().run_in_executor(pool, work, *arguments)
    except TimeoutError as error:
        raise NotWorkedOut(f"it was not through within {within_s:g} s") from error
    except BrokenProcessPool as error:
        raise NotWorkedOut("the process that worked it out is gone") from error
    finally:
        for process in (pool._processes or {}).values():  # noqa: SLF001  # there is no other way to end it now
            process.kill()
        pool.shutdown(wait=False, cancel_futures=True)


async def worked_out(clock: Clock, work: Callable[..., T], *arguments: object, within_s: float) -> T:
    """The same; here where time waits for us, and there is nobody to hold up."""
    if isinstance(clock, WallClock):
        return await in_process(work, *arguments, within_s=within_s)
    with ThreadPoolExecutor(1) as thread:  # where no loop runs yet: it may want one of its own
        return thread.submit(work, *arguments).result()


def come_last() -> None:
    """Let this process have what the server and its motors leave."""
    with contextlib.suppress(AttributeError):  # there is none on Windows
        os.nice(NICENESS)


def _begin() -> None:
    """In the new process: come last, and end with the server, however that ends."""
    come_last()
    threading.Thread(target=_end_with_the_server, daemon=True).start()


def _end_with_the_server() -> None:
    server = multiprocessing.parent_process()
    assert server is not None
    server.join()
    os._exit(1)
