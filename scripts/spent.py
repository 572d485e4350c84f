"""Runs a command, and says how long it took and how busy it kept the machine: `python scripts/spent.py COMMAND`.

What the cores worked is what no other order of the same work could go below. All that ran meanwhile is counted, for a
browser's processes are nobody's children by the time they end.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

STAT = Path("/proc/stat")
IDLE, WAITS = 3, 4
"""Columns of a line of /proc/stat in which a core did nothing; guests, behind the first eight, are counted twice."""


def run(command: list[str]) -> int:
    """Run `command` to its end; returns its exit code."""
    began_s, before_s = time.monotonic(), _worked_s()
    code = subprocess.run(command, check=False).returncode
    took_s, after_s = time.monotonic() - began_s, _worked_s()
    said = f"took {took_s:.1f} s"
    if before_s is not None and after_s is not None:
        worked_s, cores = after_s - before_s, os.cpu_count() or 1
        said += (
            f", in which {cores} cores worked {worked_s:.1f} s, {worked_s / (took_s * cores):.0%} of the time: "
            f"the same work takes {worked_s / cores:.1f} s at least"
        )
    sys.stdout.write(f"{said}\n")
    return code


def _worked_s() -> float | None:
    """Of all cores, since the start of the machine [s]; None on a system that does not tell."""
    try:
        ticks = [int(word) for word in STAT.read_text().split("\n", 1)[0].split()[1:9]]
    except OSError:
        return None
    return (sum(ticks) - ticks[IDLE] - ticks[WAITS]) / os.sysconf("SC_CLK_TCK")


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
