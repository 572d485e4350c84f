"""Twins on this machine: in processes of their own, or in this one while everything else waits."""

from __future__ import annotations

import asyncio
import contextlib
import multiprocessing
import os
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from typing import Any

from ...aside import come_last
from .executor import JOB_S, JobLost, TwinJob
from .twin import run_job

PROCESSES_MAX = 16


class Here:
    """Runs a twin in this process: where the clock waits for us, there is nobody to hold up."""

    @property
    def where(self) -> str:
        return "in the server's own process"

    async def ready(self) -> int:
        return 1

    async def submit(self, job: TwinJob) -> dict[str, Any]:
        with ThreadPoolExecutor(1) as thread:
            return thread.submit(run_job, job).result()

    async def close(self) -> None:
        return None


class Processes:
    """Runs twins in one process a processor. Such a process that dies costs the setting that it tried."""

    def __init__(self, count: int | None = None) -> None:
        """`count` None: as many as there are processors."""
        self._count = count or max(1, min(os.cpu_count() or 1, PROCESSES_MAX))
        self._free: asyncio.Queue[_Worker] = asyncio.Queue()
        self._all: list[_Worker] = []
        self._threads: ThreadPoolExecutor | None = None

    @property
    def where(self) -> str:
        return f"in {self._count} processes of this machine"

    async def ready(self) -> int:
        self._threads = ThreadPoolExecutor(self._count, "twins")
        for _ in range(self._count):
            self._add()
        return self._count

    def _add(self) -> None:
        worker = _Worker()
        self._all.append(worker)
        self._free.put_nowait(worker)

    async def submit(self, job: TwinJob) -> dict[str, Any]:
        worker = await self._free.get()
        try:
            answer = await asyncio.get_running_loop().run_in_executor(self._threads, worker.run, job)
        except (EOFError, OSError, TimeoutError) as error:
            worker.end()
            self._all.remove(worker)
            self._add()
            raise JobLost(f"the process that tried setting {job.number} is gone") from error
        self._free.put_nowait(worker)
        return answer

    @property
    def pids(self) -> list[int]:
        """Of the processes that there are now."""
        return [worker.pid for worker in self._all]

    async def close(self) -> None:
        for worker in self._all:
            worker.end()
        if self._threads is not None:
            self._threads.shutdown(wait=False)


class _Worker:
    """One process that runs twins, one after the other, until its pipe ends."""

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, there = context.Pipe()
        self._process = context.Process(target=_serve, args=(there,), name="twin", daemon=True)
        self._process.start()
        there.close()  # so that this end hears when the process is gone

    @property
    def pid(self) -> int:
        assert self._process.pid is not None
        return self._process.pid

    def run(self, job: TwinJob) -> dict[str, Any]:
        """The trial that came of it. Blocks. Raises EOFError, OSError, TimeoutError where the process is gone."""
        self._pipe.send(job)
        if not self._pipe.poll(JOB_S):
            raise TimeoutError
        answer: dict[str, Any] = self._pipe.recv()
        return answer

    def end(self) -> None:
        self._process.kill()
        self._process.join()
        self._pipe.close()


def _serve(pipe: Connection) -> None:
    come_last()
    with contextlib.suppress(EOFError):
        while True:
            pipe.send(run_job(pipe.recv()))
