"""What a row judges of many plants: on all cores, and kept, so that a later run goes on where an earlier one ended.

A plant is its seed. With `--resume` what was judged of it is kept in the user's cache beside the digests of the sources
that it came of: all modules of ours that were loaded in its process. It counts as long as none of them has changed.
"""

from __future__ import annotations

import asyncio
import hashlib
import multiprocessing
import os
import pickle
import sys
import tempfile
import time
from collections.abc import Awaitable, Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from app.studies.proof import rate_bound, rate_shown

T = TypeVar("T")
ROOT = Path(__file__).parents[2]
Sources = dict[str, str]
"""Digest of each source, by its path below `ROOT`."""


@dataclass
class Keeping:
    """folder : where results are; None: each run begins anew. within_s : a row begins no further plant after that."""

    folder: Path | None = None
    within_s: float = float("inf")


KEEPING = Keeping()
"""Of this run: set by the command line."""


def kept_results() -> Path:
    """The folder where results are kept from one run to the next."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "stepscope" / "bench"


def collected(
    row: str,
    judge: Callable[[int, Path], Awaitable[T]],
    seeds: Sequence[int],
    *,
    share: float = 1.0,
    keeping: Keeping = KEEPING,
) -> dict[int, T]:
    """What `judge` says of each plant by its seed, one at the least; `share` of the row's time may pass meanwhile.

    judge : runs in a process of its own kind, with the seed and an empty folder; what it says can be pickled
    """
    end_s = time.monotonic() + share * keeping.within_s
    paths = {seed: None if keeping.folder is None else keeping.folder / row / f"{seed}.pickle" for seed in seeds}
    found: dict[int, T] = {}
    for seed, path in paths.items():
        for one in () if path is None else _kept(path):
            found[seed] = one
    waiting = [seed for seed in seeds if seed not in found]
    if waiting:
        cores = min(os.cpu_count() or 1, len(waiting))
        with ProcessPoolExecutor(cores, multiprocessing.get_context("spawn")) as processes:
            running: dict[Future[tuple[T, Sources, float]], int] = {}
            while True:
                while waiting and len(running) < cores and (time.monotonic() < end_s or not (found or running)):
                    seed = waiting.pop(0)
                    running[processes.submit(_judged, judge, seed)] = seed
                if not running:
                    break
                for done in wait(running, return_when=FIRST_COMPLETED).done:
                    seed = running.pop(done)
                    found[seed], sources, took_s = done.result()
                    print(f"{row}: plant {seed} in {took_s:.0f} s", file=sys.stderr, flush=True)
                    if path := paths[seed]:
                        _keep(path, sources, found[seed])
    return {seed: found[seed] for seed in seeds if seed in found}


def _judged(judge: Callable[[int, Path], Awaitable[T]], seed: int) -> tuple[T, Sources, float]:
    began_s = time.monotonic()
    _loaded()

    async def judged(folder: Path) -> T:
        return await judge(seed, folder)

    with tempfile.TemporaryDirectory() as folder:
        found = asyncio.run(judged(Path(folder)))
    return found, _loaded(), time.monotonic() - began_s


@cache
def _digest(path: Path) -> str:
    """Of a source as it was when it was first looked at, which is when it was loaded."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _loaded() -> Sources:
    paths = (Path(name) for module in list(sys.modules.values()) if (name := getattr(module, "__file__", None)))
    ours = (path for path in paths if path.is_relative_to(ROOT) and ".venv" not in path.parts)
    return {str(path.relative_to(ROOT)): _digest(path) for path in ours}


def _keep(path: Path, sources: Sources, found: object) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    new = path.with_suffix(f".{os.getpid()}")
    new.write_bytes(pickle.dumps(sources) + pickle.dumps(found))
    new.replace(path)


def _kept(path: Path) -> Iterable[Any]:
    """What was judged by the present sources, if anything was."""
    if not path.exists():
        return ()
    with path.open("rb") as file:
        sources: Sources = pickle.load(file)
        same = all((ROOT / name).exists() and _digest(ROOT / name) == digest for name, digest in sources.items())
        return (pickle.load(file),) if same else ()


def at_least(good: int, of: int) -> str:
    """How many, and what so many show (Clopper and Pearson, one-sided)."""
    return f"{good} of {of}: >= {rate_shown(good, of):.2f} with 95 %"


def at_most(wrong: int, of: int) -> str:
    """The same for a rate that is to be low."""
    return f"{wrong} of {of}: <= {rate_bound(wrong, of):.2f} with 95 %"
