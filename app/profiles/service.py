"""Profiles of this server: one transaction a device at a time, how far it is, and what earlier ones have left."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Awaitable, Callable, Coroutine, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from ..devices.core.axis_limits import AxisLimits
from ..devices.core.config import AxisSettings
from ..devices.core.device import Device
from ..errors import WrongState
from . import journal
from .apply import Applied, Transaction
from .capture import capture
from .diff import Difference
from .document import ProfileDocument
from .errors import Change, ProfileLeft
from .journal import FileJournal, Unfinished
from .program import restore
from .rollback import way_back
from .trial import Tried, try_writes
from .writing import Progress

log = logging.getLogger("stepscope.profiles")

CLOSE_S = 2.0
"""How long the end of the program waits for a profile that is being applied [s]; what is cut off the journal tells."""

Busy = Callable[[Device], str]
"""What else is under way with a device, in words; "" for nothing."""
Configure = Callable[[Device, Sequence[AxisSettings]], Awaitable[None]]
"""Make these the settings of a device's axes."""
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of applying: `settings` are the mechanics and limits that were changed too."""

    applied: Applied
    settings: list[Difference]
    took_s: float


class ProfileService:
    """Applies profiles. `busy` and `configure` are what other rooms know and do."""

    def __init__(self, data_dir: Path, busy: Busy, configure: Configure) -> None:
        self._data_dir, self._busy, self._configure = data_dir, busy, configure
        self._running: dict[str, tuple[asyncio.Task[object], Progress]] = {}

    def tell_unfinished(self) -> None:
        """For the start: tell of what was cut off. Nothing is done about it."""
        for found in journal.read_all(self._data_dir):
            log.warning(
                "%s: applying the profile %r did not come to its end: GET /devices/%s/profile/apply tells what is left",
                found.device_name,
                found.profile,
                found.device,
            )

    async def close(self) -> None:
        """Let what is under way come to its end, for a while."""
        tasks = [task for task, _ in self._running.values()]
        if tasks:
            await asyncio.wait(tasks, timeout=CLOSE_S)
        for task in tasks:
            task.cancel()

    # --- capturing ------------------------------------------------------------------------------

    async def capture(self, device: Device, *, program: bool = False) -> ProfileDocument:
        """What `capture` tells of a device: never half of what it was and half of what it is to be.

        Raises what that does; WrongState while its settings are written.
        """
        self._require_unwritten(device)
        return await capture(device, program=program)

    # --- applying -------------------------------------------------------------------------------

    async def apply(
        self,
        device: Device,
        document: ProfileDocument,
        *,
        with_limits: bool = False,
        encoders: Mapping[int, str] | None = None,
    ) -> Outcome:
        """Bring a profile into a device, its mechanics too; its soft limits only `with_limits`.

        `encoders` are counters to be set to the position where an encoder's settings change: see `Transaction`.
        Goes on although the caller goes away. Raises what `Transaction.run` does; WrongState while another one is under
        way, something else drives the device, or an earlier one is unfinished.
        """
        unfinished = self.unfinished(device)
        if unfinished is not None:
            raise WrongState(
                f"applying the profile {unfinished.profile!r} to {device.name} did not come to its end",
                "take it back (POST .../profile/apply/way-back) or forget it (DELETE .../profile/apply)",
            )
        _settings(device, document, with_limits=with_limits)  # raises before the first write
        progress = Progress()
        file = FileJournal(journal.path_of(self._data_dir, device.id), device, document)
        transaction = Transaction(device, document, progress, file, encoders or {})

        async def work() -> Outcome:
            began_s = time.perf_counter()
            applied = await transaction.run()
            settings = _settings(device, document, with_limits=with_limits)  # limits may have been set meanwhile
            if [axis.settings for axis in device.axes] != settings:
                await self._configure(device, settings)
            told = [entry for entry in applied.diff.differences if _is_set(entry, with_limits=with_limits)]
            return Outcome(applied, told, time.perf_counter() - began_s)

        return await self._alone(device, progress, work)

    async def try_writes(self, device: Device) -> Tried:
        """Find out what can be set: see `trial`. Raises WrongState, LinkError."""
        return await self._alone(device, Progress(), lambda: try_writes(device))

    async def take_back(self, device: Device) -> list[Change]:
        """Bring back what an unfinished transaction has left; what it was that is as before now.

        Raises WrongState where there is none or the motor moves, ProfileLeft for what is still not as it was.
        """
        found = self.unfinished(device)
        if found is None:
            raise WrongState(f"no profile is left half applied to {device.name}", "")
        if found.model != device.model:
            raise WrongState(f"it was half applied to another model, {found.model}", "forget it (DELETE)")
        progress = Progress()

        async def work() -> list[Change]:
            left = await way_back(device, found.steps, progress)
            if found.program is not None:
                left += [kept for kept in [await restore(device, found.program)] if kept is not None]
            path = journal.path_of(self._data_dir, device.id)
            if not left:
                await asyncio.to_thread(path.unlink, missing_ok=True)
                return [half.change for half in found.halves if half.state != "not begun"]
            failed = replace(left[0], why=left[0].why or "it is not as it was")
            message = f"{len(left)} registers are still not as they were before the profile {found.profile!r}"
            raise ProfileLeft(message, failed, 0, len(found.steps), [], left)

        return await self._alone(device, progress, work)

    def forget(self, device: Device) -> None:
        """Leave the device as it is. Raises WrongState where nothing is unfinished."""
        if self.unfinished(device) is None:
            raise WrongState(f"no profile is left half applied to {device.name}", "")
        journal.path_of(self._data_dir, device.id).unlink(missing_ok=True)

    def unfinished(self, device: Device) -> Unfinished | None:
        """What an earlier transaction of this device has left; None while one is under way."""
        if self.progress(device) is not None:
            return None
        return journal.read(journal.path_of(self._data_dir, device.id))

    def progress(self, device: Device) -> Progress | None:
        """How far the present transaction is; None where there is none."""
        running = self._running.get(device.id)
        return running[1] if running is not None and not running[0].done() else None

    def _require_unwritten(self, device: Device) -> None:
        if self.progress(device) is not None:
            raise WrongState(f"a profile is being applied to {device.name}", "wait until that is over")

    async def _alone(self, device: Device, progress: Progress, work: Callable[[], Coroutine[Any, Any, T]]) -> T:
        """Do `work`, which goes on although whoever waits for it goes away."""
        self._require_unwritten(device)
        busy = self._busy(device)
        if busy:
            raise WrongState(f"{busy} on {device.name}", "end it first")
        task: asyncio.Task[T] = asyncio.create_task(work(), name=f"profile {device.id}")
        task.add_done_callback(lambda over: over.cancelled() or over.exception())  # heard, should nobody wait any more
        self._running[device.id] = (task, progress)
        try:
            return await asyncio.shield(task)
        finally:
            if task.done():
                self._running.pop(device.id, None)


def _settings(device: Device, document: ProfileDocument, *, with_limits: bool) -> list[AxisSettings]:
    """The device's axes as the profile has them. Raises OutOfRange, UsageError."""
    wanted = []
    for index, axis in enumerate(device.axes):
        if index >= len(document.axes):
            wanted.append(axis.settings)
            continue
        part = document.axes[index]
        limits = axis.settings.limits
        if with_limits and part.limits is not None:
            limits = AxisLimits(**part.limits.model_dump())
            limits.require_model(device.model)
        wanted.append(
            replace(
                axis.settings,
                name=part.name,
                full_steps_per_rev=part.full_steps_per_rev,
                driver_microsteps=part.driver_microsteps,
                gear_ratio=part.gear_ratio,
                travel_mm_per_rev=part.travel_mm_per_rev,
                limits=limits,
            )
        )
    return wanted


def _is_set(entry: Difference, *, with_limits: bool) -> bool:
    return entry.kind == "mechanics" or (entry.kind == "limits" and with_limits)
