"""What a row has judged so far, a file a plant, so that a later run goes on where an earlier one ended (`--resume`).

Kept in the user's cache by what was judged: the commit, and what differs from it in the working tree. A plant is its
seed, so that it does not matter which run has judged it.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import subprocess
import time
from collections.abc import Awaitable, Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from app.studies.proof import rate_bound, rate_shown

T = TypeVar("T")
ROOT = Path(__file__).parents[2]


@dataclass
class Keeping:
    """folder : where results are; None: each run begins anew. within_s : a row begins no further plant after that."""

    folder: Path | None = None
    within_s: float = float("inf")


KEEPING = Keeping()
"""Of this run: set by the command line."""


def cache() -> Path:
    """The folder of what is checked out now."""

    def git(*words: str) -> bytes:
        return subprocess.run(["git", *words], cwd=ROOT, check=True, capture_output=True).stdout

    state = git("rev-parse", "HEAD").decode().strip()[:12]
    more = git("diff", "HEAD")
    new = git("ls-files", "--others", "--exclude-standard", "-z").split(b"\0")
    if more or any(new):
        whole = hashlib.sha256(more)
        for name in filter(None, new):
            whole.update(name + (ROOT / os.fsdecode(name)).read_bytes())
        state += "-" + whole.hexdigest()[:12]
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return home / "stepscope" / "bench" / state


async def collected(
    row: str, seeds: Iterable[int], judge: Callable[[int], Awaitable[T]], keeping: Keeping, share: float = 1.0
) -> list[T]:
    """What `judge` says of each plant, one at the least; `share` of the time that a row has may pass meanwhile."""
    end_s = time.monotonic() + share * keeping.within_s
    found: list[T] = []
    for seed in seeds:
        path = None if keeping.folder is None else keeping.folder / row / f"{seed}.pickle"
        if path is not None and path.exists():
            found.append(pickle.loads(path.read_bytes()))
            continue
        if found and time.monotonic() > end_s:
            continue  # a later one may have been judged already
        found.append(await judge(seed))
        if path is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
            new = path.with_suffix(f".{os.getpid()}")
            new.write_bytes(pickle.dumps(found[-1]))
            new.replace(path)
    return found


def at_least(good: int, of: int) -> str:
    """How many, and what so many show (Clopper and Pearson, one-sided)."""
    return f"{good} of {of}: >= {rate_shown(good, of):.2f} with 95 %"


def at_most(wrong: int, of: int) -> str:
    """The same for a rate that is to be low."""
    return f"{wrong} of {of}: <= {rate_bound(wrong, of):.2f} with 95 %"
