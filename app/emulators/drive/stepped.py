"""Runs a drive that follows steps from outside through a stretch of time, with the steps that come in it."""

from __future__ import annotations

from pathlib import Path

from ...kernels import Kernels
from .kernel import Cells, Floats, advance, take_steps

compiled = Kernels(__file__, Path(__file__).with_name("kernel.py"), plain=True).compiled


@compiled
def advance_by_steps(s: Cells, f: Floats, table: Floats, clocks: Cells, counts: Cells) -> None:
    """Have `counts[n]` steps (signed) come by clock `clocks[n]`, one after another; the clocks rise."""
    for n in range(len(clocks)):
        take_steps(s, counts[n])
        advance(s, f, table, clocks[n])
