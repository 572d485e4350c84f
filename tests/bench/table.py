"""One line of the table that `make bench` prints."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Row:
    """`measured` against `peer` (something measured in the same run, or a limit), and what their ratio has to be."""

    what: str
    measured: str
    peer: str
    ratio: float
    required: str
    ok: bool
    notes: tuple[str, ...] = ()


HEAD = ("what", "measured", "peer or limit", "ratio", "required", "")


def render(rows: Sequence[Row]) -> str:
    """A table in plain text, its notes below."""
    cells = [HEAD]
    cells += [(r.what, r.measured, r.peer, f"{r.ratio:.3g}", r.required, "ok" if r.ok else "NOT OK") for r in rows]
    widths = [max(len(line[column]) for line in cells) for column in range(len(HEAD))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in cells]
    lines.insert(1, "  ".join("-" * width for width in widths))
    lines += [f"  {row.what}: {note}" for row in rows for note in row.notes]
    return "\n".join(lines)


def p99(values: Iterable[float]) -> float:
    """The value that 99 % do not exceed."""
    return float(np.percentile(np.fromiter(values, dtype=np.float64), 99, method="higher"))
