"""Which fields of a chip are settings that somebody tunes by hand."""

from __future__ import annotations

from dataclasses import dataclass

from ..field_settings import Place


@dataclass(frozen=True, slots=True)
class Only:
    """While a field of a register that can be read has one of these values."""

    field: Place
    values: frozenset[int]


@dataclass(frozen=True, slots=True)
class HandPlace:
    """One of them, by the name that it has in a table. only : when it means that, of an address with two meanings"""

    name: str
    place: Place
    only: Only | None = None


def whole(*names: str, only: Only | None = None) -> tuple[HandPlace, ...]:
    """Registers, each by its own name."""
    return tuple(HandPlace(name, Place(name), only) for name in names)


def fields(register: str, *names: str, only: Only | None = None) -> tuple[HandPlace, ...]:
    """Fields of a register, each by its own name."""
    return tuple(HandPlace(name, Place(register, name), only) for name in names)
