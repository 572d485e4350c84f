"""The microstep table as TMC4361 and TMC5xxx have it: eight words of differences, and what a bit of them means."""

from __future__ import annotations

from .build import Rows, W, choice
from .model import Field, Register

GROUP = "microsteps"
MSLUT_RESET = (
    0xAAAAB554,
    0x4A9554AA,
    0x24492929,
    0x10104222,
    0xFBFFFFFF,
    0xB5BB777D,
    0x49295556,
    0x00404222,
)
MSLUTSEL_RESET = 0xFFFF8056
START_RESET = 0xF70000
"""START_SIN 0, START_SIN90 247."""


def mslut_rows(address: int, source: str, source_of_fields: str) -> tuple[Register, ...]:
    """MSLUT[0] to MSLUT[7] from `address` on, and MSLUTSEL behind them; nobody can read them back."""
    row = Rows(GROUP, source)
    differences = {0: "-1 and 0", 1: "0 and 1", 2: "1 and 2", 3: "2 and 3"}
    borders = "borders of the four segments of the quarter wave, and what a bit means in each"
    return (
        *(
            row(
                address + n,
                f"MSLUT[{n}]",
                32,
                W,
                f"differences of the quarter wave at places {32 * n} to {32 * n + 31}, one bit each",
            ).having(reset=word)
            for n, word in enumerate(MSLUT_RESET)
        ),
        row(address + len(MSLUT_RESET), "MSLUTSEL", 32, W, borders).having(
            *(
                choice(2 * n, f"W{n}", 2, f"differences that a 0 and a 1 stand for in segment {n}", differences)
                for n in range(4)
            ),
            *(Field(f"X{n}", 8, f"place at which segment {n} begins", lsb=8 * n) for n in (1, 2, 3)),
            reset=MSLUTSEL_RESET,
            source=source_of_fields,
        ),
    )
