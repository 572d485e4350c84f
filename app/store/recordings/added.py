"""Files of other instruments that were laid beside a recording: their channels, and where their time lies on its own.

`ID.added.json` says what each is; `ID.added-N.npy` holds one's times and values as a table, [1 + channels, rows].
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import TypeAdapter, ValidationError

from ...deferred import DEFERRED
from .file import FloatArray
from .head import Column

FILES_MAX = 8
SUFFIX = ".added.json"


def data_suffix(number: int) -> str:
    return f".added-{number}.npy"


SUFFIXES = (SUFFIX, f"{SUFFIX}.lock", *(data_suffix(number) for number in range(FILES_MAX)))


@dataclass(frozen=True, slots=True)
class Added:
    """A file.

    number : by which it is known in its recording
    columns : no two of a recording have the same name
    offset_s : to be added to its times to be times since the recording's zero [s]
    aligned : how that came about, in words
    """

    number: int
    name: str
    instrument: str
    columns: tuple[Column, ...]
    rows: int
    from_s: float
    to_s: float
    offset_s: float
    aligned: str
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class AddedRows:
    """`time_s` [rows] since the recording's zero, rising; `columns` [channels, rows], NaN where a sample is missing."""

    of: Added
    time_s: FloatArray
    columns: FloatArray


_all = TypeAdapter(tuple[Added, ...], config=DEFERRED)


def added_of(found: Mapping[str, object]) -> tuple[Added, ...]:
    """Those in a document that anybody may have edited; none where that is not to be read."""
    try:
        return tuple(each for each in _all.validate_python(found.get("files", ())) if 0 <= each.number < FILES_MAX)
    except ValidationError:
        return ()


def as_document(files: Sequence[Added]) -> dict[str, object]:
    return {"files": _all.dump_python(tuple(files), mode="json")}


def write_rows(path: Path, time_s: FloatArray, columns: FloatArray) -> None:
    """Raises OSError."""
    with path.open("wb") as file:
        np.save(file, np.vstack((time_s, columns)), allow_pickle=False)


def read_rows(path: Path, of: Added) -> AddedRows:
    """Raises OSError, ValueError for what is none."""
    table = np.load(path, allow_pickle=False)
    if table.shape != (1 + len(of.columns), of.rows):
        raise ValueError(f"{path.name} is another table than its recording says")
    return AddedRows(of, table[0] + of.offset_s, table[1:])
