"""What can be wrong with a profile, or come of applying one."""

from __future__ import annotations

from app.links.errors import UsageError, WrongState


class UnreadableProfile(UsageError):
    """A document that is no profile, or says what no chip can hold. `place` is where: `registers[3].fields.pmul`."""

    def __init__(self, place: str, message: str) -> None:
        super().__init__(f"{place}: {message}" if place else message)
        self.place = place


class ProfileMisfit(WrongState):
    """A profile of something else than this device."""
