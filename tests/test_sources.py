"""docs/sources.md: nothing is cited that it does not name."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from app.registers.catalog import MODELS

ROOT = Path(__file__).parent.parent
NAMED = set(
    re.findall(
        r"[\w.-]+", " ".join(re.findall(r"^\| ([^|]+) \|", (ROOT / "docs/sources.md").read_text(), re.MULTILINE))
    )
)
KEY = re.compile(r"\b(?:DS|FM|AN|NOTES)-[A-Z0-9]+(?:-[A-Z0-9]+)*\b(?![(\\])")
CITING = [
    path
    for folder, pattern in (("app", "*.py"), ("tests", "*.py"), ("docs", "*.md"), ("web/src", "*.ts*"))
    for path in sorted((ROOT / folder).rglob(pattern))
]


def test_every_document_that_is_cited_is_named() -> None:
    cited = {key: path for path in CITING for key in KEY.findall(path.read_text(encoding="utf-8"))}
    assert len(cited) > 8
    assert {key: str(path) for key, path in cited.items() if key.removesuffix("A") not in NAMED} == {}


@pytest.mark.parametrize("model", MODELS)
def test_every_source_of_a_row_is_named(model: str) -> None:
    for row in MODELS[model].table:
        first, *more = [part.split()[0].rstrip(",") for part in re.sub(r"\([^)]*\)", "", row.source).split(";")]
        # What begins with a small letter is a remark about the sources before it.
        assert [key for key in (first, *more) if key not in NAMED and (key is first or not key[0].islower())] == []
