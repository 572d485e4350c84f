"""What happened during a recording: a line of JSON each, beside the rows."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from ...devices.core.marks import MarkKind

SUFFIX = ".marks"


@dataclass(frozen=True, slots=True)
class Mark:
    """Something at device time `time_s` [s]; `axis` None where it is nobody's.

    detail : the same for programs, where that is more than the text: `{"do": "move", "target": 2000}`
    """

    time_s: float
    kind: MarkKind
    text: str
    axis: int | None = None
    detail: Mapping[str, Any] | None = None


_mark = TypeAdapter(Mark)


def add(path: Path, mark: Mark) -> None:
    """Append; it outlives this process when it returns. Raises OSError."""
    with path.open("ab", buffering=0) as file:
        file.write(json.dumps(asdict(mark), ensure_ascii=False, allow_nan=False).encode() + b"\n")


def read(path: Path) -> list[Mark]:
    """All marks in their order of time; a last line that breaks off is left out."""
    try:
        lines = path.read_bytes().split(b"\n")
    except FileNotFoundError:
        return []
    marks = []
    for line in lines[:-1]:  # what stands behind the last line's end is nothing, or half a line
        try:
            marks.append(_mark.validate_json(line))
        except ValueError:
            continue  # of a newer version, or a disk's mistake: the others are still worth having
    return sorted(marks, key=lambda mark: mark.time_s)
