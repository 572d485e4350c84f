"""A row that a driver needs, told by its name alone."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from ...registers.model import Register


def row_named(name: str) -> cached_property[Register]:
    """The row of that name, of an object that gets rows by `get`; KeyError where the chip has none."""

    def get(rows: Any) -> Register:
        row: Register = rows.get(name)
        return row

    return cached_property(get)


def row_named_if_any(name: str) -> cached_property[Register | None]:
    """The row of that name, of an object that finds rows by `find`; None where the chip has none."""

    def find(rows: Any) -> Register | None:
        row: Register | None = rows.find(name)
        return row

    return cached_property(find)
