"""What people write about a recording: cells in their order, of text, figures and tables of statistics."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from ...errors import UsageError

Kind = Literal["text", "figure", "table"]
CELLS_MAX, TEXT_MAX, CHANNELS_MAX = 100, 4000, 64


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell; a figure and a table are of the stretch `from_s` to `to_s` since the zero, None: of all of it.

    channels : the channels that it shows; none of them: all
    """

    kind: Kind
    text: str = ""
    from_s: float | None = None
    to_s: float | None = None
    channels: tuple[str, ...] = ()


def checked(cells: Sequence[Cell]) -> tuple[Cell, ...]:
    """Raises UsageError for more than a notebook takes."""
    if len(cells) > CELLS_MAX:
        raise UsageError(f"a notebook has at most {CELLS_MAX} cells, not {len(cells)}")
    for cell in cells:
        if len(cell.text) > TEXT_MAX:
            raise UsageError(f"a cell has at most {TEXT_MAX} characters, not {len(cell.text)}")
        if cell.from_s is not None and cell.to_s is not None and cell.from_s >= cell.to_s:
            raise UsageError(f"a cell's stretch ends after it begins: from_s {cell.from_s:g}, to_s {cell.to_s:g}")
    return tuple(cells)


def cells_of(found: object) -> tuple[Cell, ...]:
    """The cells in a document that anybody may have edited: what is no cell is left out."""
    rows = found if isinstance(found, list) else []
    return tuple(cell for row in rows[:CELLS_MAX] if (cell := _cell(row)) is not None)


def _cell(row: object) -> Cell | None:
    if not isinstance(row, dict) or row.get("kind") not in get_args(Kind):
        return None
    from_s, to_s = _time(row.get("from_s")), _time(row.get("to_s"))
    channels = row.get("channels")
    named = [name for name in channels if isinstance(name, str)] if isinstance(channels, list) else []
    text = str(row.get("text", "")).encode(errors="replace").decode()[:TEXT_MAX]
    return Cell(row["kind"], text, from_s, to_s, tuple(named[:CHANNELS_MAX]))


def _time(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return float(value)
