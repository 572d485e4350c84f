"""A study that runs: a procedure on one axis whose settings go back to what they were, however it ends."""

from __future__ import annotations

import asyncio
import logging
import time
from abc import abstractmethod
from collections.abc import Awaitable, Callable, Sequence
from pathlib import Path
from typing import Protocol, TypeVar

from ..aside import NotWorkedOut, worked_out
from ..clock import Clock
from ..devices.core.actor import actor
from ..devices.core.device import Device
from ..errors import BenchError
from ..procedures.procedure import Ended, Failed, Procedure
from ..profiles.apply import Transaction
from .driver_faults import DriverFault
from .moves import MeasuredMoves
from .own_motion import StopWhenBack
from .plan import Looked
from .ramp_settings import document_of
from .record import Held, Phase, StudyRecord
from .twins.executor import Executor, no_executor

MAY_TURN = "the motor may still turn: stop it as soon as the device is there again"
T = TypeVar("T")
log = logging.getLogger("stepscope.studies")

REST_WITHIN_S = 10.0
"""How long a motor may take to come to rest before its settings go back [s]."""
POLL_S = 0.02
TELLS_FROM = 0.03
"""So much progress tells how fast a study gets on: less is its first move or two."""
WORKS_WITHIN_S = 300.0
"""The longest fits take 10 s of an idle processor [s]."""


class Ground(Protocol):
    """What a study stands on."""

    @property
    def start(self) -> int:
        """Where it begins [microsteps]."""
        ...


G = TypeVar("G", bound=Ground)
W = TypeVar("W")


class Keeper(Protocol):
    """Where a study leaves what came of it."""

    @property
    def folder(self) -> Path:
        """Of this study alone."""
        ...

    async def save(self, record: StudyRecord) -> None:
        """On disk when this returns. Raises StoreUnavailable where the disk takes nothing."""
        ...

    def mark(self, text: str) -> None:
        """Say in its recording what begins now."""
        ...


