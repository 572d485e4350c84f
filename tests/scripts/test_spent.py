"""What a command used of the machine is told with its end, and its exit code is passed on."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

SPENT = Path(__file__).parents[2] / "scripts" / "spent.py"
WORKS = "import subprocess, sys, time; subprocess.run([sys.executable, '-c', {work!r}]); sys.exit(3)"
BUSY = "import time\nwhile time.process_time() < 0.5: pass"


def test_it_tells_how_busy_a_command_and_what_it_started_kept_the_cores() -> None:
    ran = subprocess.run(
        [sys.executable, str(SPENT), sys.executable, "-c", WORKS.format(work=BUSY)],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert ran.returncode == 3
    if not Path("/proc/stat").exists():
        assert re.fullmatch(r"took [\d.]+ s\n", ran.stdout)
        return
    told = re.fullmatch(
        r"took ([\d.]+) s, in which (\d+) cores worked ([\d.]+) s, (\d+)% .* takes ([\d.]+) s at least\n", ran.stdout
    )
    assert told is not None, ran.stdout
    took_s, cores, worked_s, share, least_s = (float(group) for group in told.groups())
    assert 0.4 <= worked_s <= took_s * cores + 0.2  # /proc/stat counts in hundredths
    assert abs(least_s - worked_s / cores) <= 0.1
    assert abs(share - 100 * worked_s / (took_s * cores)) <= 12  # of figures that were rounded
