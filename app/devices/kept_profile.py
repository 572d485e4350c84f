"""The configuration of a chip of which much cannot be read: what can be, and what was written through here."""

from __future__ import annotations

from typing import ClassVar

from app.devices.keeping_chip import KeepingChip
from app.devices.profile import read_profile
from app.devices.results import ProfileEntry
from app.registers.model import Access, Register


class KeptProfile(KeepingChip):
    """A chip with a profile."""

    STATE_NAMES: ClassVar[frozenset[str]] = frozenset()
    """Registers that can be read and written, but are where the motor is or what happens once."""
    ONCE: ClassVar[frozenset[str]] = frozenset()
    """Registers whose writing does something instead of setting something."""

    async def kept_profile(self) -> list[ProfileEntry]:
        """All configuration: read, and of write-only registers what was written since the chip's reset."""
        readable = [entry for entry in await read_profile(self) if entry.name not in self.STATE_NAMES]
        return readable + self._written_entries()

    def _written_entries(self) -> list[ProfileEntry]:
        """Write-only registers that were written."""
        entries = []
        for register in self.table:
            word = self._wanted_word(register)
            if word is None or register.access is not Access.W or register.when or register.name in self.ONCE:
                continue
            entries.append(_entry(register, word & register.mask))
        return entries

    def _wanted_word(self, register: Register) -> int | None:
        """What was written there last, by whoever set it up; None where nothing was."""
        return self._blind.get(register.address)


def _entry(register: Register, raw: int) -> ProfileEntry:
    return ProfileEntry(register.name, register.axis, raw, register.decode(raw), register.unpack(raw))
