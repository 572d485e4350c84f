"""The N line of an external encoder, between two ticks: every count that the shaft has passed has its say."""

from __future__ import annotations

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.emulators.drive import Drive, DriveOptions
from app.emulators.drive import kernel as k

from .rig import F_CLK

MODES = st.integers(0, 0x7FF)
CLEAR_CONT, LATCH_X_TOO, BOTH_EDGES, POL_N, IGNORE_AB = 1 << 4, 1 << 9, 3 << 6, 1 << 2, 1 << 3
OF_N = (k.N_ONCE, k.N_FLAG, k.N_AT, k.N_ON, k.N_LOW, k.N_HIGH, k.XLATCH, k.ENC_LATCH)
OF_ENCODER = (k.E_BASE, k.E_BASE_COUNTS)


def armed(lines: int, mode: int, once: bool, start: int) -> Drive:
    drive = Drive(DriveOptions(rigid=True, n_line=True, encoders={"external_lines": lines}))
    drive.write("XACTUAL", 4711)
    s = drive._s
    s[k.N_MODE], s[k.N_ONCE], s[k.N_AT] = mode, once, start
    k.n_bounds(s)
    return drive


def seen(drive: Drive) -> list[int]:
    return [int(drive._s[cell]) for cell in (*OF_N, *(k.EXTERNAL + cell for cell in OF_ENCODER))]


def turn(drive: Drive, counts: int) -> None:
    """As a tick does that ends at this count."""
    s = drive._s
    if counts < s[k.N_LOW] or counts > s[k.N_HIGH]:
        k.look_for_n(s, counts)
    else:
        s[k.N_AT] = counts


@given(
    lines=st.integers(1, 300),
    mode=MODES,
    once=st.booleans(),
    start=st.integers(-3000, 3000),
    moved=st.integers(-9000, 9000).filter(bool),
)
def test_a_jump_over_many_counts_is_as_all_of_them_one_by_one(
    lines: int, mode: int, once: bool, start: int, moved: int
) -> None:
    jumping, counting = (armed(lines, mode, once, start) for _ in range(2))
    for count in range(start, start + moved, 1 if moved > 0 else -1):
        turn(counting, count + (1 if moved > 0 else -1))
    turn(jumping, start + moved)
    assert seen(jumping) == seen(counting)


@pytest.mark.parametrize("mode", [IGNORE_AB, CLEAR_CONT | IGNORE_AB | POL_N, CLEAR_CONT | BOTH_EDGES | LATCH_X_TOO])
def test_the_finest_encoder_on_the_fastest_motor_costs_next_to_nothing(mode: int) -> None:
    """One by one, a second of the chip at full speed took a quarter of an hour."""
    drive = Drive(DriveOptions(rigid=True, n_line=True, encoders={"external_lines": 1 << 20}))
    for name, value in {"AMAX": 65_535, "A1": 65_535, "VMAX": 8_388_096, "CHOPCONF": 0x0841_0155}.items():
        drive.write(name, value)
    drive.write("ENCMODE", CLEAR_CONT | mode)
    drive.write("RAMPMODE", 1)
    until = drive.clocks + round(0.05 * F_CLK)
    drive.advance(256)  # not the time in which it is compiled
    began_s = time.thread_time()
    while drive.advance(until) is not None:
        pass
    assert time.thread_time() - began_s < 0.05
    assert drive.external.counts > 100_000_000
    assert drive.read("ENC_STATUS") & 1
