"""Runs a command, and says how long it took and how much of the machine it used: `python scripts/spent.py COMMAND`.

The processor time of the work, over all cores, is what no other order of it could go below.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import time


def run(command: list[str]) -> int:
    """Run `command` to its end; returns its exit code."""
    began_s = time.monotonic()
    before = _worked_s()
    code = subprocess.run(command, check=False).returncode
    took_s = time.monotonic() - began_s
    worked_s, cores = _worked_s() - before, len(os.sched_getaffinity(0))
    sys.stdout.write(
        f"took {took_s:.1f} s, {worked_s:.1f} s of processor time: {worked_s / (took_s * cores):.0%} of {cores} cores, "
        f"on which the same work takes {worked_s / cores:.1f} s at least\n"
    )
    return code


def _worked_s() -> float:
    """Of everything that was started from here and has ended [s]."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
