"""The sections of the data sheets, and the tests that hold them."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest


@dataclass(frozen=True)
class Section:
    """One numbered section; `why_not` where it states nothing to test, `not_done` where nothing here does what it
    states, `facts` where our copy lacks its text."""

    n: str
    title: str
    why_not: str = ""
    not_done: str = ""
    facts: bool = False


@dataclass(frozen=True)
class Document:
    id: str
    name: str
    title: str
    sections: dict[str, Section]


@cache
def documents() -> dict[str, Document]:
    """Return the committed list by document number."""
    table = tomllib.loads(Path(__file__).with_name("sections.toml").read_text())
    found: dict[str, Document] = {}
    for row in table["document"]:
        sections = [Section(**section) for section in row["sections"]]
        by_number = {section.n: section for section in sections}
        if len(by_number) != len(sections):
            raise ValueError(f"sections.toml: a section of {row['id']} is listed twice")
        found[row["id"]] = Document(row["id"], row["name"], row["title"], by_number)
    return found


def marks(item: pytest.Item) -> Iterator[tuple[str, str]]:
    """Yield (document, section) of each `sheet` mark of a test. Raises UsageError for one that is not listed."""
    for mark in item.iter_markers("sheet"):
        if mark.kwargs or len(mark.args) != 2 or not all(isinstance(argument, str) for argument in mark.args):
            raise pytest.UsageError(f'{item.nodeid}: write @pytest.mark.sheet("DS-TMC428", "8.7.1"), not {mark.args!r}')
        document, section = mark.args
        if document not in documents() or section not in documents()[document].sections:
            raise pytest.UsageError(
                f"{item.nodeid}: no section {section} of document {document} in tests/conformance/sections.toml"
            )
        if reason := documents()[document].sections[section].not_done:
            raise pytest.UsageError(
                f"{item.nodeid}: section {section} of document {document} cannot be held: {reason} (sections.toml)"
            )
        yield document, section


def check(items: Iterable[pytest.Item]) -> None:
    """Refuse a collection in which a mark names an unknown section."""
    for item in items:
        for _ in marks(item):
            pass