class StudyRun(Procedure):
    """One study of one axis. Everything that it is and found stands in `record`."""

    kind = "study"

    def __init__(self, device: Device, axis: int, clock: Clock, record: StudyRecord, keeper: Keeper) -> None:
        super().__init__(device, axis, clock)
        self.record = record
        self.keeper = keeper
        self._began_s = clock.now() - record.ran_s
        self.planned_s: float | None = None
        """What its plan takes it to last [s]; None: nobody has planned it."""
        self._from: tuple[float, float] | None = None
        """When its first phase began, and at which progress: one that is gone on with begins where it was."""
        self._setting: Transaction | None = None
        self._stop_when_back: StopWhenBack | None = None
        self._touched = False
        """Whether registers may be other than before."""
        self.executor: Callable[[], Executor] = no_executor
        """Makes what runs twins of the axis, for one search."""
        self.over: Callable[[], None] = lambda: None
        """Called when all is as it will stay."""
        record.by = record.by or actor.get().name

    # --- what it is made of ---------------------------------------------------------------------

    @property
    def since_s(self) -> float:
        """How long it has run, with what came before it was gone on with [s]."""
        return self.clock.now() - self._began_s

    def spent(self, share: float = 1.0) -> bool:
        """Whether a share of the time or the way that it may cost is used up."""
        budget, record = self.record.document.budget, self.record
        far = budget.distance_fullsteps is not None and record.way_fullsteps > share * budget.distance_fullsteps
        return far or self.since_s > share * budget.time_s

    def ran(self, moves: MeasuredMoves) -> None:
        """A run more is over: the record tells it, and the way of all `moves`."""
        self.record.runs, self.record.way_fullsteps = self.record.runs + 1, moves.way_fullsteps

    def tell(self, phase: Phase, progress: float, message: str, left_s: float | None = None) -> None:
        """How far it is, for whoever looks. left_s : how long it takes yet [s]; None: as its progress and plan tell"""
        record = self.record
        record.ran_s = self.since_s
        record.phase, record.progress, record.message = phase, min(1.0, progress), message
        if phase != "preconditions" and (self._from is None or record.progress < self._from[1]):
            self._from = self.clock.now(), record.progress
        record.left_s = self._about_left_s() if left_s is None else left_s

    def _about_left_s(self) -> float | None:
        """How long it takes yet, by how fast it got on so far, or by its plan [s]; None where neither tells."""
        budget_s = max(0.0, self.record.document.budget.time_s - self.since_s)
        passed_s, since = (0.0, 0.0) if self._from is None else (self.clock.now() - self._from[0], self._from[1])
        gone = self.record.progress - since
        if gone >= TELLS_FROM and passed_s > 0:
            return min(budget_s, passed_s / gone * (1 - self.record.progress))
        planned_s = None if self.planned_s is None else self.planned_s * (1 - since) - passed_s
        return None if planned_s is None or planned_s <= 0 else min(budget_s, planned_s)

    async def apply(self, registers: Sequence[Held], what: str) -> None:
        """Set registers as one transaction: all of them, or as before. Raises BenchError.

        What is under way comes to its end although the study is stopped meanwhile: the motor stands.
        """
        self._touched = True
        self._setting = transaction = Transaction(self.device, document_of(self.device, registers, what))
        task = asyncio.create_task(transaction.run(), name=f"{what} {self.device.id}")
        try:
            await asyncio.shield(task)
        except asyncio.CancelledError:
            await asyncio.wait({task})
            if not task.cancelled():
                task.exception()  # heard: what it has left goes back next
            raise

    async def aside(self, work: Callable[..., T], *arguments: object) -> T:
        """What takes a processor for long, beside the server's loop: stops get through meanwhile.

        work, arguments : can be pickled. Raises Failed where it does not come to an end, and what `work` raises.
        """
        try:
            return await worked_out(self.clock, work, *arguments, within_s=WORKS_WITHIN_S)
        except NotWorkedOut as error:
            raise Failed(f"what was measured could not be worked out: {error}") from error

    async def looked(self, look: Callable[[Device, int, W], Awaitable[Looked[G]]], wanted: W) -> G:
        """What a study that goes on finds where it began: it goes back there first, and looks once more.

        Raises WrongState where anything is missing, and what `look` and `returned` do.
        """
        self.tell("preconditions", 0.0, "looking at the axis")
        ground = (await look(self.device, self.axis, wanted)).required()
        if await self.returned(ground.start):
            ground = (await look(self.device, self.axis, wanted)).required()
        return ground

    async def returned(self, position: int) -> bool:
        """Go back to where the study began, where it was cut off elsewhere: so it stays within what its plan told.

        position : where it stands, at rest [microsteps]. False where it is there, or begins only now.
        Raises BenchError, Failed where the motor does not arrive.
        """
        record, microsteps = self.record, self.device.axis(self.axis).microsteps
        if record.start is None or record.start == position or microsteps is None:
            record.start = position
            return False
        self.tell("preconditions", 0.0, "back to where it began")
        moves = MeasuredMoves(self.device, self.axis, self.clock, microsteps[0], 1.0, has_encoder=False)
        await moves.go(record.start)
        record.way_fullsteps += moves.way_fullsteps
        return True

    async def back(self) -> None:
        """Set the axis as it was before the study. Raises BenchError."""
        if self.record.baseline:
            await self.apply(self.record.baseline, "the setting before the study")
        self._touched = False

    def is_own(self, by: object) -> bool:
        return super().is_own(by) or (by is not None and by is self._setting)

    # --- its end --------------------------------------------------------------------------------

    @abstractmethod
    async def _study(self) -> None:
        """The study itself. Raises Failed or BenchError."""

    async def _run(self) -> None:
        try:
            await self._study()
        except DriverFault as error:
            raise Failed(str(error)) from error

    def _over(self, how: Ended) -> None:
        self._how = how

    async def _give_back(self) -> None:
        record = self.record
        try:
            if self._touched:
                await self._rest()
                await self.back()
            record.left = []
        except (BenchError, Failed) as error:
            record.left = await self._left(error)
        except asyncio.CancelledError:
            record.left = ["it was cut off before its setting was back", self._look_at()]
            raise
        finally:
            assert self._how in ("done", "failed", "aborted")
            record.state = self._how
            record.message = self.message or ("" if self._how == "done" else record.message)
            record.phase, record.left_s, record.ran_s = "over", None, self.since_s
            if self._how == "done":
                record.progress = 1.0
            record.ended_unix_s = time.time()
            try:
                await self.keeper.save(record)
            except BenchError as error:
                log.warning("study %s is not on disk: %s", record.id, error)
            finally:
                self.over()

    async def _rest(self) -> None:
        until_s = self.clock.now() + REST_WITHIN_S
        while (await self.device.monitor.axis_state(self.axis)).moving:
            if self.clock.now() > until_s:
                raise Failed(f"the motor still moves after {REST_WITHIN_S:g} s")
            await self.clock.sleep(POLL_S)

    async def _stopped_late(self) -> None:
        """The device was there again, and what this study had begun was stopped."""
        record = self.record
        record.left = [line for line in record.left if line != MAY_TURN]
        record.message = f"{record.message}; the motor still turned as the device was there again, and was stopped"
        await self.keeper.save(record)

    def _look_at(self) -> str:
        return f"look at {', '.join(self.record.before_told())}"

    async def _left(self, error: Exception) -> list[str]:
        """What is not as before, as far as it can be told."""
        told = [f"the setting could not be put back: {error}", self._look_at()]
        try:
            moving = (await self.device.monitor.axis_state(self.axis)).moving
        except BenchError:
            self._stop_when_back = StopWhenBack(self.device, self.axis, self.is_own, self._stopped_late)
            return [*told, MAY_TURN]
        return [*told, "the motor still turns: stop it"] if moving else told
