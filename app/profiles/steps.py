"""The writes that bring a device, or a script's reader, to what a profile says: which, of what, and in which order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..devices.core.results import WriteItem
from ..registers.catalog import MODELS
from ..registers.model import Register
from .capture import CapturedConfiguration
from .diff import UNIT_MODE
from .document import ProfileDocument
from .errors import ProfileMisfit
from .families import rules_of
from .items import Item, Key, items_by_key, key_of
from .register_bits import RegisterBits, bits_of, check_range


@dataclass(frozen=True, slots=True)
class Step:
    """One write, and what it writes over."""

    item: Item
    word: int
    """What the register shall hold, inside the item's mask."""
    mask: int
    """The bits that are written; of a register with fields, those of whole fields."""
    was: int | None
    """What it held before; None where nobody knows."""
    steady: bool = True
    """Whether it reads the same until this step is done: not so while an earlier one changes what numbers count in."""

    @property
    def register(self) -> Register:
        """The row."""
        return self.item.row

    @property
    def value(self) -> int:
        """The whole number, as people write it."""
        return self.item.row.decode(self.word)

    @property
    def place(self) -> str:
        """For people: `VMAX of axis 0`."""
        return self.item.place

    def write(self) -> WriteItem:
        """As a driver takes it: the whole value, or fields, so that bits that are state stay."""
        return write_of(self.item, self.word, self.mask)

    def way_back(self) -> WriteItem | None:
        """The write that makes it what it was; None where nobody knows what that is."""
        return None if self.was is None else write_of(self.item, self.was, self.mask)


def write_of(item: Item, word: int, mask: int) -> WriteItem:
    """A write of `word`, or of those of its fields that are in `mask`."""
    row = item.row
    if not item.fields:
        return WriteItem(row.name, row.axis, row.decode(word))
    fields: dict[str, int | str] = {
        part.name: part.unpack(word) for part in item.fields if part.mask & mask == part.mask
    }
    return WriteItem(row.name, row.axis, fields=fields)


def steps_of(document: ProfileDocument) -> list[Step]:
    """Everything that a profile says, in the order in which it is safe to write, whatever a device holds.

    Raises UnreadableProfile for what cannot be, and what may not be written.
    """
    wants = bits_of(document)
    for want in wants.values():
        check_range(want)
    return [Step(want.item, want.word, want.mask, None) for want in wants.values()]


def steps_between(
    held: CapturedConfiguration, wants: Mapping[Key, RegisterBits], differing: Sequence[Key]
) -> list[Step]:
    """The writes after which a device that held `held` holds what is wanted.

    Raises UnreadableProfile for what may not be written, ProfileMisfit for some fields of a register of which nobody
    knows the others.
    """
    units_change = UNIT_MODE in differing
    steps = []
    for key, want in wants.items():
        # Where speeds count in other units from now on, all of them are written, and none reads as it did.
        restated = units_change and want.item.row.internal_range is not None
        if key not in differing and not restated:
            continue
        check_range(want)
        was = held.word(want.item)
        if was is None and want.mask != want.item.mask:
            raise ProfileMisfit(
                f"{want.place}: the profile tells only some fields of {want.item.place}, which cannot be read",
                "tell all of its fields",
            )
        word = want.word | ((was or 0) & ~want.mask)
        steps.append(Step(want.item, word, want.mask, was, steady=not restated))
    return _ungated(held, steps)


def _ungated(held: CapturedConfiguration, steps: list[Step]) -> list[Step]:
    """What waits for a start signal takes no write, and a start may overwrite one: the gates are open meanwhile."""
    gates = rules_of(held.model).gates
    if gates is None or not steps:
        return steps
    register = MODELS[held.model].table.get(gates.register, 0)
    item = items_by_key(held.model)[key_of(register)]
    before = held.word(item)
    if before is None or not before & gates.mask:
        return steps
    last = next((step for step in steps if step.item is item), None)
    others = [step for step in steps if step.item is not item]
    after = before if last is None else last.word
    open_ = before & ~gates.mask
    return [Step(item, open_, item.mask, before), *others, Step(item, after, item.mask, open_)]
