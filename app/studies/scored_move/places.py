"""Which fields of a chip are settings that somebody tunes by hand."""

from __future__ import annotations

from dataclasses import dataclass

from ..field_settings import Place


@dataclass(frozen=True, slots=True)
class HandPlace:
    """One of them, by the name that it has in a table."""

    name: str
    place: Place
