"""The examples of docs/examples, each as a user runs it: a process of its own against a running server."""

from __future__ import annotations

import asyncio
import os
import re
import subprocess
import sys
from pathlib import Path

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"


async def output(server: str, name: str, *arguments: str) -> str:
    """What the example says; it has to end well."""
    done = await asyncio.to_thread(
        subprocess.run,
        [sys.executable, str(EXAMPLES / f"{name}.py"), *arguments],
        env={**os.environ, "STEPSCOPE_URL": server},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    return done.stdout


async def test_move_and_measure(server: str) -> None:
    said = await output(server, "move_and_measure", "bench", "--distance", "3200")
    assert "to 3200 microsteps" in said
    peak = re.search(r"peak velocity ([\d,]+) pps", said)
    assert peak is not None
    assert int(peak[1].replace(",", "")) > 100
    off = re.search(r"at most ([\d.]+) microsteps", said)
    assert off is not None
    assert float(off[1]) < 50


async def test_find_fastest_ramp(server: str) -> None:
    said = await output(server, "find_fastest_ramp", "bench", "--distance", "1600")
    times_s = [float(found) for found in re.findall(r": ([\d.]+) s$", said, re.MULTILINE)]
    assert len(times_s) >= 2
    assert times_s[1] < times_s[0]
    assert f"{min(times_s):.3f} s is what" in said


async def test_watch_all_axes(server: str) -> None:
    said = await output(server, "watch_all_axes", "--seconds", "0.3")
    assert [line.partition(":")[0] for line in said.splitlines()] == [
        "bench axis 0",
        "bench axis 1",
        "bench axis 2",
        "slider axis 0",
    ]


def test_every_example_is_tested() -> None:
    tested = Path(__file__).read_text()
    assert [path.stem for path in EXAMPLES.glob("*.py") if f'"{path.stem}"' not in tested] == []
