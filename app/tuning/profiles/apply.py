"""A profile into a device as one transaction: all of it, or as it was before, or told exactly what is left.

The motor stands, and is kept from having anywhere to go. All writes are known and checked before the first. Each
register is read again right before it is written (it has to hold what the comparison saw: then nobody else writes here,
and no flipped bit of a reading decides what the way back would write), read back after it, and at the end everything
is read once more. The first thing that goes wrong ends it, and what was written is written back in reverse order.
Nothing is tried a second time but readings.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol

from app.devices.device import Device, DeviceEvent, MotionCommanded, motion_owner
from app.devices.results import WriteItem
from app.links.errors import BenchError, LinkDown, LinkTimeout, WriteRefused, WrongState
from app.registers.model import to_raw
from app.tuning.profiles.capture import Held, as_configured, read_held, read_item
from app.tuning.profiles.diff import Diff, difference_of, require_fit
from app.tuning.profiles.document import ProfileDocument
from app.tuning.profiles.errors import Change, ProfileLeft, ProfileTakenBack
from app.tuning.profiles.items import Item, items_by_key
from app.tuning.profiles.standing import hold_still, require_rest
from app.tuning.profiles.steps import Step, steps_between
from app.tuning.profiles.words import Key, Want, wants_of

log = logging.getLogger("stepscope.profiles")

SILENT = 2
"""So many writes in a row without an answer, and the way back gives the link up: each costs a timeout."""

Phase = Literal["comparing", "writing", "checking", "way back", "over"]


@dataclass(slots=True)
class Progress:
    """How far it is. Written by the transaction, looked at by whoever asks."""

    phase: Phase = "comparing"
    done: int = 0
    total: int = 0
    place: str = ""


class Journal(Protocol):
    """What outlives a crash of this process in the middle of it."""

    async def begin(self, steps: Sequence[Step]) -> None:
        """These will be written, in this order: on disk when this returns."""
        ...

    def reached(self, index: int) -> None:
        """Step `index` is about to be written."""
        ...

    async def end(self, left: Sequence[Change]) -> None:
        """It is over; `left` is not as it was."""
        ...


@dataclass(frozen=True, slots=True)
class Applied:
    """A profile is in the device. `written` says what changed, `prepared` what was done so that nothing moves."""

    diff: Diff
    written: list[Change]
    prepared: list[str]


class _Failed(Exception):
    """Something went wrong on the way; `step` is None where it belongs to no single one."""

    def __init__(self, error: Exception, step: Step | None, index: int, *, sent: bool) -> None:
        super().__init__(str(error))
        self.error, self.step, self.index, self.sent = error, step, index, sent


@dataclass(slots=True)
class Transaction:
    """One profile into one device, once."""

    device: Device
    document: ProfileDocument
    progress: Progress = field(default_factory=Progress)
    journal: Journal | None = None
    _disturbed: str = ""
    _now: dict[Key, int] = field(default_factory=dict)
    """What was read back of the registers that are written; a module may hold a number that is a little off."""

    async def run(self) -> Applied:
        """Apply it.

        Raises ProfileMisfit, UnreadableProfile, WrongState (the motor moves) and SoftLimit before anything is written;
        ProfileTakenBack or ProfileLeft afterwards; BenchError where the device cannot be read to begin with.
        """
        device = self.device
        device.require_connected()
        require_fit(device, self.document)
        wants = wants_of(self.document)
        states = await require_rest(device)
        held = await read_held(device)
        difference = difference_of(device, held, self.document, wants)
        keys = _keys(difference, wants)
        steps = steps_between(held, wants, keys)
        if not steps:
            self.progress.phase = "over"
            return Applied(difference, [], [])
        await device.check_writes([step.write() for step in steps])
        self.progress.total = len(steps)
        owner = motion_owner.set(self)
        unlisten = device.listen(self._heard)
        try:
            prepared = await hold_still(device, states, steps)
            written = await self._all(held, steps, prepared)
        finally:
            unlisten()
            motion_owner.reset(owner)
            self.progress.phase = "over"
        return Applied(difference, written, prepared)

    def _heard(self, event: DeviceEvent) -> None:
        if isinstance(event, MotionCommanded) and event.by is not self:
            self._disturbed = f"axis {event.axis} was commanded by somebody else ({event.what})"

    # --- the way there ----------------------------------------------------------------------------

    async def _all(self, held: Held, steps: Sequence[Step], prepared: list[str]) -> list[Change]:
        if self.journal is not None:
            await self.journal.begin(steps)
        try:
            await self._forward(held, steps)
        except _Failed as failure:
            reached = steps[: failure.index + failure.sent]
            back = _WayBack(self.device, reached, failure.step if failure.sent else None, self._now, self.progress)
            left = await back.run(held)
            if self.journal is not None:
                await self.journal.end(left)
            raise self._told(failure, steps, prepared, left, back.unchecked) from failure.error
        if self.journal is not None:
            await self.journal.end([])
        return [change_of(step, self._now[step.item.key]) for step in steps]

    async def _forward(self, held: Held, steps: Sequence[Step]) -> None:
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
                raise _Failed(_told_of(error, step), step, index, sent=sent) from error
        self.progress.done, self.progress.phase, self.progress.place = len(steps), "checking", ""
        try:
            await self._check(held, steps)
        except Exception as error:
            raise _Failed(_told_of(error, None), None, len(steps), sent=False) from error

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
            "somebody else writes here, or the line flips bits",
        )

    async def _check(self, held: Held, steps: Sequence[Step]) -> None:
        """Whether all is as it should be: what was written, and what was not."""
        expected = {**held.words, **self._now}
        restated = any(not step.steady for step in steps)
        after = await read_held(self.device)
        for item, was, is_ in await unexpected(self.device, expected, after):
            if restated and item.row.internal_range is not None:
                continue  # the module shows it in other units now
            raise WriteRefused(item.row.name, was, is_, "it changed while other registers were written")

    def _told(
        self, failure: _Failed, steps: Sequence[Step], prepared: list[str], left: list[Change], unchecked: str
    ) -> ProfileTakenBack:
        step = failure.step
        failed = (
            Change("", None, None, None, None, 0, str(failure.error))
            if step is None
            else Change(
                step.register.name,
                step.register.axis,
                step.item.table,
                None if step.was is None else step.register.decode(step.was),
                None,
                step.value,
                str(failure.error),
            )
        )
        where = step.place if step is not None else "the check of all registers"
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


# --- the way back -----------------------------------------------------------------------------------


class _WayBack:
    """What was written goes back, the latest first; what does not is told."""

    def __init__(
        self,
        device: Device,
        steps: Sequence[Step],
        uncertain: Step | None,
        now: Mapping[Key, int],
        progress: Progress | None = None,
    ) -> None:
        self._device = device
        self._steps = list(reversed(steps))
        # In which units a module counts goes back first: what was read before was read in them.
        self._steps.sort(key=lambda step: step.register.name != "unit_mode")
        self._uncertain = uncertain
        self._now = now
        self._progress = progress or Progress()
        self._silent = 0
        self._down = False
        self.unchecked = ""
        """Why it was not looked at everything again in the end; "" where it was."""

    async def run(self, before: Held | None) -> list[Change]:
        """Write all of it back; what is not as it was then. With `before` all else is looked at too. Never raises."""
        self._progress.phase, self._progress.done, self._progress.total = "way back", 0, len(self._steps)
        left: dict[Key, Change] = {}
        for index, step in enumerate(self._steps):
            self._progress.done, self._progress.place = index, step.place
            change = await self._one(step)
            # Of a register that is written twice the last word counts.
            left.pop(step.item.key, None)
            if change is not None:
                left[step.item.key] = change
        if self._down:
            self.unchecked = "the link is gone, so nothing else was looked at"
        elif before is not None:
            await self._look_over(before, left)
        return list(left.values())

    async def _one(self, step: Step) -> Change | None:
        is_ = None if step is self._uncertain else self._now.get(step.item.key, step.word)
        if self._down:
            # Of numbers whose unit has changed only 0 is what it was.
            same = is_ is not None and step.was == is_ and (step.steady or is_ == 0)
            return None if same else change_of(step, is_, "the link is gone, so it was not written back")
        back = step.way_back()
        try:
            if step.register.access.readable:
                is_ = await read_item(self._device, step.item)
                if is_ is not None and step.was is not None and not (is_ ^ step.was) & step.item.mask:
                    self._silent = 0
                    return None  # it never took the write: nothing to do
            if back is None or step.was is None:
                return change_of(step, is_, "it cannot be read, and nobody knew what it held before")
            is_ = None  # from here on either
            await write_item(self._device, step.item, back, step.was, step.mask)
        except Exception as error:
            self._gone(error)
            if isinstance(error, WriteRefused):
                is_ = as_configured(self._device, step.item, error.read_back)
            elif is_ is None and step.register.access.readable and not self._down:
                is_ = await self._look(step.item)
            if is_ is not None and step.was is not None and not (is_ ^ step.was) & step.item.mask:
                return None
            return change_of(step, is_, str(_told_of(error, step)))
        self._silent = 0
        return None

    def _gone(self, error: Exception) -> None:
        if isinstance(error, LinkTimeout):
            self._silent += 1
        self._down = isinstance(error, LinkDown) or self._silent >= SILENT

    async def _look(self, item: Item) -> int | None:
        try:
            return await read_item(self._device, item)
        except BenchError as error:
            self._gone(error)
            return None

    async def _look_over(self, before: Held, left: dict[Key, Change]) -> None:
        """Whether everything else is as before too: on a line without checksums a write may have gone astray."""
        try:
            after = await read_held(self._device)
            astray = await unexpected(self._device, before.words, after)
        except BenchError as error:
            self.unchecked = f"whether all else is as before could not be read: {error}"
            log.warning("%s: %s", self._device.name, self.unchecked)
            return
        for item, was, is_ in astray:
            if item.key in left:
                continue
            step = Step(item, is_, item.mask, was)
            change = await self._one(step)
            if change is not None:
                left[item.key] = change


async def way_back(device: Device, steps: Sequence[Step], progress: Progress | None = None) -> list[Change]:
    """Bring back what an earlier transaction has left; what is still not as it was. The motor has to stand.

    Raises WrongState where it moves, BenchError.
    """
    states = await require_rest(device)
    await hold_still(device, states, list(steps))
    return await _WayBack(device, steps, None, {}, progress).run(None)


# --- one register -----------------------------------------------------------------------------------


async def write_item(device: Device, item: Item, write: WriteItem, word: int, mask: int) -> int:
    """Write a register once and see to it that it is there; the word that it holds.

    Raises WriteRefused where it is not, and what the driver raises.
    """
    done = await device.write(write.name, write.axis, write.value, write.fields)
    if not item.row.access.readable:
        return word  # the driver raises where the link shows that it did not arrive
    now = as_configured(device, item, done.raw)
    if (now ^ word) & mask and done.verified is not True:
        raise WriteRefused(item.row.name, word, now, done.note or "it holds something else than was written")
    return now


async def unexpected(device: Device, expected: Mapping[Key, int | None], after: Held) -> list[tuple[Item, int, int]]:
    """Registers that hold something else than expected, each looked at twice: what was expected, and what is."""
    found = []
    for key, item in items_by_key(after.model).items():
        was, is_ = expected.get(key), after.words.get(key)
        if was is None or is_ is None or not (was ^ is_) & item.mask:
            continue
        again = await read_item(device, item)
        if again is not None and (was ^ again) & item.mask:
            found.append((item, was, again))
    return found


def change_of(step: Step, now: int | None, why: str = "") -> Change:
    """A step as it is told."""
    decode = step.register.decode
    return Change(
        step.register.name,
        step.register.axis,
        step.item.table,
        None if step.was is None else decode(step.was),
        None if now is None else decode(now),
        step.value,
        why,
    )


def restored(document_model: str, change: Change) -> Step | None:
    """The step that a told change was, to go back on it; None where the model has no such register any more."""
    for item in items_by_key(document_model).values():
        if (item.row.name, item.row.axis) == (change.name, change.axis):
            was = None if change.was is None else to_raw(change.was, item.row.width) & item.mask
            return Step(item, to_raw(change.wanted, item.row.width) & item.mask, item.mask, was)
    return None


def _keys(difference: Diff, wants: Mapping[Key, Want]) -> list[Key]:
    differing = {(entry.name, entry.axis) for entry in difference.differences if entry.kind not in SETTINGS}
    return [key for key, want in wants.items() if (want.item.row.name, want.item.row.axis) in differing]


SETTINGS = frozenset({"mechanics", "limits", "clock"})


def _place(change: Change) -> str:
    return change.name if change.axis is None else f"{change.name} of axis {change.axis}"


def _told_of(error: Exception, step: Step | None) -> Exception:
    if not isinstance(error, BenchError):
        log.exception("writing %s failed by a mistake of ours", step.place if step is not None else "a profile")
    return error
