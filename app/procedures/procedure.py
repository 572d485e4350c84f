"""What all procedures share: one task, one axis, and the rule that anybody else's command ends it."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Literal

from ..clock import Clock
from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent, MotionCommanded, motion_owner
from ..devices.limits.watch import RangeWatch
from ..errors import BenchError

log = logging.getLogger("stepscope.tuning")

Ended = Literal["done", "failed", "aborted"]
State = Literal["idle", "running"] | Ended
POLL_S = 0.01
"""How often a procedure looks at its axis [s]; what has to be exact, the chip latches."""


class Failed(Exception):
    """The procedure cannot reach its aim; the text is for people."""


class Procedure(ABC):
    """Moves one axis until done, failed or aborted. A stop or any other command to the axis aborts it."""

    kind: str

    def __init__(self, device: Device, axis: int, clock: Clock) -> None:
        self.device = device
        self.axis = device.axis(axis).index
        self.clock = clock
        self.message = ""
        self._how: State = "running"
        self._task: asyncio.Task[None] | None = None
        self._unlisten: Callable[[], None] | None = None
        self._taken_over = ""
        self._taken_axis = self.axis
        self._ending = False
        """Whether it comes to its end: that takes its way, whatever is commanded meanwhile."""

    @property
    def running(self) -> bool:
        return self._task is not None and not self._task.done()

    def start(self) -> None:
        """Begin. Once only."""
        self._unlisten = self.device.listen(self._heard)
        self._task = asyncio.create_task(self._main(), name=f"{self.kind} {self.device.id}.{self.axis}")

    async def abort(self, why: str) -> None:
        """End it and stop the motor by its ramp; returns when that is done. Does nothing when it is over."""
        if self.running and self._task is not None and not self._ending:
            self._ending = True
            self.message = why
            self._task.cancel()
        await self.wait()

    async def wait(self) -> None:
        """Return when it is over."""
        if self._task is not None:
            with contextlib.suppress(asyncio.CancelledError):
                await asyncio.shield(self._task)

    async def over_within(self, seconds: float) -> bool:
        """Return whether it is over, as soon as it is; False when `seconds` [s] have passed and it is not."""
        if self._task is not None:
            late = asyncio.create_task(self.clock.sleep(seconds), name=f"waits for a {self.kind}")
            try:
                await asyncio.wait({self._task, late}, return_when=asyncio.FIRST_COMPLETED)
            finally:
                late.cancel()
        return not self.running

    def is_own(self, by: object) -> bool:
        """Whether who commands is this procedure, or a part of it."""
        return by is self

    def concerns(self, axis: int) -> bool:
        """Whether a command to `axis` that is not its own ends it."""
        return axis == self.axis

    def _heard(self, event: DeviceEvent) -> None:
        if (
            isinstance(event, MotionCommanded)
            and self.concerns(event.axis)
            and not self.is_own(event.by)
            and self.running
            and not self._ending
        ):
            self._ending = True
            self._taken_over, self._taken_axis = event.what, event.axis
            # The watch over soft limits says why; of others only what they have sent is known.
            why = event.by.why if isinstance(event.by, RangeWatch) else ""
            self.message = f"ended: {why}" if why else f"ended by another command to this axis: {event.what}"
            assert self._task is not None
            self._task.cancel()

    async def _main(self) -> None:
        motion_owner.set(self)
        try:
            await self._run()
            self._ending = True
        except asyncio.CancelledError:
            # Whoever took over has the motor now; else nobody has.
            await self._end_as("aborted", stops=not self._taken_over)
        except (Failed, BenchError) as error:
            self.message = str(error)
            await self._end_as("failed")
        except Exception as error:  # a mistake of ours must not leave a motor running
            log.exception("%s failed", self.kind)
            self.message = f"failed by a mistake in stepscope: {error!r}"
            await self._end_as("failed")
        else:
            self._over("done")
        finally:
            # Whatever ended it: settings that it only borrowed go back, as far as the link allows.
            try:
                await self._give_back()
            except BenchError:
                pass
            except Exception:  # a mistake of ours: nobody else would tell of it
                log.exception("%s has not given back what it borrowed", self.kind)
            finally:
                if self._unlisten is not None:
                    self._unlisten()

    async def _end_as(self, how: Ended, *, stops: bool = True) -> None:
        """Stop the motor, and tell how it ended, also where this is cut off."""
        self._ending = True
        try:
            if stops:
                await self._stop()
        finally:
            self._over(how)

    async def _stop(self) -> None:
        with contextlib.suppress(BenchError):
            await self.device.stop(self.axis)

    @abstractmethod
    async def _run(self) -> None:
        """The procedure itself. Raises Failed or BenchError."""

    def _over(self, how: Ended) -> None:
        """It ended."""
        self._how = how

    @abstractmethod
    async def _give_back(self) -> None:
        """Undo changes of settings. Raises BenchError."""
