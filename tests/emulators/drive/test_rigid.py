"""A rigid motor: the shaft is where the field is, and stretches at constant velocity take no time to work out.

What is leapt over has to come out as if every tick had been made, whatever may lie on the way: each example runs the
same program with and without leaps and compares every cell of the kernel.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.emulators.drive import Drive, DriveOptions, EncoderOptions, StageSwitches
from app.emulators.drive import kernel as k
from tests.emulators.drive.rig import CHOPPER_ON, ONE_TURN_A_SECOND, SECOND, TRAPEZOID, velocity, write

TURN = 51_200
_OWN = (k.RIGID, k.STEADY)
N_EVERY_TURN = 1 << 2 | 1 << 3 | 1 << 4 | 1 << 6 | 1 << 8
"""ENCMODE: N high active, A and B ignored, clear X_ENC at each rising edge."""


def rigid(leaps: bool = True, **options: object) -> Drive:
    drive = Drive(DriveOptions(rigid=True, n_line=True, **options))
    drive.moves_by_leaps = leaps
    write(drive, TRAPEZOID | {"CHOPCONF": CHOPPER_ON, "IHOLD_IRUN": 0x10B0B})
    return drive


def assert_same(leaping: Drive, ticking: Drive) -> None:
    for cell in range(k.INTEGERS):
        if cell not in _OWN:
            assert leaping._s[cell] == ticking._s[cell], f"cell {cell} of s"
    assert np.array_equal(leaping._f, ticking._f)
    for name in (
        "XACTUAL",
        "VACTUAL",
        "X_ENC",
        "RAMP_STAT",
        "DRV_STATUS",
        "ENC_STATUS",
        "ENC_LATCH",
        "XLATCH",
        "MSCNT",
    ):
        assert leaping.read(name) == ticking.read(name), name


WRITES = st.one_of(
    st.tuples(st.just("RAMPMODE"), st.sampled_from([0, 0, 1, 1, 2, 3])),
    st.tuples(
        st.just("VMAX"), st.one_of(st.integers(0, 4000), st.integers(0, 2 * ONE_TURN_A_SECOND), st.just(8_000_000))
    ),
    st.tuples(st.just("XTARGET"), st.one_of(st.integers(-(2**31), 2**31 - 1), st.integers(-200_000, 200_000))),
    st.tuples(st.just("XACTUAL"), st.one_of(st.integers(-(2**31), 2**31 - 1), st.integers(-2000, 2000))),
    st.tuples(st.just("V1"), st.sampled_from([0, 0, 3000, 30_000])),
    st.tuples(st.just("AMAX"), st.sampled_from([0, 500, 2000, 65_535])),
    st.tuples(st.just("DMAX"), st.sampled_from([200, 2000, 65_535])),
    st.tuples(st.just("VSTOP"), st.sampled_from([1, 10, 5000])),
    st.tuples(st.just("CHOPCONF"), st.sampled_from([CHOPPER_ON, CHOPPER_ON | 4 << 24, CHOPPER_ON | 1 << 28 | 5 << 24])),
    st.tuples(st.just("GCONF"), st.sampled_from([0x8, 0x18, 0xA])),
    st.tuples(st.just("SW_MODE"), st.sampled_from([0, 0x3, 0x803, 0x3E0, 0x3F3])),
    st.tuples(st.just("ENCMODE"), st.sampled_from([0, 4, 0x24, N_EVERY_TURN, 0x1BC, 0x2D4, 0x99, 0x69])),
    st.tuples(st.just("ENC_CONST"), st.sampled_from([0x10000, 0x51EB8, -0x51EB8 & 0xFFFFFFFF, 0])),
    st.tuples(st.just("ENC_DEVIATION"), st.sampled_from([0, 0, 50, 5000])),
    st.tuples(st.just("ENC_STATUS"), st.just(3)),
    st.tuples(st.just("RAMP_STAT"), st.just(0x3FFF)),
    st.tuples(st.just("TZEROWAIT"), st.sampled_from([0, 500])),
)
STEPS = st.tuples(st.lists(WRITES, max_size=3), st.integers(1, 3 * SECOND))


@settings(max_examples=60, deadline=None)
@given(
    program=st.lists(STEPS, min_size=1, max_size=6),
    compare=st.integers(-100_000, 100_000),
    lines=st.sampled_from([1, 50, 1000, 2500]),
    reversed_=st.booleans(),
    switches=st.sampled_from([(-3750.0, 3750.0), (-40.0, 77.5), (-3.0, 1e7)]),
    backlash=st.sampled_from([0.0, 3.3]),
    start=st.sampled_from([0.0, 12.5, -1000.0]),
)
def test_leaps_change_nothing_but_the_time_that_it_takes(
    program: list[tuple[list[tuple[str, int]], int]],
    compare: int,
    lines: int,
    reversed_: bool,
    switches: tuple[float, float],
    backlash: float,
    start: float,
) -> None:
    encoders = EncoderOptions(external_lines=lines, external_reversed=reversed_)
    stage = StageSwitches(
        left_at_fullsteps=switches[0],
        right_at_fullsteps=switches[1],
        home_from_fullsteps=5,
        home_to_fullsteps=9,
        backlash_fullsteps=backlash,
    )
    drives = [rigid(leaps, encoders=encoders, stage=stage, start_fullsteps=start) for leaps in (True, False)]
    for drive in drives:
        drive.x_compare = compare
        write(drive, {"RAMPMODE": 1})
    for writes, clocks in program:
        for drive in drives:
            for register, value in writes:
                drive.write(register, value)
            drive.advance(drive.clocks + clocks)
        assert_same(*drives)


@settings(max_examples=60, deadline=None)
@given(
    seconds=st.floats(0.2, 4),
    left=st.booleans(),
    vmax=st.one_of(st.integers(100, 8_388_096), st.integers(100, 100_000)),
    v1=st.sampled_from([0, 3000, 600_000]),
    vstop=st.sampled_from([1, 10, 100_000]),
    accelerations=st.tuples(*[st.integers(100, 65_535)] * 4),
)
def test_a_leap_ends_before_braking_begins(
    seconds: float, left: bool, vmax: int, v1: int, vstop: int, accelerations: tuple[int, int, int, int]
) -> None:
    """Both are compared while they cruise, while they brake, and when they have arrived."""
    a1, amax, dmax, d1 = accelerations
    distance = int(velocity(vmax) * seconds) * (-1 if left else 1)
    ramp = {"VMAX": vmax, "V1": v1, "VSTOP": vstop, "A1": a1, "AMAX": amax, "DMAX": dmax, "D1": d1}
    drives = [rigid(leaps) for leaps in (True, False)]
    for drive in drives:
        write(drive, ramp | {"XTARGET": distance})
    for _ in range(5):
        for drive in drives:
            drive.advance(drive.clocks + int(seconds * SECOND / 2.3))
        assert_same(*drives)


@settings(max_examples=40, deadline=None)
@given(
    constant=st.integers(0x51EB8 - 3000, 0x51EB8 + 3000),
    limit=st.integers(20, 3000),
    vmax=st.integers(1000, 200_000),
    left=st.booleans(),
)
def test_a_leap_ends_where_the_deviation_is_told(constant: int, limit: int, vmax: int, left: bool) -> None:
    drives = [rigid(leaps, encoders=EncoderOptions(external_lines=2500)) for leaps in (True, False)]
    for drive in drives:
        write(drive, {"ENC_CONST": constant, "ENC_DEVIATION": limit, "VMAX": vmax, "RAMPMODE": 2 if left else 1})
    for _ in range(5):
        for drive in drives:
            drive.advance(drive.clocks + SECOND)
        assert_same(*drives)


def test_a_day_of_rotation_ends_on_the_exact_microstep() -> None:
    """86,400 s at a constant velocity V are V * 86,400 * 16e6 / 2^24 microsteps; the way up to V is subtracted."""
    drive = rigid(encoders=EncoderOptions(external_lines=10_000))
    write(drive, {"RAMPMODE": 1, "VMAX": ONE_TURN_A_SECOND, "ENC_CONST": 51_200 * 65_536 // 40_000, "ENCMODE": 4})
    drive.advance(10 * SECOND)
    start, counts, compared = drive.read("XACTUAL"), drive.external.counts, drive.positions_passed
    rest = int(drive._s[k.ACC])
    drive.advance(drive.clocks + 86_400 * SECOND)
    steps, rest_after = divmod(rest + ONE_TURN_A_SECOND * 512 * (86_400 * SECOND // 256), 1 << 25)
    assert drive.read("XACTUAL") == (start + steps + 2**31) % 2**32 - 2**31
    assert drive._s[k.ACC] == rest_after
    assert drive.positions_passed - compared == (start + steps) // 2**32
    assert abs((drive.external.counts - counts) * 51_200 - steps * 40_000) <= 51_200
    assert drive.plant_state.lost_fullsteps == 0


def test_the_shaft_is_where_the_field_is() -> None:
    drive = rigid(start_fullsteps=800.0)
    assert drive.plant_state.rotor_fullsteps == pytest.approx(800.0)
    write(drive, {"RAMPMODE": 1})
    drive.advance(2 * SECOND)
    truth = drive.plant_state
    assert abs(truth.load_angle_deg) < 0.5
    assert truth.rotor_fullsteps == pytest.approx(800.0 + drive.read("XACTUAL") / 256)
    assert truth.speed_rad_s == pytest.approx(2 * 2 * math.pi, rel=1e-4)


def test_turned_by_hand_it_snaps_to_the_field_and_the_encoder_sees_it() -> None:
    drive = rigid(encoders=EncoderOptions(external_lines=2500))
    drive.advance(SECOND)
    drive.plant.rotor_fullsteps = 101.0
    drive.advance(2 * SECOND)
    assert drive.plant_state.rotor_fullsteps == pytest.approx(100.0)
    assert drive.external.counts == 100 * 10_000 // 200
    assert drive.read("XACTUAL") == 0


def test_a_rigid_motor_tells_a_load_value_without_load() -> None:
    drive = rigid()
    write(drive, {"RAMPMODE": 1})
    drive.advance(2 * SECOND)
    speed = 400.0
    told = drive.options.motor.load_value
    expected = told.full_scale * speed / (speed + told.half_speed_fullsteps_per_s)
    assert drive.read("DRV_STATUS") & 0x3FF == pytest.approx(expected, abs=1)
