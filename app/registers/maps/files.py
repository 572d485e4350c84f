"""Register maps in files, wherever those are: TOML, or a table."""

from __future__ import annotations

from pathlib import Path

from ...errors import UsageError
from .csv_import import read_csv
from .reader import BYTES_MAX, NAME, RegisterMap, read


def name_of(file: Path) -> str:
    """What the model of that file is called. Raises UsageError where it can be called nothing."""
    name = file.stem.casefold().replace("_", "-").replace(" ", "-")
    if not NAME.fullmatch(name):
        raise UsageError(f"a register map is called by small letters, digits and dashes, 40 at most, not {name[:60]!r}")
    return name


def is_table(file: Path) -> bool:
    """Whether it is a table, by its name."""
    return file.suffix.casefold() in (".csv", ".tsv")


def read_file(file: Path) -> RegisterMap:
    """The map in it. Raises UnreadableMap with every mistake, UsageError for its name, OSError."""
    with file.open("rb") as opened:
        content = opened.read(BYTES_MAX + 1)
    return read_csv(name_of(file), content)[0] if is_table(file) else read(name_of(file), content)
