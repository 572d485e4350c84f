"""What the first look sets of an encoder: a count, where nobody has said what one is, and that its index is latched."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ...devices.core.capabilities import EncoderIndex, EncoderSetting, UnsetEncoder
from ...devices.core.device import Device
from ...errors import WrongState
from ...profiles.capture import CapturedConfiguration
from ..field_settings import FieldSpace, Place
from ..record import Held

COUNTS = 4000
"""What it is taken to have a turn at the most: a fiftieth of that, which would be taken to stand still, has none, and
the greatest one does not go round its counter."""


@dataclass(frozen=True, slots=True)
class EncoderGround:
    """What is known of an encoder before the first move, and what is set of it meanwhile.

    exists : the chip reads one
    untold : why one that is not set up cannot be looked for; empty where it is read, or can be
    provisional : counts a turn that it is taken to have; None where its setting is left as it is
    index_untold : why its index cannot be looked for; empty where it can
    before : what the `registers` hold that are set meanwhile
    """

    exists: bool
    untold: str = ""
    provisional: int | None = None
    index_untold: str = ""
    registers: list[Held] = field(default_factory=list)
    before: list[Held] = field(default_factory=list)


def encoder_ground(device: Device, axis: int, *, read: bool, turn: int, held: CapturedConfiguration) -> EncoderGround:
    """Whether there is an encoder, and what to set to find it and its index.

    read : its position is told already; turn : of the motor [microsteps]; held : what the device is set to
    """
    setting, unset = device.part(EncoderSetting), device.part(UnsetEncoder)
    if setting is None or not setting.has_encoder(axis):
        return EncoderGround(exists=read, index_untold="nothing here tells of one")
    values: dict[Place, int] = {}
    provisional = None
    if not read:
        if unset is None:
            return EncoderGround(exists=True, untold="it tells no position")
        provisional = min(COUNTS, turn)  # a count is a microstep at the least: encoder positions are whole ones
        try:
            values = _places(unset.provisional_encoder(axis, provisional))
            FieldSpace(device, axis, values, held)
        except WrongState as error:
            return EncoderGround(exists=True, untold=str(error))
    index_untold = ""
    try:
        with_index = values | _places(device.need(EncoderIndex).index_setting(axis))
        space = FieldSpace(device, axis, with_index, held)
        values = with_index
    except WrongState as error:
        index_untold = str(error)
        space = FieldSpace(device, axis, values, held)
    return EncoderGround(True, "", provisional, index_untold, space.registers(values), space.before)


def _places(told: Mapping[str, int | Mapping[str, int]]) -> dict[Place, int]:
    found: dict[Place, int] = {}
    for name, what in told.items():
        parts = {"": what} if isinstance(what, int) else what
        found |= {Place(name, part): value for part, value in parts.items()}
    return found
