"""The law of the house: outside its own folders nobody names a model or a family.

What still does is counted by room, with the reason. A count may only go down.
"""

from __future__ import annotations

import io
import re
import tokenize
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FAMILY_FOLDERS = {"tmc428", "tmc4361", "tmc5xxx", "tmcl"}
REGISTRIES = {"app/registers/catalog.py", "app/devices/families.py"}
NAME = re.compile(r"tmc[_-]?\d{3,4}|tmc5xxx|pd42|tmcm|\b1241\b|sixpoint|landungs", re.IGNORECASE)

STILL_NAME_ONE = {
    "app": (3, "the demo and the composition root say which chips stand on the bench"),
    "app/api": (19, "schemas of emulators and calculators, and views, are written by hand, one a family"),
    "app/calc": (9, "units, formats and calculators lie by subject, several families in one folder"),
    "app/devices": (10, "limits lie beside the drivers, and start-up and signs know families"),
    "app/emulator_server": (4, "one option set and one control port a family"),
    "app/emulators": (8, "boards carry chips of three families; the builder knows all"),
    "app/links": (8, "datagrams bear their chip's name; kinds of links know who speaks them"),
    "app/procedures": (4, "which procedure is whose is chosen by driver class"),
    "app/profiles": (8, "order of writing and preconditions differ by family"),
    "app/registers": (1, "the evaluation board's tables"),
    "web/src": (53, "the page asks for families, not yet for what a device can"),
}


def without_words(path: Path) -> str:
    """The code of a file, without comments and docstrings: prose may say which chip does what."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return re.sub(r"/\*[\s\S]*?\*/|(?<!:)//.*", "", text)
    kept, fresh = [], True
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT or (token.type == tokenize.STRING and fresh and "import" not in token.line):
            continue
        if token.type not in (tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT):
            kept.append(token.string)
        fresh = token.type in (tokenize.NEWLINE, tokenize.NL, tokenize.INDENT, tokenize.DEDENT, tokenize.ENCODING)
    return "\n".join(kept)


def room_of(path: str) -> str:
    parts = path.split("/")
    return "web/src" if parts[0] == "web" else "/".join(parts[:2]) if len(parts) > 2 else parts[0]


@pytest.fixture(scope="module")
def naming() -> dict[str, list[str]]:
    found: dict[str, list[str]] = {room: [] for room in STILL_NAME_ONE}
    for folder, suffixes in (("app", {".py"}), ("web/src", {".ts", ".tsx"})):
        for path in sorted((ROOT / folder).rglob("*")):
            name = path.relative_to(ROOT).as_posix()
            if path.suffix not in suffixes or ".test." in name or name in REGISTRIES or name.endswith("schema.d.ts"):
                continue
            if FAMILY_FOLDERS & set(path.relative_to(ROOT).parts[:-1]) or path.name.startswith(("tmc", "sixpoint")):
                continue
            if NAME.search(without_words(path)):
                found.setdefault(room_of(name), []).append(name)
    return found


def test_nobody_else_names_a_family(naming: dict[str, list[str]]) -> None:
    more = {room: files for room, files in naming.items() if len(files) > STILL_NAME_ONE.get(room, (0, ""))[0]}
    assert not more, "ask for a capability instead, or move it into the family's folder"


def test_the_list_says_no_more_than_there_is(naming: dict[str, list[str]]) -> None:
    counted = Counter({room: len(files) for room, files in naming.items()})
    assert {room: counted[room] for room in STILL_NAME_ONE} == {
        room: most for room, (most, _) in STILL_NAME_ONE.items()
    }
