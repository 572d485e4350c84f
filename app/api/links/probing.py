"""The search for modules on a port, as a job of the server: one at a time, looked at and ended from here."""

from __future__ import annotations

import asyncio
import logging
import re
from collections.abc import Callable, Coroutine, Sequence
from typing import Any

from ...errors import BenchError, OutOfRange, WrongState
from ...links import evaluation_board
from ...links.datagram_uart import NODE_MAX
from ...links.discovery import FoundModule, ProbeProgress, probe, probe_chips
from ...links.serial_address import port_url
from ...registers.catalog import MODELS as CATALOG
from ...registers.catalog import listings
from ...registers.tmcl.modules import MODULES
from .schemas import ProbeFound, ProbeState

log = logging.getLogger("stepscope.api")

_Look = Callable[
    [str, Sequence[int] | None, Sequence[int] | None, Callable[[ProbeProgress], None]],
    Coroutine[Any, Any, list[FoundModule]],
]

MODELS = {module.number: name for name, module in MODULES.items()}
"""What modules call themselves, and the catalog."""
UART_CHIPS = {model.title: model.name for model in CATALOG.values() if model.uart}
"""Chips that are found by their UART, as the search calls them and the catalog."""


class Probing:
    """The search that runs, or the latest one."""

    def __init__(self) -> None:
        self._task: asyncio.Task[None] | None = None
        self._port: str | None = None
        self._progress = ProbeProgress(0, 0, (), "")
        self._ending = "nothing was searched yet"

    @property
    def running(self) -> bool:
        return self._task is not None and not self._task.done()

    def state(self) -> ProbeState:
        """How far it is, or how it ended."""
        progress = self._progress
        return ProbeState(
            running=self.running,
            done=progress.done,
            total=progress.total,
            port=self._port,
            found=[_found(module) for module in progress.found],
            message=f"asks {progress.asking or self._port}" if self.running else self._ending,
        )

    def start(
        self, port: str, bauds: Sequence[int] | None, addresses: Sequence[int] | None, *, chips: bool = False
    ) -> ProbeState:
        """Begin: for modules, or for `chips` on a UART. Raises WrongState while one runs, UsageError for what can be
        no port, OutOfRange for an address that nobody can have."""
        port_url(port)
        low, high = (0, NODE_MAX) if chips else (1, 255)
        for address in addresses or ():
            if not low <= address <= high:
                raise OutOfRange("addresses", address, low, high)
        if self.running:
            raise WrongState(f"a search on {self._port} runs", "wait for it, or end it: DELETE .../ports/probe")
        self._port, self._progress = port, ProbeProgress(0, 0, (), "")
        self._task = asyncio.create_task(
            self._run(probe_chips if chips else probe, port, bauds, addresses), name="probe"
        )
        return self.state()

    async def abort(self) -> ProbeState:
        """End it; returns when the port is free again."""
        if self.running and self._task is not None:
            self._ending = "ended on request"
            self._task.cancel()
            await asyncio.wait({self._task})
        return self.state()

    async def _run(self, look: _Look, port: str, bauds: Sequence[int] | None, addresses: Sequence[int] | None) -> None:
        try:
            found = await look(port, bauds, addresses, self._see)
        except BenchError as error:
            self._ending = str(error)
        except Exception as error:  # a mistake of ours must be seen by whoever waits for the search
            log.exception("the search on %s failed", port)
            self._ending = f"failed by a mistake in stepscope: {error!r}"
        else:
            self._ending = f"{len(found)} found" if found else "nothing answered"

    def _see(self, progress: ProbeProgress) -> None:
        self._progress = progress


def _module(number: int) -> str | None:
    """What the catalog calls a module by the number that it calls itself by; a listed one has that in its title."""
    listed = (
        model.name
        for model in listings()
        if model.kind == "module" and re.findall(r"\d+", model.title) == [str(number)]
    )
    return MODELS.get(number) or next(listed, None)


def _found(module: FoundModule) -> ProbeFound:
    if module.uart:
        alone = module.candidates[0] if len(module.candidates) == 1 else None
        model = UART_CHIPS.get(module.chip) or alone
    else:
        model = evaluation_board.chip_of(module.chip) if module.board else _module(module.number)
    return ProbeFound(
        kind="chip" if module.uart else "board" if module.board else "module",
        port=module.port,
        baud=module.baud,
        address=module.address,
        model=model or None,
        board=module.board or None,
        module=module.number,
        version=module.version,
        candidates=list(module.candidates),
    )
