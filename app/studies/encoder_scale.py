"""What a count of the encoder is set to be, by the register that says so."""

from __future__ import annotations

from dataclasses import dataclass

from ..calc.positions.encoder_resolution import constant_of
from ..devices.core.device import Device
from ..profiles.capture import CapturedConfiguration
from ..profiles.items import key_of


@dataclass(frozen=True, slots=True)
class EncoderPlaces:
    """The register of microsteps a count, and the bit that makes its fraction a decimal one."""

    constant: str
    mode: str
    decimal: str


def microsteps_a_count(
    device: Device, axis: int, places: EncoderPlaces | None, held: CapturedConfiguration
) -> float | None:
    """What a count is set to be [microsteps], without its sign; None where nobody knows."""
    if places is None:
        return None
    table = device.family.table
    constant, mode = table.find(places.constant, axis), table.find(places.mode, axis)
    if constant is None:
        return None
    word = held.words.get(key_of(constant[0]))
    if not word:
        return None
    decimal = False
    if mode is not None and (bit := mode[0].field_named(places.decimal)) is not None:
        decimal = bool(bit.unpack(held.words.get(key_of(mode[0])) or 0))
    value = constant_of(word, decimal=decimal)
    return abs(value - (1 << 16) if value >= 1 << 15 else value) or None
