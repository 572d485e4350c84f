"""`make run` in a fresh clone: what it prints, how its bar moves, and how long it takes until the server answers."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from tests.bench.table import Row
from tests.make_run import make_run

ROOT = Path(__file__).parents[2]
LINES = 10
"""A handful, in two hands."""
WITHIN_S = 1200.0


def measure(quick: bool) -> Sequence[Row]:
    """Clone what is committed here, and type it. `quick` makes no difference: an install is one."""
    del quick
    with tempfile.TemporaryDirectory() as name:
        clone = Path(name) / "stepscope"
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
        printed = make_run(clone, Path(name) / "data", WITHIN_S)
    count = len(printed.lines)
    return [
        Row(
            what="make run in a fresh clone: lines until it says where it is",
            measured=f"{count} lines, a bar that moved {printed.redrawn} times",
            peer=f"limit {LINES} lines",
            ratio=LINES / count,
            required=">= 1",
            ok=count <= LINES and printed.redrawn > 0 and printed.address_s > 0,
            notes=(f"{printed.address_s:.0f} s with all that pip and npm fetch",),
        )
    ]
