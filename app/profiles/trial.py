"""Which parameters can be set, tried out, of a device whose table does not tell: each is written what it holds."""

from __future__ import annotations

from dataclasses import dataclass

from ..devices.core.device import Device
from ..errors import BadReply, LinkError, UsageError
from ..registers.model import Access
from .items import items_of
from .preconditions import require_rest


@dataclass(frozen=True, slots=True)
class Tried:
    """What came of it. refused : names and axes of what the device did not take"""

    settable: int
    refused: list[tuple[str, int | None]]


async def try_writes(device: Device) -> Tried:
    """Write every parameter that may be configuration the value that it holds, once, and read it back.

    What is known to be settable is not written. The motors have to stand. Raises WrongState, LinkError.
    """
    await require_rest(device)
    settable, refused = 0, list[tuple[str, int | None]]()
    for item in items_of(device.model):
        row = item.row
        # What a register reads that may only be writable is not what it holds.
        if not device.configuration.settable(row) and row.access is not Access.UNKNOWN:
            try:
                held = await device.registers.read(row.name, row.axis)
                await device.registers.write(row.name, row.axis, held.value)
            except (UsageError, BadReply):  # it has none, does not let it be written, or holds something else then
                pass
            except LinkError:
                raise
        if device.configuration.settable(row):
            settable += 1
        else:
            refused.append((row.name, row.axis))
    return Tried(settable, refused)
