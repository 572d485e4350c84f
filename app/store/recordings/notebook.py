"""What people write about a recording: cells in their order, of text, figures and tables of statistics."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from ...errors import UsageError, WrongState

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


@dataclass(frozen=True, slots=True)
class Notebook:
    """The cells in their order. `revision` counts how often they were written: 0 for a notebook that never was."""

    cells: tuple[Cell, ...] = ()
    revision: int = 0

    def followed_by(self, cells: Sequence[Cell], based_on: int | None) -> Notebook:
        """What is written over this one. Raises UsageError for more than a notebook takes, WrongState where
        `based_on` (None: whatever is there) is another revision: somebody else has written meanwhile."""
        if based_on is not None and based_on != self.revision:
            raise WrongState(
                f"the notebook was to be written over its revision {based_on}, and has revision {self.revision} by now",
                "look at it first, then change it again",
            )
        return Notebook(checked(cells), self.revision + 1)


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


def notebook_of(found: Mapping[str, object]) -> Notebook:
    """The notebook in a document that anybody may have edited: what is no cell is left out."""
    rows, revision = found.get("cells"), found.get("revision")
    cells = [cell for row in (rows if isinstance(rows, list) else [])[:CELLS_MAX] if (cell := _cell(row)) is not None]
    return Notebook(tuple(cells), revision if isinstance(revision, int) and revision >= 0 else 0)


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
