"""A device's configuration as a document: what has to be written to make another chip behave like this one."""

from __future__ import annotations

from app.devices.register_chip import RegisterChip
from app.devices.results import ProfileEntry
from app.registers.model import Access, Register

STATE_NAMES = ("x_target", "x_actual", "v_target", "v_actual", "ustep_count_4210", "cover_datagram")
"""Written like configuration, but they are where the motor is or what happens once."""


def is_configuration(register: Register) -> bool:
    """Whether a profile holds this register: readable, writable, and not the state of a motion. RAM comes as tables."""
    return (
        register.access is Access.RW
        and not register.group.endswith("RAM")
        and register.name.casefold() not in STATE_NAMES
    )


async def read_profile(device: RegisterChip) -> list[ProfileEntry]:
    """All configuration registers as the chip holds them; flags that a write would clear are left out."""
    entries = []
    for register in device.table:
        if is_configuration(register):
            reading = await device.read(register.name, register.axis)
            kept = {part.name for part in register.fields if part.access is Access.RW}
            fields = {name: value for name, value in reading.fields.items() if name in kept}
            mask = sum(part.mask for part in register.fields if part.name in kept) if register.fields else register.mask
            raw = reading.raw & mask
            entries.append(ProfileEntry(register.name, register.axis, raw, register.decode(raw), fields))
    return entries
