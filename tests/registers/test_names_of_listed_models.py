"""No file of ours names a model for being listed: names that the installed package alone knows occur nowhere."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest

from app.registers import catalog
from app.registers.listed import package
from tests.test_house import without_words

ROOT = Path(__file__).parent.parent.parent
NAMES = {
    name: re.compile(rf"(?<![a-z0-9]){name.replace('-', '[-_]?')}(?![0-9])", re.IGNORECASE)
    for name in package.listings()
    if name not in catalog.MODELS
}
BOARDS = {
    "tmc2100",
    "tmc2160",
    "tmc2208",
    "tmc2224",
    "tmc2225",
    "tmc4671",
    "tmc5041",
    "tmc5241",
    "tmc5262",
    "tmc5271",
    "tmc5272",
}
OTHERWISE: dict[str, tuple[frozenset[str], str]] = {
    "app/registers/evaluation_board.py": (
        frozenset(BOARDS),
        "the maker's numbers of boards, by what they carry: no list of the package has them",
    ),
    "app/registers/tmcl/commands.py": (frozenset({"tmcm-1290"}), "a source"),
}
"""Files that name one for something else than that it is listed, which, and for what."""


@cache
def named() -> dict[str, frozenset[str]]:
    """By file, the models that only the package knows and that its code or text names."""
    found = {}
    for folder, suffixes in (("app", {".py"}), ("web/src", {".ts", ".tsx", ".css"})):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix not in suffixes or path.name.endswith("schema.d.ts") or ".test." in path.name:
                continue
            text = without_words(path)
            names = frozenset(name for name, pattern in NAMES.items() if pattern.search(text))
            if names:
                found[path.relative_to(ROOT).as_posix()] = names
    return found


def test_the_package_lists_some_that_nobody_else_knows() -> None:
    assert len(NAMES) > 60


def test_no_file_names_one_for_being_listed() -> None:
    files = {file: names - OTHERWISE.get(file, (frozenset(), ""))[0] for file, names in named().items()}
    assert {file: names for file, names in files.items() if names} == {}


def test_each_exception_is_still_needed() -> None:
    assert {file: names for file, (names, _) in OTHERWISE.items()} == {
        file: names for file, names in named().items() if file in OTHERWISE
    }


@pytest.mark.parametrize("name", ["TMCM-1270", "tmcm_1270", "TMCM1270"])
def test_a_name_would_be_found_however_it_is_spelled(name: str) -> None:
    assert any(pattern.search(f'"{name}"') for pattern in NAMES.values())
