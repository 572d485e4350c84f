"""What a device holds of its configuration, and a profile of it."""

from __future__ import annotations

import time
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass

from ..devices.core.config import AxisSettings
from ..devices.core.device import Device
from ..errors import WrongState
from .document import AxisPart, Limits, ProfileDocument, UnknownPart
from .items import Item, Key, items_by_key, key_of
from .program import NAME as PROGRAM
from .program import read_part
from .register_bits import parameter_parts, register_parts, tables_of, unknown_parts


@dataclass(frozen=True, slots=True)
class CapturedConfiguration:
    """A device's configuration as it was read.

    words : bits of each register, as one would have to write them, inside its item's mask; None where it cannot be
        read and nobody knows
    state : bits that are no configuration at present: the ramp mode, while it is that of a rotation or a stop
    """

    model: str
    words: Mapping[Key, int | None]
    state: Mapping[Key, int]

    def word(self, item: Item) -> int | None:
        """What the register of `item` holds."""
        return self.words.get(item.key)


async def read_held(device: Device, wanted: Collection[Key] = ()) -> CapturedConfiguration:
    """Ask for all of it, `wanted` also where nobody has seen yet that it can be set. Nothing is written.

    Raises BenchError.
    """
    device.session.require_connected()
    for axis in device.axes:
        await device.monitor.axis_state(axis.index)  # tells of a reset, after which more is known than can be read
    settable = device.configuration.settable
    items = {key: item for key, item in items_by_key(device.model).items() if key in wanted or settable(item.row)}
    words: dict[Key, int | None] = dict.fromkeys(items)
    for reading in await device.registers.read_all():
        item = _item_of(device, reading.name, reading.axis)
        if item is not None and item.key in words:
            words[item.key] = as_configured(device, item, reading.raw)
    for key, item in items.items():
        if words[key] is None and not item.row.access.readable:
            words[key] = unread(device, item)
    return CapturedConfiguration(device.model, words, state_bits(device, words))


async def read_item(device: Device, item: Item) -> int | None:
    """One register as `read_held` has it. Raises BenchError."""
    if not item.row.access.readable:
        return unread(device, item)
    reading = await device.registers.read(item.row.name, item.row.axis)
    return as_configured(device, item, reading.raw)


def as_configured(device: Device, item: Item, raw: int) -> int:
    """What was read, as its user has set it and as one would have to write it again."""
    return device.configuration.as_set(item.row, raw) & item.mask


def unread(device: Device, item: Item) -> int | None:
    """What a register that cannot be read holds, as far as anybody knows."""
    word = device.configuration.unread(item.row)
    return None if word is None else word & item.mask


def state_bits(device: Device, words: Mapping[Key, int | None]) -> dict[Key, int]:
    """Bits that are what the motor was last told to do, though at other times they are configuration."""
    items, rules = items_by_key(device.model), device.configuration
    bits = {key: rules.commanded_bits(items[key].row, word) for key, word in words.items() if word is not None}
    return {key: commanded for key, commanded in bits.items() if commanded}


def _item_of(device: Device, name: str, axis: int | None) -> Item | None:
    found = device.family.table.find(name, axis)
    if found is None or found[1] is not None:
        return None
    item = items_by_key(device.model).get(key_of(found[0]))
    return item if item is not None and item.row is found[0] else None


async def capture(
    device: Device,
    name: str = "",
    note: str = "",
    unix_s: float | None = None,
    wanted: Collection[Key] = (),
    *,
    program: bool = False,
) -> ProfileDocument:
    """The device's whole configuration as a document, called `name` (by default as the device), with all `wanted`.

    `program`: with the program in its memory too, whose reading takes a while on a slow line.

    Raises WrongState where it is not known yet of anything whether it is configuration; BenchError.
    """
    held = await read_held(device, wanted)
    if not held.words:
        raise WrongState(
            f"of no parameter of {device.name} it is known yet whether it can be set: that makes it configuration",
            "write some, or have all tried: POST .../profile/try",
        )
    document = document_of(device, held, name, note, time.time() if unix_s is None else unix_s)
    if program:
        document.program, why = await read_part(device)
        if why:
            document.unknown.append(UnknownPart(name=PROGRAM))
    return document


def document_of(device: Device, held: CapturedConfiguration, name: str, note: str, unix_s: float) -> ProfileDocument:
    """What was read, as a document."""
    return ProfileDocument.model_validate(
        {
            "name": name or device.name,
            "note": note,
            "model": device.model,
            "clock_hz": device.clock_hz,
            "device": device.name,
            "firmware": device.configuration.firmware,
            "captured_unix_s": round(unix_s, 3),
            "axes": [axis_part(axis.settings) for axis in device.axes],
            "registers": register_parts(device.model, held.word, but=held.state),
            "parameters": parameter_parts(device.model, held.word, device.configuration.unit_of),
            "tables": tables_of(device.model, held.word),
            "unknown": unknown_parts(device.model, held.words),
        }
    )


def axis_part(settings: AxisSettings) -> AxisPart:
    """Mechanics and limits of an axis."""
    # What is judged of its condition is how the axis is watched, and no configuration of the device.
    plain = {name: value for name, value in asdict(settings).items() if name in AxisPart.model_fields}
    limits = {name: value for name, value in plain.pop("limits").items() if value is not None}
    return AxisPart(**plain, limits=Limits(**limits) if limits else Limits())
