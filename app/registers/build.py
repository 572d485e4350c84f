"""Builders of register tables, whose rows stand in the order of a data sheet: address, name, width, access, meaning."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Unpack

from .model import Access, Field, Particulars, Register

R, W, RW = Access.R, Access.W, Access.RW
OFF_ON = {0: "off", 1: "on"}
NO_YES = {0: "no", 1: "yes"}


@dataclass(frozen=True, slots=True)
class Rows:
    """Builds the rows of one group, which have its source unless they tell one of their own."""

    group: str
    source: str

    def __call__(
        self, address: int, name: str, width: int, access: Access, help_: str, **particulars: Unpack[Particulars]
    ) -> Register:
        row = Register(name, width, help_, address=address, access=access, group=self.group, source=self.source)
        return replace(row, **particulars)

    def reading(self, address: int, name: str, width: int, help_: str, **particulars: Unpack[Particulars]) -> Register:
        """A register that the chip keeps by itself, and that can only be read."""
        row = self(address, name, width, R, help_, reset=None, volatile=True)
        return replace(row, **particulars)


def choice(
    lsb: int,
    name: str,
    width: int,
    help_: str,
    values: Mapping[int, str],
    *,
    unit: str = "",
    signed: bool = False,
    range: tuple[int, int] | None = None,  # noqa: A002 - named as in `Field`
    when: str = "",
    behaviour: str = "",
    access: Access = RW,
    reset: int | None = 0,
) -> Field:
    """Bits whose values have names."""
    return Field(
        name,
        width,
        help_,
        lsb=lsb,
        values=values,
        unit=unit,
        signed=signed,
        range=range,
        when=when,
        behaviour=behaviour,
        access=access,
        reset=reset,
    )


def flag(lsb: int, name: str, help_: str, when: str = "", behaviour: str = "") -> Field:
    """A bit that is on or off."""
    return choice(lsb, name, 1, help_, OFF_ON, when=when, behaviour=behaviour)


def state(lsb: int, name: str, help_: str, access: Access = RW) -> Field:
    """A bit that tells whether something is so."""
    return choice(lsb, name, 1, help_, NO_YES, access=access)
