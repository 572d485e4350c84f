"""Runs a TMC4361 from clock to clock and notes how many steps its step output has given by each."""

from __future__ import annotations

from pathlib import Path

from ...kernels import Kernels
from . import layout as c
from .kernel import advance
from .layout import Cells, Floats

_HERE = Path(__file__).parent
compiled = Kernels(*_HERE.rglob("*.py"), _HERE.parent / "drive/kernel.py", plain=True, views=True).compiled


@compiled
def record(r: Cells, s: Cells, f: Floats, fb: Floats, clocks: Cells, sent: Cells) -> int:
    """`sent[n]`: steps forwards less those backwards by clock `clocks[n]`; the clocks rise.

    Returns how many of them were reached: fewer where START is watched and has changed.
    """
    for n in range(len(clocks)):
        advance(r, s, f, fb, clocks[n], 0)
        if s[c.CLOCK] < clocks[n]:
            return n
        sent[n] = s[c.NET]
    return len(clocks)
