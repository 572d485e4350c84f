"""Builders of a module's parameters, in the order of a manual: number, name, access, range, meaning."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Unpack

from ..build import OFF_ON, RW, R, Rows
from ..model import Access, Particulars, Register, Space, Stored


@dataclass(frozen=True, slots=True)
class Parameters:
    """Builds the parameters of one group: numbers of 32 bits whose default nobody tells, unless they tell it."""

    group: str
    source: str
    space: Space = Space.AXIS
    stored: Stored = ""

    def __call__(
        self,
        number: int,
        name: str,
        access: Access,
        limits: tuple[int, int],
        help_: str,
        **particulars: Unpack[Particulars],
    ) -> Register:
        row = Rows(self.group, self.source)(number, name, 32, access, help_).having(
            space=self.space,
            stored=self.stored,
            axis=0 if self.space is Space.AXIS else None,
            signed=limits[1] < 1 << 31,
            range=limits,
            reset=None,
            volatile=access is R,
        )
        return replace(row, **particulars)

    def switch(self, number: int, name: str, help_: str, **particulars: Unpack[Particulars]) -> Register:
        """A parameter that is off or on."""
        return replace(self(number, name, RW, (0, 1), help_, values=OFF_ON), **particulars)
