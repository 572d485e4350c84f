"""What can be wrong with a profile, or come of applying one."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from ..errors import BenchError, UsageError, WrongState


class UnreadableProfile(UsageError):
    """A document that is no profile, or says what no chip can hold. `place` is where: `registers[3].fields.pmul`."""

    def __init__(self, place: str, message: str) -> None:
        super().__init__(f"{place}: {message}" if place else message)
        self.place = place


class ProfileMisfit(WrongState):
    """A profile of something else than this device."""


class ProfileTakenBack(BenchError):
    """A profile was not applied: a step failed, and everything is as it was before.

    failed : the step and why. written : how many steps were done before it, of `of`. prepared : what was done so that
    nothing moves, and stays. left : empty here.
    """

    def __init__(self, message: str, failed: Change, written: int, of: int, prepared: list[str]) -> None:
        super().__init__(message)
        self.failed = asdict(failed)
        self.written, self.of = written, of
        self.prepared = prepared
        self.left: list[dict[str, object]] = []
        self.way_out = "see to what failed, then apply it again; nothing is tried again by itself"


class ProfileLeft(ProfileTakenBack):
    """A profile was not applied, and the rollback failed too: `left` says exactly what is not as it was."""

    def __init__(
        self, message: str, failed: Change, written: int, of: int, prepared: list[str], left: list[Change]
    ) -> None:
        super().__init__(message, failed, written, of, prepared)
        self.left = [asdict(change) for change in left]
        self.way_out = "see to the device, then POST .../profile/apply/way-back, or apply a profile again"


@dataclass(frozen=True, slots=True)
class Change:
    """A register of which it has to be told what it was, is and was to be; None where nobody knows."""

    name: str
    axis: int | None
    table: str | None
    was: int | None
    now: int | None
    wanted: int
    why: str = ""
