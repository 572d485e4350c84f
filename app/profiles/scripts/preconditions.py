"""What a script does so that no register that it writes sets a motor off: the axis has nowhere to go meanwhile.

That is motion, not configuration, and stays: as when the server applies a profile (`profiles.preconditions`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ...registers.catalog import MODELS
from ...registers.model import Field, Register
from ..families import rules_of
from ..items import Item, Key, key_of
from ..register_bits import RegisterBits
from ..rules import Busy


def target_of(model: str) -> str:
    """The register that gets the position; empty for a module, whose motor has to stand at its target."""
    row = MODELS[model].table.find(rules_of(model).target, 0)
    return row[0].name if row else ""


def busy_of(model: str) -> tuple[Busy, ...]:
    """What has to be 0."""
    return rules_of(model).busy


def ready_of(model: str, wants: Mapping[Key, RegisterBits]) -> list[RegisterBits]:
    """What is written before everything else: nothing waits for a start signal, and each axis holds a position."""
    return [*_open_gates(model, wants), *_positioning(model)]


def kept_ready(want: RegisterBits) -> RegisterBits:
    """A write of the profile that leaves the axis in its position mode, which a TMC4361 has beside the ramp's shape."""
    row = want.item.row
    mode = row.field_named("OPERATION_MODE") if row.name == "RAMPMODE" else None
    if mode is None:
        return want
    item = replace(want.item, mask=want.item.mask | mode.mask, fields=(mode, *want.item.fields))
    return RegisterBits(item, mode.pack(1, want.word), want.mask | mode.mask, want.place)


def _positioning(model: str) -> list[RegisterBits]:
    name, field, value = rules_of(model).positioning or ("", "", 0)
    rows = (row for row in MODELS[model].table if row.name == name)
    return [_alone(row, row.field_named(field) if field else None, value) for row in rows]


def _alone(row: Register, part: Field | None, value: int) -> RegisterBits:
    """A write of one field, or of a register that no profile holds."""
    mask = row.mask if part is None else part.mask
    item = Item(row, mask, () if part is None else (part,), None, (0, 0, 0, 0))
    return RegisterBits(item, value if part is None else part.pack(value), mask, row.name)


def _open_gates(model: str, wants: Mapping[Key, RegisterBits]) -> list[RegisterBits]:
    gates = rules_of(model).gates
    if gates is None:
        return []
    start = MODELS[model].table.get(gates.register, 0)
    want = wants.get(key_of(start))
    return [] if want is None else [replace(want, word=want.word & ~gates.mask)]
