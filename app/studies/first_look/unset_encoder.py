"""A setting for an encoder that nobody has set yet, by which the first look finds it."""

from __future__ import annotations

from dataclasses import dataclass

from ...devices.core.capabilities import EncoderSetting, UnsetEncoder
from ...devices.core.device import Device
from ...errors import WrongState
from ...profiles.capture import CapturedConfiguration
from ..field_settings import FieldSpace, Place
from ..record import Held

COUNTS = 4000
"""What it is taken to have a turn at the most: a fiftieth of that, which would be taken to stand still, has none, and
the greatest one does not go round its counter."""


@dataclass(frozen=True, slots=True)
class Provisional:
    """Counts a turn that an encoder is taken to have, the registers that say so, and what these held before."""

    counts: int
    registers: list[Held]
    before: list[Held]


@dataclass(frozen=True, slots=True)
class EncoderGround:
    """What is known of an encoder before the first move.

    exists : the chip reads one; untold : why one that is not set up cannot be looked for, empty where it is read or can
    """

    exists: bool
    provisional: Provisional | None = None
    untold: str = ""


def encoder_ground(device: Device, axis: int, *, read: bool, turn: int, held: CapturedConfiguration) -> EncoderGround:
    """Whether there is an encoder, and a setting that shows one which nobody has set yet.

    read : its position is told already; turn : of the motor [microsteps]; held : what the device is set to
    """
    if read:
        return EncoderGround(exists=True)
    setting, unset = device.part(EncoderSetting), device.part(UnsetEncoder)
    if setting is None or not setting.has_encoder(axis):
        return EncoderGround(exists=False)
    if unset is None:
        return EncoderGround(exists=True, untold="it tells no position")
    counts = min(COUNTS, turn)  # a count is a microstep at the least: encoder positions are whole ones
    try:
        told = unset.provisional_encoder(axis, counts)
        values: dict[Place, int] = {}
        for name, what in told.items():
            parts = {"": what} if isinstance(what, int) else what
            values |= {Place(name, field): value for field, value in parts.items()}
        space = FieldSpace(device, axis, values, held)
    except WrongState as error:
        return EncoderGround(exists=True, untold=str(error))
    return EncoderGround(exists=True, provisional=Provisional(counts, space.registers(values), space.before))
