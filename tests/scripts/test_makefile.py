"""What `make` would do: a word of the README brings all that its server shows."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.make_run import ADDRESS, make_run

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("word", ["run", "dev"])
def test_a_server_comes_with_its_help(word: str) -> None:
    done = subprocess.run(
        ["make", "--dry-run", "--always-make", word], cwd=ROOT, capture_output=True, text=True, timeout=30, check=True
    )
    assert "scripts/help_site.py build" in done.stdout


def test_run_prints_a_handful_of_lines_and_the_address_and_ends_by_ctrl_c(tmp_path: Path) -> None:
    """Here all is installed. What it prints in a fresh clone is a row of the bench (`make run`)."""
    printed = make_run(ROOT, tmp_path / "data", within_s=100)
    assert ADDRESS.match(printed.lines[-1]), printed.lines
    assert len(printed.lines) <= 6, "a line for what was stale, if anything"
