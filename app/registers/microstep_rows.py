"""The microstep table as TMC4361 and TMC5xxx have it: eight words of differences, and what a bit of them means."""

from __future__ import annotations

from .model import Access, Field, Register

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
    return (
        *(
            Register(
                f"MSLUT[{n}]",
                32,
                f"differences of the quarter wave at places {32 * n} to {32 * n + 31}, one bit each",
                address=address + n,
                access=Access.W,
                reset=word,
                group=GROUP,
                source=source,
            )
            for n, word in enumerate(MSLUT_RESET)
        ),
        Register(
            "MSLUTSEL",
            32,
            "borders of the four segments of the quarter wave, and what a bit means in each",
            address=address + len(MSLUT_RESET),
            access=Access.W,
            reset=MSLUTSEL_RESET,
            group=GROUP,
            source=source_of_fields,
            fields=(
                *(
                    Field(
                        f"W{n}",
                        2,
                        f"differences that a 0 and a 1 stand for in segment {n}",
                        lsb=2 * n,
                        values={0: "-1 and 0", 1: "0 and 1", 2: "1 and 2", 3: "2 and 3"},
                    )
                    for n in range(4)
                ),
                *(Field(f"X{n}", 8, f"place at which segment {n} begins", lsb=8 * n) for n in (1, 2, 3)),
            ),
        ),
    )
