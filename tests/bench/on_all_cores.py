"""One measurement for each of many plants, in as many processes as there are cores."""

from __future__ import annotations

import multiprocessing
import os
import sys
from collections.abc import Callable, Sequence
from typing import TypeVar

One = TypeVar("One")


def on_all_cores(judge: Callable[[int], One], seeds: Sequence[int]) -> list[One]:
    """What `judge` tells of each seed, in their order; a line for each on standard error as it comes."""
    told: list[One] = []
    with multiprocessing.get_context("spawn").Pool(min(os.cpu_count() or 1, len(seeds))) as processes:
        for seed, one in zip(seeds, processes.imap(judge, seeds), strict=True):
            told.append(one)
            print(f"plant {seed}: {one}", file=sys.stderr, flush=True)
    return told
