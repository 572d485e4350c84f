"""Register writes that a caller asked for, as events: by name, field, batch, table, profile or raw frame.

What a move writes on its own account is none of them: that is the move, and `MotionCommanded` tells of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ...errors import BadReply, BenchError, LinkTimeout, WriteRefused
from ...registers.model import Register
from .actor import Actor, actor

DONE = "done"
BY_HAND = "not proven: a raw frame is not read back"


@dataclass(frozen=True, slots=True)
class RegisterChanged:
    """A write went out to a register.

    old : what the device held before; None where nobody knows. new : what it holds now, or was asked to hold where
    that is not proven. fields : of a packed register those that differ, with old and new value.
    at_s : device time [s]. outcome : "done", or "not proven: why", or "refused: why" where the chip did not take it
    part_of : the table that it is a word of, "" where it is none
    """

    register: str
    axis: int | None
    old: int | None
    new: int | None
    at_s: float
    outcome: str = DONE
    fields: Mapping[str, tuple[int | None, int]] = field(default_factory=dict)
    part_of: str = ""
    by: Actor = field(default_factory=actor.get)

    @property
    def text(self) -> str:
        """As a mark in a plot: `VMAX.0 20000 -> 30000 by Ann`; of a packed register the fields that differ."""
        name = self.register if self.axis is None else f"{self.register}.{self.axis}"
        what = self.field_text or f"{'' if self.old is None else f'{self.old} '}-> {self.new}"
        return f"{name} {what} by {self.by.name}{'' if self.outcome == DONE else f' ({self.outcome})'}"

    @property
    def field_text(self) -> str:
        """The fields that differ: `toff 3 -> 4, tbl -> 2`; empty where there is nothing to say."""
        return ", ".join(
            f"{name} {'' if old is None else f'{old} '}-> {new}" for name, (old, new) in self.fields.items()
        )


def register_changed(
    register: Register, old: int | None, new: int, at_s: float, outcome: str = DONE, part_of: str = ""
) -> RegisterChanged:
    """The event of a write that made the word `old` the word `new`; words as the user sees them."""
    return RegisterChanged(
        register.name,
        register.axis,
        None if old is None else register.decode(old),
        register.decode(new),
        at_s,
        outcome,
        _differing(register, old, new),
        part_of,
    )


def _differing(register: Register, old: int | None, new: int) -> dict[str, tuple[int | None, int]]:
    if not register.fields:
        return {}
    after = register.unpack(new & register.mask)
    before = {} if old is None else register.unpack(old & register.mask)
    return {
        part.name: (before.get(part.name), after[part.name])
        for part in register.fields
        if part.access.writable and before.get(part.name) != after[part.name]
    }


def outcome_of(verified: bool | None, note: str) -> str:
    """What a read-back has shown, as an outcome."""
    return DONE if verified else f"not proven: {note or 'it cannot be read back'}"


def outcome_of_failure(error: BenchError) -> str | None:
    """What a write was that raised `error` once it was on its way; None where nothing went out."""
    if isinstance(error, WriteRefused):
        return f"refused: {error}"
    if isinstance(error, LinkTimeout | BadReply):
        return f"not proven: {error}"
    return None
