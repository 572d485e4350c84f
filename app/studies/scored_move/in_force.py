"""The settings of an axis that are tuned by hand: what they are now, and how those of a move are set again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

from ...devices.core.device import Device
from ...errors import WrongState
from ...profiles.capture import CapturedConfiguration
from ...profiles.items import Key, items_by_key, key_of
from ..families import by_hand_of, stalls_of
from ..field_settings import Place, place_of
from ..record import Held
from ..stallguard.setting import StallSpace


@dataclass(frozen=True, slots=True)
class InForce:
    """values : by the name of each setting; registers : those that hold them, whole"""

    values: Mapping[str, float]
    registers: Sequence[Held]


async def in_force(device: Device, axis: int, held: CapturedConfiguration) -> InForce:
    """Settings that this chip has, of which it is known what they are. Raises BenchError."""
    items = items_by_key(device.model)
    values: dict[str, float] = {}
    registers: dict[Key, Held] = {}
    asked: dict[Place, int] = {}
    for one in by_hand_of(device):
        at = place_of(device, axis, one.place)
        if at is None:
            continue
        row, field = at
        word = held.words.get(key_of(row))
        if word is None or key_of(row) not in items:
            continue
        if one.only is not None:
            where = one.only.field
            if where not in asked:
                asked[where] = (await device.registers.read(where.register, axis)).fields[where.field]
            if asked[where] not in one.only.values:
                continue
        values[one.name] = float(row.decode(word) if field is None else field.unpack(word))
        # Rows that share an address are one entry of a profile, by the name of the first.
        entry = items[key_of(row)].row
        registers[key_of(row)] = Held(name=entry.name, axis=entry.axis, value=entry.decode(word))
    return InForce(values, list(registers.values()))


def as_in_a_move(device: Device, axis: int, held: CapturedConfiguration, registers: Sequence[Held]) -> list[Held]:
    """What to write so that the settings are as in a move, whose `registers` these were.

    Fields beside those that are tuned by hand stay as they are in `held`: which switches stop the motor, which way it
    turns.
    """
    masks: dict[Key, int] = {}
    for one in by_hand_of(device):
        at = place_of(device, axis, one.place)
        if at is not None:
            row, field = at
            masks[key_of(row)] = masks.get(key_of(row), 0) | ((1 << row.width) - 1 if field is None else field.mask)
    wanted = []
    for each in registers:
        found = device.family.table.find(each.name, each.axis)
        now = None if found is None else held.words.get(key_of(found[0]))
        if found is None or now is None or key_of(found[0]) not in masks:
            wanted.append(each)
            continue
        row, mask = found[0], masks[key_of(found[0])]
        word = now & ~mask | row.encode(each.value) & mask
        wanted.append(each.model_copy(update={"value": row.decode(word)}))
    return wanted


def stall_level(device: Device, axis: int, held: CapturedConfiguration, full_step: int) -> float | None:
    """The load value at or below which is a stall, of the StallGuard that works as the chopper is set; None where
    nobody knows. `full_step` in microsteps."""
    spaces = []
    with suppress(WrongState):  # no StallGuard that a study knows
        for places in stalls_of(device):
            with suppress(WrongState):  # not this one, or what it is set to is not known
                spaces.append(StallSpace(device, axis, places, held, full_step))
    if not spaces:
        return None
    space = min(spaces, key=lambda each: each.misfits)
    # A threshold of StallGuard2 is in the value already.
    return 0.0 if space.scale.generation == 2 else space.scale.level(space.now().threshold)
