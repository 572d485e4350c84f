"""What `make` would do: a word of the README brings all that its server shows."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("word", ["run", "dev"])
def test_a_server_comes_with_its_help(word: str) -> None:
    done = subprocess.run(
        ["make", "--dry-run", "--always-make", word], cwd=ROOT, capture_output=True, text=True, timeout=30, check=True
    )
    assert "scripts/help_site.py build" in done.stdout
