"""Runs pip with one line on the terminal: what it does, and a bar that fills; all that pip says only when it fails.

    python scripts/pip_with_bar.py "installing stepscope into .venv" install --editable .

Standard library only: it runs before anything is installed.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WIDTH = 30
LOOKED_UP_SHARE = 0.7
"""Of the bar: pip names each package as it fetches it, and then is silent until all are installed."""


def expected() -> int:
    """How many packages come, about: as many as the image installs."""
    pins = (ROOT / "docker" / "requirements.txt").read_text(encoding="utf-8").splitlines()
    return sum("==" in line for line in pins)


def shares(lines: Iterable[str], total: int) -> Iterator[float]:
    """How far pip is after each line of its output, 0 to 1."""
    fetched = 0
    done = 0.0
    for line in lines:
        if line.startswith("Collecting "):
            fetched += 1
            done = min(fetched / total, 1.0) * LOOKED_UP_SHARE
        elif line.startswith("Installing collected packages"):
            done = LOOKED_UP_SHARE
        elif line.startswith("Successfully installed"):
            done = 1.0
        yield done


def bar(title: str, share: float) -> str:
    """The line as it stands on the terminal."""
    full = round(WIDTH * share)
    return f"{title} [{'#' * full}{'.' * (WIDTH - full)}]"


def main(arguments: Sequence[str]) -> int:
    """Run pip; its exit code."""
    title, *rest = arguments
    live = sys.stdout.isatty()
    print(bar(title, 0.0) if live else title, end="" if live else "\n", flush=True)
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", rest[0], "--progress-bar=off", *rest[1:]]
    said: list[str] = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        assert process.stdout is not None

        def heard(lines: Iterable[str]) -> Iterator[str]:
            for line in lines:
                said.append(line)
                yield line

        for share in shares(heard(process.stdout), expected()):
            if live:
                print(f"\r{bar(title, share)}", end="", flush=True)
    if process.returncode:
        print("\n" + "".join(said), file=sys.stderr)
    elif live:
        print(f"\r{bar(title, 1.0)}")
    return process.returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
