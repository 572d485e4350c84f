"""One register of a profile: written once and looked at, and how it is told."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from ..devices.core.device import Device
from ..devices.core.results import WriteItem
from ..errors import BenchError, WriteRefused
from ..registers.model import to_raw
from .capture import CapturedConfiguration, as_configured, read_item
from .errors import Change
from .items import Item, Key, items_by_key
from .steps import Step

log = logging.getLogger("stepscope.profiles")

Phase = Literal["comparing", "writing", "checking", "way back", "over"]


@dataclass(slots=True)
class Progress:
    """How far it is. Written by the transaction, looked at by whoever asks."""

    phase: Phase = "comparing"
    done: int = 0
    total: int = 0
    place: str = ""


async def write_item(device: Device, item: Item, write: WriteItem, word: int, mask: int) -> int:
    """Write a register once and see to it that it is there; the word that it holds.

    Raises WriteRefused where it is not, and what the driver raises.
    """
    done = await device.registers.write(write.name, write.axis, write.value, write.fields)
    if not item.row.access.readable:
        return word  # the driver raises where the link shows that it did not arrive
    now = as_configured(device, item, done.raw)
    if (now ^ word) & mask and done.verified is not True:
        raise WriteRefused(item.row.name, word, now, done.note or "it holds something else than was written")
    return now


async def unexpected(
    device: Device, expected: Mapping[Key, int | None], after: CapturedConfiguration
) -> list[tuple[Item, int, int]]:
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


def told_of(error: Exception, step: Step | None) -> Exception:
    if not isinstance(error, BenchError):
        log.exception("writing %s failed by a mistake of ours", step.place if step is not None else "a profile")
    return error
