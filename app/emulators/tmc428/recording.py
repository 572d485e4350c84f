"""Runs a chip from clock to clock and notes how many steps its step/direction outputs have given by each."""

from __future__ import annotations

from pathlib import Path

from ...kernels import Kernels
from .kernel import NAXES, NET, Cells, advance

compiled = Kernels(__file__, Path(__file__).with_name("kernel.py"), plain=True).compiled


@compiled
def record(axes: Cells, chip: Cells, clocks: Cells, sent: Cells) -> None:
    """`sent[n, axis]`: steps forwards less those backwards by clock `clocks[n]`; the clocks rise."""
    for n in range(len(clocks)):
        advance(axes, chip, clocks[n])
        for i in range(chip[NAXES]):
            sent[n, i] = axes[i, NET]
