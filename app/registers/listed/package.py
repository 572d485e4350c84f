"""What the installed package lists, told from its files alone: nothing of it is imported for that.

The package is PyTrinamic (docs/sources.md), the extra `pytrinamic`. Each module is one class in a file of its own,
which makes one object a motor.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from importlib import metadata, util
from pathlib import Path

PACKAGE = "pytrinamic"
EXTRA = f'pip install "stepscope[{PACKAGE}]"'
FILE_BYTES_MAX = 1 << 20
"""No file of the package is a tenth as long: what is longer is not read."""

_CLASS = re.compile(r"^class (\w+)\(TMCLModule\):\s*(?:\"\"\"(.*?)\"\"\")?", re.MULTILINE | re.DOTALL)
_MOTORS = re.compile(r"self\.motors\s*=\s*\[(.*?)\]", re.DOTALL)
_TITLE = re.compile(r"^([A-Z]+)(\d)")


@dataclass(frozen=True, slots=True)
class Listing:
    """A module as its file tells it, before its parameters were read."""

    name: str
    title: str
    summary: str
    axes: int
    class_name: str

    @property
    def module(self) -> str:
        """What has to be imported for its parameters."""
        return f"{PACKAGE}.modules.{self.class_name}"


@cache
def version() -> str | None:
    """The version of the installed package; None where it is not installed."""
    try:
        return metadata.version(PACKAGE)
    except metadata.PackageNotFoundError:
        return None


@cache
def listings() -> dict[str, Listing]:
    """Every module of the installed package, by name; empty where it is not installed."""
    found = util.find_spec(PACKAGE)
    if found is None or not found.submodule_search_locations:
        return {}
    folder = Path(found.submodule_search_locations[0]) / "modules"
    listed = (listing_of(path) for path in sorted(folder.glob("*.py")))
    return {listing.name: listing for listing in listed if listing is not None}


def listing_of(path: Path) -> Listing | None:
    """The module that the file is about; None where it is about none, or cannot be read."""
    try:
        if path.stat().st_size > FILE_BYTES_MAX:
            return None
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return None
    declared = next((found for found in _CLASS.finditer(text) if found[1] == path.stem), None)
    if declared is None:
        return None
    title = _TITLE.sub(r"\1-\2", path.stem).replace("_", "-")
    motors = _MOTORS.search(text)
    axes = 0 if motors is None else motors[1].count("(")
    return Listing(title.lower(), title, _summary(declared[2] or ""), axes, path.stem)


def _summary(docstring: str) -> str:
    """The first sentence, in one line."""
    return re.split(r"(?<=[a-z)])\.\s|\n\s*\n|\n\s*\*", docstring.strip())[0].replace("\n", " ").strip().rstrip(".")
