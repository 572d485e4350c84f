"""Emulation in jumps equals the tick-by-tick oracle, over wild settings, sensible trips and changes on the fly."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.emulators.tmc428.options import StageOptions
from tests.emulators.lockstep import Chaos, Pair, Trips

# kind, both chips' dividers from..to, step/dir, seeds, ticks a seed, rounds a seed, base ticks that this must come to
RUNS = [
    (Chaos, (0, 3), False, range(100, 118), 30_000, 60, 450_000),
    (Trips, (0, 3), False, range(200, 214), 40_000, 40, 450_000),
    (Trips, (3, 6), False, range(300, 310), 200_000, 30, 1_700_000),
    (Trips, (3, 6), False, range(310, 320), 200_000, 30, 1_700_000),
    (Trips, (3, 6), False, range(320, 330), 200_000, 30, 1_700_000),
    (Chaos, (3, 8), False, range(400, 416), 300_000, 50, 4_300_000),
    (Chaos, (0, 3), True, range(500, 525), 20_000, 60, 450_000),
    (Trips, (0, 4), True, range(600, 615), 40_000, 40, 500_000),
]


@pytest.mark.parametrize(("kind", "dividers", "step_dir", "seeds", "ticks", "rounds", "floor"), RUNS)
def test_jumps_equal_single_ticks(
    kind: type[Chaos],
    dividers: tuple[int, int],
    step_dir: bool,
    seeds: range,
    ticks: int,
    rounds: int,
    floor: int,
) -> None:
    played = 0
    for seed in seeds:
        run = kind(seed, dividers, step_dir)
        run.play(ticks, rounds)
        played += run.pair.clock // 32
    assert played >= floor


def test_the_runs_come_to_ten_million_ticks() -> None:
    assert sum(run[-1] for run in RUNS) >= 10_000_000


WIDE = StageOptions(left_at_fullsteps=-1e6, right_at_fullsteps=1e6, ref_from_fullsteps=9e5, ref_to_fullsteps=9e5)
WORDS = st.tuples(
    st.sampled_from((0x0, 0x1, 0x2, 0x3, 0x4, 0x5, 0x6, 0x9, 0xA, 0xB, 0xC, 0xD, 0xE)),
    st.one_of(st.integers(0, 40), st.integers(0, 0xFFFFFF)),
    st.integers(1, 40_000),
)


@settings(max_examples=120, deadline=None)
@given(st.lists(WORDS, min_size=1, max_size=12), st.booleans())
def test_any_sequence_of_writes_equals_single_ticks(writes: list[tuple[int, int, int]], step_dir: bool) -> None:
    """Small cases, so that hypothesis can shrink what fails; dividers stay low to see much in few ticks."""
    pair = Pair(step_dir, "left-only", [WIDE] * (1 if step_dir else 3))
    pair.write(0x03, 2047)
    pair.write(0x06, 400)
    for address, data, clocks in writes:
        pair.write(address, data & 0x3307 if address == 0xC else data)
        pair.run(clocks)
        pair.check()


def _pair(**registers: int) -> Pair:
    """A pair whose motor 1 has these registers (by offset name), dividers 0, RAMP_MODE, no stops."""
    pair = Pair(False, "left-only", [WIDE] * 3)
    offsets = {"v_min": 0x2, "v_max": 0x3, "a_max": 0x6, "p": 0x9, "x_actual": 0x1, "x_target": 0x0}
    pair.write(0xA, 0x300)
    for name, value in registers.items():
        pair.write(offsets[name], value & 0xFFFFFF)
    return pair


def _watch(pair: Pair, ticks: int, points: int = 40) -> None:
    for _ in range(points):
        pair.run(32 * ticks // points)
        pair.check()


def test_wraparound_of_the_position() -> None:
    pair = _pair(v_min=1, v_max=2047, a_max=300, p=300 * 8 | 4, x_actual=0x7FFF00, x_target=0x800100)
    _watch(pair, 6000)
    assert pair.oracle.axes[0].x == -0x7FFF00


def test_v_max_lowered_in_motion() -> None:
    pair = _pair(v_min=1, v_max=2047, a_max=500, p=0x5003, x_target=3000)
    _watch(pair, 1500)
    pair.write(0x3, 100)
    _watch(pair, 3000)
    assert pair.oracle.axes[0].v8 == 100 * 256


@pytest.mark.parametrize("mode", [0, 1, 2, 3])
def test_every_mode_change_in_motion(mode: int) -> None:
    for later in range(4):
        pair = _pair(v_min=1, v_max=1500, a_max=300, p=0x5003, x_target=2000)
        pair.write(0xA, 0x300 | mode)
        pair.write(0x4, 1200)
        pair.write(0x5, 900)
        _watch(pair, 700)
        pair.write(0xA, 0x300 | later)
        _watch(pair, 3000)


def test_a_max_zero_in_motion() -> None:
    pair = _pair(v_min=1, v_max=2047, a_max=500, p=0x5003, x_target=3000)
    _watch(pair, 500)
    pair.write(0x6, 0)
    _watch(pair, 20_000)
    assert pair.oracle.axes[0].v8 != 0


def test_v_min_zero_need_not_reach_the_target() -> None:
    pair = _pair(v_min=0, v_max=2047, a_max=1, p=0x000D, x_target=60)
    _watch(pair, 40_000)


def test_far_too_large_p_swings_about_the_target() -> None:
    pair = _pair(v_min=1, v_max=2047, a_max=20, p=0x7F00, x_target=500)
    crossings = 0
    for _ in range(60):
        before = pair.oracle.axes[0].x - 500
        _watch(pair, 1000, points=2)
        crossings += (pair.oracle.axes[0].x - 500) * before < 0
    assert crossings > 3
