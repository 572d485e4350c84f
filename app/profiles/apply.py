"""A profile into a device as one transaction: all of it, or as it was before, or told exactly what is left.

The motor stands, and is kept from having anywhere to go. All writes are known and checked before the first. Each
register is read again right before it is written (it has to hold what the comparison saw: then nobody else writes here,
and no flipped bit of a reading decides what the rollback would write), read back after it, and at the end everything
is read once more. The first thing that goes wrong ends it, and what was written is written back in reverse order.
Nothing is tried a second time but readings.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent, MotionCommanded, motion_owner
from ..devices.core.results import AxisState
from ..errors import SoftLimit, WriteRefused, WrongState
from .capture import CapturedConfiguration, read_held, read_item
from .diff import UNIT_MODE, Diff, difference_of, require_fit
from .document import ProfileDocument
from .errors import Change, ProfileLeft, ProfileTakenBack
from .items import Key
from .preconditions import hold_still, require_rest
from .program import NAME as PROGRAM
from .program import ProgramStep, restore, step_of, store
from .register_bits import RegisterBits, bits_of
from .rollback import WayBack
from .steps import Step, steps_between
from .writing import Progress, change_of, told_of, unexpected, write_item


class Journal(Protocol):
    """What outlives a crash of this process in the middle of it."""

    async def begin(self, steps: Sequence[Step], program: ProgramStep | None = None) -> None:
        """A program will be stored, and then these written, in this order: on disk when this returns."""
        ...

    def reached(self, index: int) -> None:
        """Step `index` is about to be written."""
        ...

    async def end(self, left: Sequence[Change]) -> None:
        """It is over; `left` is not as it was."""
        ...


@dataclass(frozen=True, slots=True)
class Applied:
    """A profile is in the device. `written` says what changed, `prepared` what was done so that nothing moves.

    stored : how many commands its program has, where it was stored; else None
    """

    diff: Diff
    written: list[Change]
    prepared: list[str]
    stored: int | None = None


class _Failed(Exception):
    """Something went wrong on the way; `step` is None where it belongs to no single one."""

    def __init__(
        self, error: Exception, step: Step | None, index: int, *, sent: bool, program: ProgramStep | None = None
    ) -> None:
        super().__init__(str(error))
        self.error, self.step, self.index, self.sent, self.program = error, step, index, sent, program


@dataclass(slots=True)
class Transaction:
    """One profile into one device, once."""

    device: Device
    document: ProfileDocument
    progress: Progress = field(default_factory=Progress)
    journal: Journal | None = None
    encoders: Mapping[int, str] = field(default_factory=dict)
    """By axis: the counter of an encoder that is set to the position before the encoder's own settings change."""
    _disturbed: str = ""
    _program: ProgramStep | None = None
    _now: dict[Key, int] = field(default_factory=dict)
    """What was read back of the registers that are written; a module may hold a number that is a little off."""

    async def run(self) -> Applied:
        """Apply it.

        Raises ProfileMisfit, UnreadableProfile, WrongState (the motor moves) and SoftLimit before anything is written;
        ProfileTakenBack or ProfileLeft afterwards; BenchError where the device cannot be read to begin with.
        """
        device = self.device
        device.session.require_connected()
        require_fit(device, self.document)
        wants = bits_of(self.document)
        states = await require_rest(device)
        self._program = await step_of(device, self.document)
        held = await read_held(device, wants)
        difference = difference_of(device, held, self.document, wants, self._program)
        keys = _keys(difference, wants)
        steps = steps_between(held, wants, keys)
        if not steps and self._program is None:
            self.progress.phase = "over"
            return Applied(difference, [], [])
        await device.registers.check_writes([step.write() for step in steps])
        self.progress.total = len(steps)
        owner = motion_owner.set(self)
        unlisten = device.listen(self._heard)
        try:
            prepared = await hold_still(device, states, steps)
            prepared += await self._align(states, steps)
            written = await self._all(held, steps, prepared)
        finally:
            unlisten()
            motion_owner.reset(owner)
            self.progress.phase = "over"
        stored = None if self._program is None else len(self._program.wanted)
        return Applied(difference, written, prepared, stored)

    async def _align(self, states: Mapping[int, AxisState], steps: Sequence[Step]) -> list[str]:
        told = []
        for axis, counter in self.encoders.items():
            resolved = any(step.register.group == "encoder" and step.register.axis == axis for step in steps)
            if resolved and (await self.device.registers.read(counter, axis)).value != states[axis].position:
                await self.device.registers.write(counter, axis, states[axis].position)
                told.append(f"axis {axis}: {counter} shows the position, {states[axis].position}")
        return told

    def _heard(self, event: DeviceEvent) -> None:
        if isinstance(event, MotionCommanded) and event.by is not self:
            self._disturbed = f"axis {event.axis} was commanded by another client ({event.what})"

    # --- the way there ----------------------------------------------------------------------------

    async def _all(self, held: CapturedConfiguration, steps: Sequence[Step], prepared: list[str]) -> list[Change]:
        if self.journal is not None:
            await self.journal.begin(steps, self._program)
        try:
            if self._program is not None:
                await self._store(self._program)
            await self._forward(held, steps)
        except SoftLimit:  # of a command of the program: nothing was sent
            if self.journal is not None:
                await self.journal.end([])
            raise
        except _Failed as failure:
            reached = steps[: failure.index + failure.sent]
            back = WayBack(self.device, reached, failure.step if failure.sent else None, self._now, self.progress)
            left = await back.run(held)
            if self._program is not None:
                self.progress.place = PROGRAM
                left += [kept for kept in [await restore(self.device, self._program)] if kept is not None]
            if self.journal is not None:
                await self.journal.end(left)
            raise self._told(failure, steps, prepared, left, back.unchecked) from failure.error
        if self.journal is not None:
            await self.journal.end([])
        return [change_of(step, self._now[step.item.key]) for step in steps]

    async def _store(self, step: ProgramStep) -> None:
        """The program first: while it is stored nothing can be read, and what it may not do is told before it begins.

        Raises SoftLimit for a command that may not be, before anything is sent; _Failed.
        """
        self.progress.phase, self.progress.place = "writing", PROGRAM
        try:
            self._require_undisturbed()
            await store(self.device, len(step.was), step.wanted)
        except SoftLimit:
            raise
        except Exception as error:
            raise _Failed(told_of(error, None), None, 0, sent=False, program=step) from error

    async def _forward(self, held: CapturedConfiguration, steps: Sequence[Step]) -> None:
        """Write all of it. Raises _Failed."""
        self.progress.phase = "writing"
        for index, step in enumerate(steps):
            self.progress.done, self.progress.place = index, step.place
            sent = False
            try:
                self._require_undisturbed()
                await self._still_as_it_was(step)
                if self.journal is not None:
                    self.journal.reached(index)
                sent = True
                word = await write_item(self.device, step.item, step.write(), step.word, step.mask)
                self._now[step.item.key] = word
            except Exception as error:
                raise _Failed(told_of(error, step), step, index, sent=sent) from error
        self.progress.done, self.progress.phase, self.progress.place = len(steps), "checking", ""
        try:
            await self._check(held, steps)
        except Exception as error:
            raise _Failed(told_of(error, None), None, len(steps), sent=False) from error

    def _require_undisturbed(self) -> None:
        if self._disturbed:
            raise WrongState(self._disturbed, "leave the axis alone until the profile is applied")

    async def _still_as_it_was(self, step: Step) -> None:
        if not step.steady:
            return
        now = await read_item(self.device, step.item)
        if now is None or step.was is None or not (now ^ step.was) & step.item.mask:
            return
        row = step.register
        raise WrongState(
            f"{step.place} holds {row.decode(now)} and held {row.decode(step.was)} a moment ago",
            "another client writes here, or the line flips bits",
        )

    async def _check(self, held: CapturedConfiguration, steps: Sequence[Step]) -> None:
        """Whether all is as it should be: what was written, and what was not."""
        expected = {**held.words, **self._now}
        restated = any(not step.steady or step.item.key == UNIT_MODE for step in steps)
        after = await read_held(self.device, held.words)
        for item, was, is_ in await unexpected(self.device, expected, after):
            if restated and item.row.internal_range is not None:
                continue  # the module shows it in other units now
            raise WriteRefused(item.row.name, was, is_, "it changed while other registers were written")

    def _told(
        self, failure: _Failed, steps: Sequence[Step], prepared: list[str], left: list[Change], unchecked: str
    ) -> ProfileTakenBack:
        step, program = failure.step, failure.program
        failed = (
            (Change("", None, None, None, None, 0, "") if program is None else program.change(None))
            if step is None
            else Change(
                step.register.name,
                step.register.axis,
                step.item.table,
                None if step.was is None else step.register.decode(step.was),
                None,
                step.value,
            )
        )
        failed = replace(failed, why=str(failure.error))
        where = PROGRAM if program is not None else step.place if step is not None else "the check of all registers"
        done, of = failure.index, len(steps)
        text = f"{where} failed after {done} of {of} writes: {failure.error}"
        if unchecked:
            text = f"{text}; {unchecked}"
        if not left:
            back = "all that was written is as it was before" if unchecked else "all is as it was before"
            return ProfileTakenBack(f"not applied, {back}: {text}", failed, done, of, prepared)
        names = ", ".join(place for place in (_place(change) for change in left[:4])) + ", ..." * (len(left) > 4)
        return ProfileLeft(
            f"not applied, and {len(left)} registers are not as they were ({names}): {text}",
            failed,
            done,
            of,
            prepared,
            left,
        )


def _keys(difference: Diff, wants: Mapping[Key, RegisterBits]) -> list[Key]:
    differing = {(entry.name, entry.axis) for entry in difference.differences if entry.kind not in SETTINGS}
    return [key for key, want in wants.items() if (want.item.row.name, want.item.row.axis) in differing]


SETTINGS = frozenset({"mechanics", "limits", "clock"})


def _place(change: Change) -> str:
    return change.name if change.axis is None else f"{change.name} of axis {change.axis}"
