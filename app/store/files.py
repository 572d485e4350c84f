"""What every file that outlives a run needs: taking turns with other programs, and a name to set it aside under."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

if sys.platform != "win32":
    import fcntl


@contextlib.contextmanager
def exclusive(path: Path) -> Iterator[None]:
    """Keep other programs that ask the same from `path` meanwhile. Its directory is made. Raises OSError.

    Not for one thread twice: it would wait for itself.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    # A file of its own: what is replaced or set aside would take a lock on itself along.
    with path.with_name(path.name + ".lock").open("w") as lock:
        if sys.platform != "win32":
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def aside_name(path: Path) -> Path:
    """A name beside `path` that nothing has yet, for a file that cannot be read."""
    stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")
    number = 0
    while True:
        suffix = f"-{number}" if number else ""
        aside = path.with_name(f"{path.stem}.broken-{stamp}{suffix}{path.suffix}")
        if not aside.exists():
            return aside
        number += 1
