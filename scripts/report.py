"""Prints which part of each room's lines the tests ran, and the most complex functions; `make report` runs it.

Figures to think with, and no limits. Measured is this process alone, and not what numba compiles: kernels and servers
that tests start look emptier than they are.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LISTED = 20
SIMPLE = 10
"""Cyclomatic complexity up to which ruff does not tell of a function."""


def room_of(path: str) -> str:
    """The folder below app/ that a file lies in; of a file in app/ itself, app/."""
    parts = Path(path).parts
    return "/".join(parts[:2]) if len(parts) > 2 else parts[0]


def print_coverage() -> None:
    """Print a line a room from the data that pytest --cov left. Raises SystemExit where there is none."""
    command = [sys.executable, "-m", "coverage", "json", "-q", "-o", "-"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"no coverage to report, run `make report`: {done.stdout}{done.stderr}".strip())
    lines: Counter[str] = Counter()
    missing: Counter[str] = Counter()
    for path, file in json.loads(done.stdout)["files"].items():
        for name in (room_of(path), "all"):
            lines[name] += file["summary"]["num_statements"]
            missing[name] += file["summary"]["missing_lines"]
    print(f"{'room':<24}{'statements':>11}{'not run':>9}{'run':>8}")
    for name in sorted(lines, key=lambda each: (each == "all", each)):
        share = f"{1 - missing[name] / lines[name]:.1%}" if lines[name] else "-"
        print(f"{name:<24}{lines[name]:>11}{missing[name]:>9}{share:>8}")


def print_complexity() -> None:
    """Print the functions of app/ and scripts/ with the most ways through them, by ruff's count (C901)."""
    ruff = str(Path(sys.executable).with_name("ruff"))
    limit = f"lint.mccabe.max-complexity={SIMPLE}"
    command = [ruff, "check", "--select", "C901", "--config", limit, "--output-format", "json", "--exit-zero"]
    done = subprocess.run([*command, "app", "scripts"], cwd=ROOT, capture_output=True, text=True, check=True)
    found = []
    for each in json.loads(done.stdout):
        name, count = re.findall(r"`(.+?)` is too complex \((\d+)", each["message"])[0]
        place = f"{Path(each['filename']).relative_to(ROOT).as_posix()}:{each['location']['row']}"
        found.append((int(count), name, place))
    print(f"\ncomplexity above {SIMPLE}: {len(found)} functions" + (f", the first {LISTED}" * (len(found) > LISTED)))
    for complexity, name, place in sorted(found, key=lambda each: (-each[0], each[2]))[:LISTED]:
        print(f"{complexity:>4}  {name:<36} {place}")


if __name__ == "__main__":
    print_coverage()
    print_complexity()
