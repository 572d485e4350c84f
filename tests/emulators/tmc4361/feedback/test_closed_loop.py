"""Regulation mode 1: its law against a slow reference, and what it does for a motor with a load."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.emulators.drive import MotorOptions
from app.emulators.tmc4361.feedback import layout as c
from app.emulators.tmc4361.feedback.regulation import commutate
from app.emulators.tmc4361.layout import FB_CL_FIT, FB_CL_MAX, FB_QUIET, FB_SET_X, FB_TARGET_OK
from tests.emulators.tmc4361.feedback.oracle import PlainLoop, scale
from tests.emulators.tmc4361.feedback.rig import (
    CALIBRATION,
    CL_ANGLES,
    CL_OFFSET,
    CL_TR_TOLERANCE,
    CL_VADD_EMF,
    CL_VMIN_EMF,
    CLOSED_LOOP,
    CURRENT_CONF,
    ENC_IN_CONF,
    ENC_IN_DATA,
    ENC_POS,
    ENC_POS_DEV,
    ENC_VEL_ZERO,
    ENC_VMEAN,
    GENERAL_CONF,
    HOLD_SCALE_DELAY,
    MSCNT,
    PID_CLIP,
    PID_D,
    PID_DV_CLIP,
    PID_I,
    PID_P,
    PID_TOLERANCE,
    SCALE_PARAM,
    SCALE_VALUES,
    UP_SCALE_DELAY,
    Bench,
    loose,
)

ONE = 1 << 16
LOOP = {
    CL_ANGLES: 255,
    PID_D: ONE,
    PID_TOLERANCE: 10,
    CL_TR_TOLERANCE: 200,
    ENC_VMEAN: 100 | 5 << 8 | 500 << 16,
    ENC_VEL_ZERO: 160_000,
}
EMF, VLIMIT, VELOCITY_MODE, MULTI = 1 << 25, 1 << 27, 1 << 28, 1 << 12
DEG = 90 / 256
"""A 1/256 full step [deg electrical]."""


def closed(conf: int = 0, registers: Mapping[int, int] | None = None, **options: object) -> Bench:
    """A motor with its loop calibrated and closed."""
    bench = Bench(LOOP | dict(registers or {}), **options)
    bench.calibrate(conf)
    return bench


# --- the law ---------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "17.19")
@settings(max_examples=300, deadline=None)
@given(
    beta=st.integers(1, 511),
    gamma=st.integers(0, 255),
    gain=st.integers(0, 1 << 20),
    tolerance=st.integers(0, 255),
    vmin=st.integers(0, 300_000),
    vadd=st.integers(0, 600_000),
    emf=st.booleans(),
    x=st.integers(-(1 << 30), 1 << 30),
    deviation=st.one_of(st.integers(-600, 600), st.integers(-(1 << 30), 1 << 30)),
    v_mean=st.integers(-1_000_000, 1_000_000),
    offset=st.integers(-512, 511),
)
def test_the_commutation_angle_is_that_of_a_slow_reference(
    beta: int,
    gamma: int,
    gain: int,
    tolerance: int,
    vmin: int,
    vadd: int,
    emf: bool,
    x: int,
    deviation: int,
    v_mean: int,
    offset: int,
) -> None:
    bench = loose({CL_ANGLES: beta | gamma << 16, PID_D: gain, PID_TOLERANCE: tolerance, CL_VMIN_EMF: vmin})
    bench.write({CL_VADD_EMF: vadd, ENC_IN_CONF: CLOSED_LOOP | EMF * emf, CL_OFFSET: offset & 0xFFFFFFFF})
    fb = bench.unit.fb
    n = fb[c.INTEGERS_AT :].view("int64")
    fb[c.ENC_POS], n[c.DEV], n[c.MEAN_Q16] = float(x - deviation), deviation, v_mean << 16
    commutate(fb, n, 0.0, 128)
    reference = PlainLoop(beta, gamma, gain / ONE, tolerance, vmin, vadd, emf)
    angle, saturated = reference.angle(x, x - deviation, v_mean)
    assert int(n[c.ANGLE]) == angle
    assert bool(n[c.SATURATED]) is saturated
    assert int(n[c.PHASE]) % 1024 == (x - deviation + offset + angle) % 1024
    assert bench.unit.read(MSCNT) == int(n[c.PHASE]) % 1024


def test_inside_cl_tolerance_the_gain_is_one_the_working_reading_of_a_comparison_printed_inverted() -> None:
    bench = loose(LOOP | {PID_D: 4 * ONE, ENC_IN_CONF: CLOSED_LOOP, CL_ANGLES: 255})
    n = bench.unit.fb[c.INTEGERS_AT :].view("int64")
    for x, angle, fits in ((10, 10, True), (11, 44, False), (-10, -10, True), (-11, -44, False)):
        bench.x = x
        bench.ticks(2)
        assert int(n[c.ANGLE]) == angle
        assert bool(bench.word & FB_CL_FIT) is fits


# --- a motor under load ------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "14.4")
@pytest.mark.parametrize("load_nm", [0.4, -0.4])
def test_a_load_that_costs_steps_in_open_loop_costs_none_in_closed_loop(load_nm: float) -> None:
    lost = {}
    for loop in (False, True):
        bench = Bench(LOOP)
        if loop:
            bench.calibrate()
        else:
            bench.run(0.3)
            bench.write({ENC_POS: bench.x})
        start = bench.rotor
        for part in range(1, 41):  # hung on gently
            bench.change(load_torque_nm=load_nm * part / 40)
            bench.run(0.01)
        velocity = math.copysign(150_000, load_nm)  # lifting
        x = bench.x
        bench.move(velocity, 0.02, 0.1)
        bench.run(0.3)
        lost[loop] = bench.unit.plant_state.lost_fullsteps
        if loop:
            assert bench.rotor - start == pytest.approx(bench.x - x, abs=256)
            assert abs(bench.read(ENC_POS_DEV)) < 256
            assert bench.unit.plant_state.speed_rad_s == pytest.approx(0.0, abs=0.5)
    assert lost[True] == 0
    assert abs(lost[False]) >= 4


@pytest.mark.sheet("DS-TMC4361", "14.4")
@pytest.mark.parametrize(("beta", "gamma"), [(255, 0), (200, 0), (255, 100)])
def test_the_load_angle_never_exceeds_beta_and_gamma(beta: int, gamma: int) -> None:
    registers = {CL_ANGLES: beta | gamma << 16, CL_VMIN_EMF: 20_000, CL_VADD_EMF: 50_000}
    bench = closed(EMF, registers, motor=MotorOptions(detent_torque_nm=0.0))
    bench.change(load_torque_nm=0.3)
    worst = 0.0
    for velocity in (0.0, 150_000.0, 300_000.0, -200_000.0, 0.0):
        for _ in range(2500):
            bench.ticks(1, velocity)
            worst = max(worst, abs(bench.unit.plant_state.load_angle_deg))
    assert worst <= (beta + gamma + 9) * DEG  # a count, and how far the rotor goes until the next step
    assert worst > 0.9 * beta * DEG


def test_held_back_the_motor_lags_and_catches_up() -> None:
    bench = closed()
    bench.change(blocked=True)
    assert bench.run(0.1, 100_000) & FB_CL_MAX
    assert abs(bench.read(ENC_POS_DEV)) > 9000
    assert not bench.word & FB_TARGET_OK
    bench.change(blocked=False)
    bench.run(0.3)
    assert bench.rotor == pytest.approx(bench.x, abs=15)
    assert bench.word & FB_TARGET_OK
    assert bench.word & FB_CL_FIT
    assert not bench.word & FB_CL_MAX


def test_open_loop_never_catches_up_with_what_was_held_back() -> None:
    bench = Bench(LOOP)
    bench.run(0.3)
    bench.change(blocked=True)
    bench.run(0.1, 100_000)
    bench.change(blocked=False)
    bench.run(0.3)
    assert bench.rotor < bench.x - 9000


def test_at_rest_in_closed_loop_nothing_has_to_be_worked_out() -> None:
    bench = closed()
    bench.run(0.4)
    assert bench.word & FB_QUIET


@pytest.mark.parametrize("reverse", [False, True])
def test_leaving_the_loop_moves_nothing(reverse: bool) -> None:
    bench = closed(0, {GENERAL_CONF: 0x6020 | reverse << 28}, encoder={"reversed": reverse})
    bench.change(load_torque_nm=0.2)
    bench.run(0.3)
    before = bench.rotor
    bench.write({ENC_IN_CONF: 0})
    bench.run(0.1)
    assert bench.rotor == pytest.approx(before, abs=3)
    bench.run(0.1, 10_000)
    bench.run(0.1)
    assert bench.rotor == pytest.approx(before + (-1000 if reverse else 1000), abs=15)


def test_a_table_turned_around_and_an_encoder_turned_around_regulate_too() -> None:
    bench = closed(0, {GENERAL_CONF: 0x6020 | 1 << 28}, encoder={"reversed": True})
    start = bench.rotor
    bench.change(load_torque_nm=0.2)
    bench.move(50_000, 0.05, 0.1)
    bench.run(0.3)
    assert bench.rotor - start == pytest.approx(-7500, abs=256)
    assert bench.unit.plant_state.lost_fullsteps == 0


# --- calibration -----------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "14.4")
@pytest.mark.parametrize("zero_fullsteps", [0.0, 1.7, -37.3, 90.25])
@pytest.mark.parametrize("start", [0.0, 13.9])
def test_calibration_finds_how_the_encoder_sits_on_the_shaft(zero_fullsteps: float, start: float) -> None:
    """CL_OFFSET is the phase minus ENC_POS: facts leave its exact meaning open, this one commutates after power-on."""
    bench = Bench(LOOP, encoder={"zero_fullsteps": zero_fullsteps}, start_fullsteps=start)
    bench.x = 12_345  # so that XACTUAL tells nothing about the phase
    bench.calibrate(align=False)
    place = bench.unit.encoder_counts * 1.28  # an encoder that had been absolute
    bench.write({ENC_IN_CONF: 0})
    truth = bench.unit.plant_state
    offset = bench.read(CL_OFFSET)
    phase = bench.unit.read(ENC_POS) or 0
    assert -512 <= offset <= 511
    wrong = (offset + phase - truth.rotor_fullsteps * 256 + 512) % 1024 - 512
    assert abs(wrong) < 8
    # a count is 0 where the encoder was mounted
    assert place == pytest.approx((truth.rotor_fullsteps - zero_fullsteps) * 256, abs=2)


def test_calibration_follows_while_its_bit_is_set_and_keeps_its_value_after() -> None:
    bench = Bench(LOOP)
    bench.run(0.2)
    bench.write({ENC_IN_CONF: CALIBRATION, ENC_POS: 100})
    bench.ticks(1)
    first = bench.read(CL_OFFSET)
    bench.write({ENC_POS: 300})
    bench.ticks(1)
    assert bench.read(CL_OFFSET) == first - 200
    bench.write({ENC_IN_CONF: 0, ENC_POS: 0})
    bench.ticks(1)
    assert bench.read(CL_OFFSET) == first - 200
    bench.write({ENC_IN_CONF: CALIBRATION | CLOSED_LOOP})  # a choice: only with regulation off
    bench.run(0.1, 1000)
    assert bench.read(CL_OFFSET) == first - 200


def test_a_saved_offset_lets_an_absolute_encoder_start_without_calibration() -> None:
    settings_ = {GENERAL_CONF: 0x6020 | 1 << 10, ENC_IN_DATA: 12 | 11 << 5, ENC_IN_CONF: MULTI}
    first = Bench(LOOP | settings_, encoder={"kind": "ssi", "zero_fullsteps": 11.3})
    first.run(0.1)
    first.calibrate(MULTI, align=False)
    offset = first.unit.read(CL_OFFSET) or 0
    again = Bench(LOOP | settings_, encoder={"kind": "ssi", "zero_fullsteps": 11.3}, start_fullsteps=29.1)
    again.run(0.01)
    again.x = again.read(ENC_POS)
    again.write({CL_OFFSET: offset, ENC_IN_CONF: MULTI | CLOSED_LOOP})
    again.change(load_torque_nm=0.2)
    start, x = again.rotor, again.x
    again.run(0.2)
    again.move(50_000, 0.05, 0.1)
    again.run(0.2)
    assert again.rotor - start == pytest.approx(again.x - x, abs=256)
    assert again.unit.plant_state.lost_fullsteps == 0


def test_with_a_serial_encoder_the_loop_works_once_a_cycle() -> None:
    settings_ = {GENERAL_CONF: 0x6020 | 1 << 10, ENC_IN_DATA: 12 | 11 << 5, ENC_IN_CONF: MULTI}
    bench = Bench(LOOP | settings_ | {ENC_VMEAN: 16_000 << 16}, encoder={"kind": "ssi"})
    bench.run(0.1)
    bench.calibrate(MULTI)
    phases = []
    for tick in range(1000):
        bench.x = bench.x + tick % 2
        bench.ticks(1)
        phases.append(bench.unit.read(MSCNT))
    changes = [tick for tick in range(1, 1000) if phases[tick] != phases[tick - 1]]
    assert 5 <= len(changes) <= 8
    assert all(later - earlier >= 125 for earlier, later in itertools.pairwise(changes))


# --- current scale -----------------------------------------------------------------------------------

LOW, HIGH, START = 60, 240, 30
CL_SCALE = {CURRENT_CONF: 1 << 7, SCALE_VALUES: LOW | HIGH << 8 | START << 16}


@pytest.mark.sheet("DS-TMC4361", "11.6")
@pytest.mark.parametrize("deviation", [0, 29, 30, 31, 100, 142, 254, 255, 5000, -100, -255])
def test_the_current_grows_with_the_deviation(deviation: int) -> None:
    bench = loose(LOOP | CL_SCALE | {ENC_IN_CONF: CLOSED_LOOP})
    bench.x = deviation
    bench.ticks(2)
    assert bench.unit.read(SCALE_PARAM) == scale(deviation, LOW, HIGH, START, 255)


def test_up_and_down_take_their_delays_a_step() -> None:
    bench = loose(LOOP | CL_SCALE | {ENC_IN_CONF: CLOSED_LOOP})
    bench.ticks(3)
    bench.write({UP_SCALE_DELAY: 128, HOLD_SCALE_DELAY: 1280})
    scales = []
    for x in (1000, 0):
        bench.x = x
        for _ in range(200):
            bench.ticks(1)
            scales.append(bench.unit.read(SCALE_PARAM))
    assert scales[1:181] == list(range(LOW + 1, HIGH + 1))
    assert scales[200:] == [HIGH - tick // 10 for tick in range(200)]


def test_the_current_stays_up_until_the_deviation_falls_below_cl_start_dn() -> None:
    registers = {SCALE_VALUES: LOW | HIGH << 8 | START << 16 | 100 << 24, ENC_IN_CONF: CLOSED_LOOP}
    bench = loose(LOOP | CL_SCALE | registers)
    for deviation, wanted in ((300, HIGH), (120, HIGH), (65, LOW + 90), (29, LOW), (100, LOW + 180 * 70 // 225)):
        bench.x = deviation
        bench.ticks(2)
        assert bench.unit.read(SCALE_PARAM) == wanted


def test_a_motor_at_rest_needs_little_current_and_under_load_gets_more() -> None:
    bench = closed(0, CL_SCALE | {UP_SCALE_DELAY: 100, HOLD_SCALE_DELAY: 1000, CURRENT_CONF: 0})
    bench.write({CURRENT_CONF: 1 << 7})
    bench.run(0.2)
    assert bench.unit.read(SCALE_PARAM) == LOW
    bench.change(load_torque_nm=0.25)
    bench.run(0.5)
    assert (bench.unit.read(SCALE_PARAM) or 0) > 2 * LOW
    assert abs(bench.read(ENC_POS_DEV)) < 255


# --- catching up --------------------------------------------------------------------------------------


def test_the_catch_up_limiter_limits_the_speed_of_catching_up() -> None:
    speeds = {}
    for limited in (False, True):
        bench = closed(VLIMIT * limited, {PID_P: 256 * 1000, PID_I: 0, PID_CLIP: 0, PID_DV_CLIP: 40_000})
        bench.change(blocked=True)
        bench.run(0.1, 200_000)
        bench.change(blocked=False)
        bench.run(0.005)  # the field is ahead by beta when the rotor gets loose
        start = bench.rotor
        bench.run(0.1)
        speeds[limited] = (bench.rotor - start) / 0.1
        bench.run(1.0)
        assert bench.rotor == pytest.approx(bench.x, abs=20)
    assert speeds[True] == pytest.approx(40_000, rel=0.03)
    assert speeds[False] > 150_000


def test_the_limiter_adds_the_ramps_velocity() -> None:
    bench = closed(VLIMIT, {PID_P: 256 * 1000, PID_DV_CLIP: 20_000})
    bench.accelerate(0, 60_000, 0.05)
    bench.change(blocked=True)
    bench.run(0.1, 60_000)
    bench.change(blocked=False)
    bench.run(0.02, 60_000)
    start = bench.rotor
    bench.run(0.1, 60_000)
    assert (bench.rotor - start) / 0.1 == pytest.approx(80_000, rel=0.05)


def test_the_limiter_knows_how_long_a_cycle_of_a_serial_encoder_is() -> None:
    serial = {GENERAL_CONF: 0x6020 | 1 << 10, ENC_IN_DATA: 12 | 11 << 5, ENC_IN_CONF: MULTI, 0x56: 8 | 8 << 16}
    bench = Bench(
        LOOP | serial | {ENC_VMEAN: 1280 << 16, PID_P: 256 * 1000, PID_DV_CLIP: 20_000}, encoder={"kind": "ssi"}
    )
    bench.run(0.1)
    bench.calibrate(MULTI | VLIMIT)
    bench.change(blocked=True)
    bench.run(0.1, 100_000)
    bench.change(blocked=False)
    bench.run(0.05)
    start = bench.rotor
    bench.run(0.1)
    assert (bench.rotor - start) / 0.1 == pytest.approx(20_000, rel=0.05)


def test_in_velocity_mode_no_backlog_builds_up() -> None:
    bench = closed(VELOCITY_MODE)
    bench.change(blocked=True)
    assert bench.run(0.1, 100_000) & FB_SET_X
    assert bench.x - bench.read(ENC_POS) == pytest.approx(768, abs=2)
    assert bench.run(0.1, -100_000) & FB_SET_X
    assert bench.x - bench.read(ENC_POS) == pytest.approx(-768, abs=2)


def test_gamma_makes_a_fast_motor_stronger() -> None:
    """At speed the coils lag behind the phase; an angle ahead of it brings the torque back."""
    reached = {}
    for emf in (False, True):
        registers = {CL_ANGLES: 255 | 255 << 16, CL_VMIN_EMF: 50_000, CL_VADD_EMF: 300_000}
        bench = closed(EMF * emf, registers)
        bench.run(0.15, 1_500_000)  # asked for more than it can do
        start = bench.rotor
        bench.run(0.05, 1_500_000)
        reached[emf] = (bench.rotor - start) / 0.05
    assert reached[True] > 1.2 * reached[False] > 0
