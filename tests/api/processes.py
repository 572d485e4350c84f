"""Programs of this repository as a user starts them: each in a process of its own."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

STEPSCOPE = [sys.executable, "-c", "from app.cli import main; main()"]


@contextmanager
def running(*arguments: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A process that has said that it is ready, and how; what it warns of before is not yet that."""
    process = subprocess.Popen(
        [*STEPSCOPE, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment()
    )
    assert process.stdout is not None
    try:
        line = process.stdout.readline()
        while line.startswith("WARNING"):
            line = process.stdout.readline()
        yield process, line
    finally:
        if process.poll() is None:
            process.kill()
        process.wait()
        process.stdout.close()


def environment() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if not name.startswith("STEPSCOPE_")}


def address(line: str) -> str:
    found = re.search(r"http://\S+", line)
    assert found is not None, line
    return found.group()
