"""The search for modules on a port, as a job of the server: one at a time, looked at and ended from here."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Sequence

from app.api.schemas_links import ProbeFound, ProbeState
from app.links.errors import BenchError, WrongState

log = logging.getLogger("stepscope.api")


class Probing:
    """The search that runs, or the latest one."""

    def __init__(self) -> None:
        self._task: asyncio.Task[None] | None = None
        self._port: str | None = None
        self._done = self._total = 0
        self._found: list[ProbeFound] = []
        self._message = "nothing was searched yet"

    @property
    def running(self) -> bool:
        return self._task is not None and not self._task.done()

    def state(self) -> ProbeState:
        return ProbeState(
            running=self.running,
            done=self._done,
            total=self._total,
            port=self._port,
            found=list(self._found),
            message=self._message,
        )

    def start(self, port: str, bauds: Sequence[int] | None, addresses: Sequence[int] | None) -> ProbeState:
        """Begin. Raises WrongState while one runs."""
        if self.running:
            raise WrongState(f"a search on {self._port} runs", "wait for it, or end it: DELETE .../ports/probe")
        self._port, self._done, self._total, self._found = port, 0, 0, []
        self._message = f"looking on {port}"
        self._task = asyncio.create_task(self._run(port, bauds, addresses), name="probe")
        return self.state()

    async def abort(self) -> ProbeState:
        """End it; returns when the port is free again."""
        if self.running and self._task is not None:
            self._task.cancel()
            await asyncio.wait({self._task})
        return self.state()

    async def _run(self, port: str, bauds: Sequence[int] | None, addresses: Sequence[int] | None) -> None:
        from app.links.discovery import probe

        try:
            await probe(port, bauds, addresses, self._progress)
        except asyncio.CancelledError:
            self._message = "ended on request"
        except BenchError as error:
            self._message = str(error)
        else:
            self._message = f"{len(self._found)} found" if self._found else "nothing answered"
