"""Regulation modes 2 and 3: against a slow reference, and what they do to a motor with a load."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.emulators.tmc4361.feedback.kernel import regulation_tick
from app.emulators.tmc4361.feedback.layout import ENC_POS as ENC_POS_CELL
from app.emulators.tmc4361.layout import FB_QUIET, FB_TARGET_OK
from tests.emulators.tmc4361.feedback.oracle import PlainPid
from tests.emulators.tmc4361.feedback.rig import (
    CL_TR_TOLERANCE,
    ENC_IN_CONF,
    ENC_POS,
    ENC_POS_DEV,
    ENC_VEL_ZERO,
    PID_ALONE,
    PID_CLIP,
    PID_D,
    PID_DV_CLIP,
    PID_E,
    PID_I,
    PID_ISUM,
    PID_OVER_RAMP,
    PID_P,
    PID_TOLERANCE,
    PID_VEL,
    Bench,
    loose,
)


@pytest.mark.sheet("DS-TMC4361", "17.19")
@settings(max_examples=60, deadline=None)
@given(
    p=st.integers(0, 1 << 16),
    i=st.integers(0, 1 << 12),
    d=st.integers(0, 1 << 8),
    i_clip=st.integers(0, 0x7FFF),
    dv_clip=st.integers(0, 1_000_000),
    divider=st.integers(0, 5),
    tolerance=st.integers(0, 50),
    base=st.booleans(),
    path=st.lists(st.tuples(st.integers(-100_000, 100_000), st.integers(-2000, 2000)), min_size=1, max_size=40),
)
def test_the_velocity_is_that_of_a_slow_reference(
    p: int,
    i: int,
    d: int,
    i_clip: int,
    dv_clip: int,
    divider: int,
    tolerance: int,
    base: bool,
    path: list[tuple[int, int]],
) -> None:
    bench = loose({PID_P: p, PID_I: i, PID_D: d, PID_CLIP: i_clip | divider << 16, PID_DV_CLIP: dv_clip})
    bench.write({PID_TOLERANCE: tolerance, ENC_IN_CONF: PID_OVER_RAMP if base else PID_ALONE})
    reference = PlainPid(p, i, d, i_clip, dv_clip, divider, tolerance, base)
    for x, deviation in path:
        bench.unit.fb[ENC_POS_CELL] = float(x - deviation)
        assert regulation_tick(bench.unit.fb, x, 1234.5) == reference.tick(x, x - deviation, 1234.5)
        assert bench.read(PID_E) == reference.error
        assert bench.read(PID_ISUM) == reference.isum
        assert bench.read(PID_VEL) == reference.v


def test_the_d_part_is_the_last_error_minus_this_one_as_the_sources_write_it() -> None:
    bench = loose({PID_D: 10, PID_DV_CLIP: 1 << 20, ENC_IN_CONF: PID_ALONE})
    for x, velocity in ((0, 0.0), (30, -300.0), (10, 200.0), (10, 0.0)):
        assert regulation_tick(bench.unit.fb, x, 0.0) == velocity


def test_the_d_part_is_sampled_at_its_divider() -> None:
    bench = loose({PID_D: 1, PID_DV_CLIP: 1 << 20, PID_CLIP: 4 << 16, ENC_IN_CONF: PID_ALONE})
    velocities = [regulation_tick(bench.unit.fb, x, 0.0) for x in range(0, 120, 10)]
    assert velocities == [0, 0, 0, -30, -30, -30, -30, -40, -40, -40, -40, -40]


def test_without_pid_the_ramps_velocity_goes_through() -> None:
    bench = loose({PID_P: 5000, PID_DV_CLIP: 1 << 20})
    bench.x = 1000
    assert regulation_tick(bench.unit.fb, 1000, 777.5) == 777.5


def test_another_modus_begins_with_a_clean_sum() -> None:
    bench = loose({PID_I: 100, PID_CLIP: 100, PID_DV_CLIP: 1 << 20, ENC_IN_CONF: PID_ALONE})
    for _ in range(100):
        regulation_tick(bench.unit.fb, 500, 0.0)
    assert bench.read(PID_ISUM) == 50_000
    bench.write({ENC_IN_CONF: PID_OVER_RAMP})
    assert bench.read(PID_ISUM) == 0


# --- with a motor ----------------------------------------------------------------------------------

GAINS = {PID_P: 256 * 40, PID_I: 100, PID_CLIP: 500, PID_DV_CLIP: 100_000, PID_TOLERANCE: 3}


def settled(**patch: float) -> Bench:
    """A motor that holds its place, ENC_POS set to XACTUAL."""
    bench = Bench({ENC_VEL_ZERO: 16_000})
    bench.run(0.3)
    bench.write({ENC_POS: 0})
    bench.change(**patch)
    bench.run(0.3)
    return bench


@pytest.mark.sheet("DS-TMC4361", "14.4")
@pytest.mark.parametrize("modus", [PID_ALONE, PID_OVER_RAMP])
@pytest.mark.parametrize("load_nm", [0.15, -0.15])
def test_pid_takes_away_the_deviation_that_a_load_makes(modus: int, load_nm: float) -> None:
    bench = settled(load_torque_nm=load_nm)
    before = bench.read(ENC_POS_DEV)
    assert abs(before) > 40
    assert math.copysign(1, before) == -math.copysign(1, load_nm)
    bench.write(GAINS | {ENC_IN_CONF: modus, CL_TR_TOLERANCE: 5})
    bench.run(0.3)
    assert abs(bench.read(ENC_POS_DEV)) <= 5
    assert bench.word & FB_TARGET_OK
    assert bench.unit.plant_state.lost_fullsteps == 0
    assert abs(bench.rotor) < 10
    assert bench.x == 0  # only the step output moved


@pytest.mark.sheet("DS-TMC4361", "14.4")
def test_over_the_ramp_pid_keeps_the_deviation_small_during_a_move() -> None:
    errors = {}
    for modus in (0, PID_OVER_RAMP):
        bench = settled(load_torque_nm=0.15)
        bench.write(GAINS | {PID_I: 0, ENC_IN_CONF: modus})
        bench.accelerate(0, 40_000, 0.1)
        worst = 0
        for _ in range(200):
            bench.run(0.5e-3, 40_000)
            worst = max(worst, abs(bench.read(ENC_POS_DEV)))
        errors[modus] = worst
    assert errors[PID_OVER_RAMP] < errors[0] / 3


def test_inside_the_tolerance_pid_does_nothing_and_lets_the_bench_rest() -> None:
    bench = settled(load_torque_nm=0.02)
    deviation = abs(bench.read(ENC_POS_DEV))
    assert deviation > 3
    bench.write(GAINS | {PID_TOLERANCE: deviation + 3, ENC_IN_CONF: PID_ALONE})
    bench.run(0.3)
    assert (bench.read(PID_E), bench.read(PID_VEL)) == (0, 0)
    assert bench.word & FB_QUIET


def test_dv_clip_limits_how_fast_pid_moves() -> None:
    bench = settled()
    bench.write(GAINS | {PID_DV_CLIP: 5000, PID_I: 0, ENC_IN_CONF: PID_ALONE})
    bench.x = 1000
    bench.run(0.1)
    assert bench.read(PID_VEL) == 5000
    assert bench.read(ENC_POS) == pytest.approx(500, abs=60)
    bench.run(0.3)
    assert bench.read(ENC_POS) == pytest.approx(1000, abs=5)
