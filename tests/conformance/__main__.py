"""Collects every test, runs none, and prints which sections of the data sheets are held by marked tests."""

from __future__ import annotations

import contextlib
import io
import sys
from collections import defaultdict

import pytest

from tests.conformance.sections import Document, documents, marks


class Collector:
    """A pytest plugin that keeps, for each section, the tests that are marked with it."""

    def __init__(self) -> None:
        self.tests: dict[tuple[str, str], set[str]] = defaultdict(set)

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        for item in session.items:
            for document_and_section in marks(item):
                self.tests[document_and_section].add(item.nodeid)


def report(document: Document, tests: dict[tuple[str, str], set[str]]) -> tuple[list[str], int, int, set[str]]:
    """Return the lines about one document, its covered and its testable sections, and the tests that hold it."""
    lines = [f"{document.id}  {document.title}"]
    gaps, covered, testable = [], 0, 0
    held: set[str] = set()
    for number, section in document.sections.items():
        here = tests.get((document.id, number), set())
        held |= here
        if section.why_not and not here:
            continue
        testable += 1
        covered += bool(here)
        note = "   [known from other sources]" if section.facts else ""
        if here:
            lines.append(f"    {number:<10} {len(here):>5}  {section.title}{note}")
        else:
            reason = f": {section.not_done}" if section.not_done else ""
            gaps.append(f"    {number:<10}   gap  {section.title}{reason}{note}")
    silent = [section for number, section in document.sections.items() if section.why_not]
    lines += gaps
    lines.append(f"    {covered} of {testable} sections covered, {len(held)} statements tested, {len(gaps)} gaps")
    lines.append(f"    ({len(silent)} sections state nothing to test: drawings, circuitry, notation, overviews)")
    return lines, covered, testable, held


def main() -> int:
    """Print the report; 1 when a mark is wrong or the tests cannot be collected."""
    collector = Collector()
    log = io.StringIO()
    with contextlib.redirect_stdout(log):
        code = pytest.main(["--collect-only", "-qq", "-p", "no:cacheprovider"], plugins=[collector])
    if code != pytest.ExitCode.OK:
        print(log.getvalue(), file=sys.stderr)
        return 1
    covered = testable = 0
    held: set[str] = set()
    for document in documents().values():
        lines, here, of, by = report(document, collector.tests)
        print("\n".join(lines), end="\n\n")
        covered, testable, held = covered + here, testable + of, held | by
    print(f"total: {covered} of {testable} sections covered, {len(held)} statements tested")
    return 0


if __name__ == "__main__":
    sys.exit(main())
