"""The rollback: what a transaction has written goes back, the latest first, and what does not is told."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence

from ..devices.core.device import Device
from ..errors import BenchError, LinkDown, LinkTimeout, WriteRefused
from .capture import CapturedConfiguration, as_configured, read_held, read_item
from .errors import Change
from .items import Item, Key
from .preconditions import hold_still, require_rest
from .steps import Step
from .writing import Progress, change_of, told_of, unexpected, write_item

log = logging.getLogger("stepscope.profiles")

SILENT = 2
"""So many writes in a row without an answer, and the rollback gives the link up: each costs a timeout."""


class WayBack:
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

    async def run(self, before: CapturedConfiguration | None) -> list[Change]:
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
            await self._check_others(before, left)
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
                is_ = await self._read(step.item)
            if is_ is not None and step.was is not None and not (is_ ^ step.was) & step.item.mask:
                return None
            return change_of(step, is_, str(told_of(error, step)))
        self._silent = 0
        return None

    def _gone(self, error: Exception) -> None:
        if isinstance(error, LinkTimeout):
            self._silent += 1
        self._down = isinstance(error, LinkDown) or self._silent >= SILENT

    async def _read(self, item: Item) -> int | None:
        try:
            return await read_item(self._device, item)
        except BenchError as error:
            self._gone(error)
            return None

    async def _check_others(self, before: CapturedConfiguration, left: dict[Key, Change]) -> None:
        """Whether everything else is as before too: on a line without checksums a write may have gone astray."""
        try:
            after = await read_held(self._device, before.words)
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
    return await WayBack(device, steps, None, {}, progress).run(None)
