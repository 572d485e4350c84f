"""Registers and fields that a study sets to fixed values, as far as the chip has them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..devices.core.device import Device
from ..errors import WrongState
from ..profiles.capture import CapturedConfiguration
from ..profiles.items import Key, items_by_key, key_of
from ..registers.model import Field, Register
from .record import Held


@dataclass(frozen=True, slots=True)
class Place:
    """A register, or a field of one."""

    register: str
    field: str = ""


def word_before(device: Device, row: Register, held: CapturedConfiguration) -> int:
    """What a register held before a study. Raises WrongState where that could not be put back."""
    word = held.words.get(key_of(row))
    if word is None or key_of(row) not in items_by_key(device.model):
        raise WrongState(
            f"what {row.name} holds is not known, so it could not be put back",
            "write it once, or start the axis up (POST .../start-up)",
        )
    return word


def place_of(device: Device, axis: int, place: Place) -> tuple[Register, Field | None] | None:
    """Where a chip has it; None where it has none."""
    found = device.family.table.find(place.register, axis)
    if found is None or not place.field:
        return found
    field = found[0].field_named(place.field)
    return None if field is None else (found[0], field)


class FieldSpace:
    """Some fields of one axis and the values that they may be set to."""

    def __init__(
        self, device: Device, axis: int, values: Sequence[tuple[Place, int]], held: CapturedConfiguration
    ) -> None:
        """`held` is what the device was set to before. Raises WrongState where that could not be put back."""
        self._values = [(at, value) for place, value in values if (at := place_of(device, axis, place)) is not None]
        self._rows = {key_of(row): row for (row, _), _ in self._values}
        self._words = {key: word_before(device, row, held) for key, row in self._rows.items()}
        self.before = self._told(self._words)

    def registers(self) -> list[Held]:
        """What to write for these values; other fields stay."""
        words = dict(self._words)
        for (row, field), value in self._values:
            key = key_of(row)
            words[key] = row.encode(value) if field is None else field.pack(value, words[key])
        return self._told(words)

    def _told(self, words: dict[Key, int]) -> list[Held]:
        return [Held(name=row.name, axis=row.axis, value=row.decode(words[key])) for key, row in self._rows.items()]
