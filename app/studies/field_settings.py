"""Registers and fields that a study sets, as far as the chip has them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ..devices.core.device import Device
from ..errors import WrongState
from ..profiles.capture import CapturedConfiguration, axis_part
from ..profiles.items import Key, items_by_key, key_of
from ..profiles.physical import UnitContext
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


def units_of(device: Device, held: CapturedConfiguration) -> UnitContext:
    """What its registers count in, as it is set."""
    axes = tuple(axis_part(each.settings) for each in device.axes)
    return UnitContext(device.model, device.clock_hz, axes, held.words)


def place_of(device: Device, axis: int, place: Place) -> tuple[Register, Field | None] | None:
    """Where a chip has it; None where it has none."""
    found = device.family.table.find(place.register, axis)
    if found is None or not place.field:
        return found
    field = found[0].field_named(place.field)
    return None if field is None else (found[0], field)


class FieldSpace:
    """Some fields of one axis, as far as its chip has them: what they held before, and what to write for others."""

    def __init__(self, device: Device, axis: int, places: Iterable[Place], held: CapturedConfiguration) -> None:
        """`held` is what the device was set to before. Raises WrongState where that could not be put back."""
        self._at = {place: at for place in places if (at := place_of(device, axis, place)) is not None}
        self._rows = {key_of(row): row for row, _ in self._at.values()}
        self._words = {key: word_before(device, row, held) for key, row in self._rows.items()}
        self.before = self._told(self._words)
        self._range_of = device.configuration.range_of

    def __contains__(self, place: Place) -> bool:
        """Whether the chip has it."""
        return place in self._at

    def __getitem__(self, place: Place) -> int:
        """What it held before. Raises KeyError where the chip has it not."""
        row, field = self._at[place]
        word = self._words[key_of(row)]
        return row.decode(word) if field is None else field.unpack(word)

    def greatest(self, place: Place) -> int:
        """The greatest number that it takes. Raises KeyError where the chip has it not."""
        row, field = self._at[place]
        return self._range_of(row)[1] if field is None else (1 << field.width) - 1

    def registers(self, values: Mapping[Place, int]) -> list[Held]:
        """What to write for these values: fields beside them stay, and what the chip has not is left out."""
        words: dict[Key, int] = {}
        for place, value in values.items():
            if place in self._at:
                row, field = self._at[place]
                key = key_of(row)
                words[key] = row.encode(value) if field is None else field.pack(value, words.get(key, self._words[key]))
        return self._told(words)

    def _told(self, words: Mapping[Key, int]) -> list[Held]:
        return [
            Held(name=row.name, axis=row.axis, value=row.decode(words[key]))
            for key, row in self._rows.items()
            if key in words
        ]
