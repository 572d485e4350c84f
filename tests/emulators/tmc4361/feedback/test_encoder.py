"""The encoder unit against NOTES-TMC4361-ENCODER, with a shaft that stays where it is put."""

from __future__ import annotations

import math
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.emulators.tmc4361.feedback import layout
from app.emulators.tmc4361.feedback.encoder import pass_counts
from app.emulators.tmc4361.feedback.layout import Cells, Floats
from app.emulators.tmc4361.feedback.options import FeedbackOptions, ShaftEncoder
from app.emulators.tmc4361.feedback.unit import FeedbackUnit
from app.emulators.tmc4361.feedback.words import encoder_scale
from app.emulators.tmc4361.layout import (
    FB_ENC_DONE,
    FB_ENC_FAIL,
    FB_ENC_LATCH,
    FB_ENC_VEL0,
    FB_LATCH_X,
    FB_MULTI_FAIL,
    FB_N_ACTIVE,
    FB_N_EVENT,
    FB_QUIET,
    FB_SER_DONE,
    FB_SER_FAIL,
    FB_SET_X,
)
from tests.emulators.tmc4361.feedback.rig import (
    CL_OFFSET,
    ENC_COMP,
    ENC_CONST,
    ENC_IN_CONF,
    ENC_IN_DATA,
    ENC_IN_RES,
    ENC_LATCH,
    ENC_POS,
    ENC_POS_DEV,
    ENC_POS_DEV_TOL,
    ENC_RESET_VAL,
    ENC_VEL_ZERO,
    ENC_VMEAN,
    F_CLK,
    GENERAL_CONF,
    INPUT_FILT_CONF,
    MOTOR_S,
    REFERENCE_CONF,
    SER_PTIME,
    TURN,
    V_ENC,
    X_RANGE,
    Bench,
    loose,
    signed,
)

AT_ZERO = {"zero_fullsteps": 0.0}
SSI, SPI = 1 << 10, 3 << 10
DECIMAL, CLEAR, EACH, ONCE, POL_N, POL_A, POL_B, IGNORE_AB, LATCH, LATCH_X_TOO = (
    1 << n for n in (0, 1, 2, 3, 4, 7, 8, 9, 10, 11)
)
MULTI, MULTI_SIGNED, CALC_MULTI, MULTI_CYCLE, GRAY, LEFT, LIMIT = (1 << n for n in (12, 13, 16, 17, 18, 19, 31))
INVERT = 1 << 29


# --- ENC_CONST (section 2) -----------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "14.2")
@pytest.mark.parametrize(
    ("counts", "binary", "decimal"),
    [
        (200, 0x01000000, 0x01000000),
        (360, 0x008E38E4, 0x008E08AE),
        (400, 0x00800000, 0x00800000),
        (500, 0x00666666, 0x00660FA0),
        (1000, 0x00333333, 0x003307D0),
        (1024, 0x00320000, 0x00320000),
        (2000, 0x0019999A, 0x00191770),
        (4000, 0x000CCCCD, 0x000C1F40),
        (4096, 0x000C8000, 0x000C1388),
        (10000, 0x00051EB8, 0x000504B0),
        (16384, 0x00032000, 0x000304E2),
        (40000, 0x000147AE, 0x00010AF0),
    ],
)
def test_enc_const_is_the_quotient_of_microsteps_and_resolution(counts: int, binary: int, decimal: int) -> None:
    bench = loose({ENC_IN_RES: counts})
    assert bench.unit.read(ENC_CONST) == binary
    bench.write({ENC_IN_CONF: DECIMAL})
    assert bench.unit.read(ENC_CONST) == decimal


def test_the_chip_does_not_choose_decimals_by_itself_a_choice_where_the_facts_leave_it_open() -> None:
    bench = loose({ENC_IN_RES: 4000})  # decimals would be exact
    assert bench.unit.read(ENC_CONST) == 0x000CCCCD
    assert not (bench.unit.read(ENC_IN_CONF) or 0) & DECIMAL


def test_a_manual_constant_is_taken_as_it_is() -> None:
    bench = loose({ENC_IN_RES: 1 << 31 | 0x0007_8000})
    assert bench.unit.read(ENC_CONST) == 0x0007_8000
    assert encoder_scale(1 << 31 | 3 << 16 | 2500, TURN, decimal=True).numerator == 32_500


def test_without_a_resolution_enc_pos_stays() -> None:
    bench = loose({ENC_IN_RES: 0})
    bench.turn_by_hand(30_000)
    assert (bench.unit.read(ENC_CONST), bench.read(ENC_POS)) == (0, 0)


# --- incremental ---------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "14.2")
@given(place=st.integers(-40_000_000, 40_000_000))
def test_each_transition_adds_the_constant(place: int) -> None:
    bench = loose({ENC_IN_RES: 4000, ENC_IN_CONF: DECIMAL}, encoder={"lines": 1000, **AT_ZERO})
    bench.turn_by_hand(place * TURN / 4000 + 0.1)
    assert bench.unit.encoder_counts == place
    assert bench.read(ENC_POS) == place * 128 // 10


@pytest.mark.sheet("DS-TMC4361", "17.8")
@pytest.mark.parametrize("mounted_reversed", [False, True])
def test_inverting_the_direction_turns_a_reversed_encoder_around(mounted_reversed: bool) -> None:
    bench = loose({ENC_IN_CONF: INVERT * mounted_reversed}, encoder={"reversed": mounted_reversed})
    bench.turn_by_hand(12_800)
    assert bench.read(ENC_POS) == pytest.approx(12_800, abs=2)


def test_enc_pos_can_be_written_and_counts_on_from_there() -> None:
    bench = loose(encoder=AT_ZERO)
    bench.turn_by_hand(1000)
    bench.write({ENC_POS: -5000 & 0xFFFFFFFF})
    assert bench.read(ENC_POS) == -5000
    bench.turn_by_hand(1640)
    assert bench.read(ENC_POS) == pytest.approx(-4360, abs=2)


def test_another_resolution_leaves_enc_pos_where_it_is() -> None:
    bench = loose(encoder=AT_ZERO)
    bench.turn_by_hand(6400)
    before = bench.read(ENC_POS)
    bench.write({ENC_IN_RES: 80_000})  # half as many microsteps a count
    assert bench.read(ENC_POS) == before
    bench.turn_by_hand(12_800)
    assert bench.read(ENC_POS) == pytest.approx(6400 + 3200, abs=2)


@pytest.mark.sheet("DS-TMC4361", "6.1")
def test_pulses_too_short_for_the_input_filter_are_not_counted() -> None:
    # SR 2, FILT_L 7: a level has to last 32 clocks, so 16 transitions in 256 clocks are the most
    slow, fast = loose({INPUT_FILT_CONF: 2 | 7 << 4}), loose({INPUT_FILT_CONF: 2 | 7 << 4})
    for bench, step in ((slow, 16), (fast, 17)):
        for tick in range(1, 101):
            bench.turn_by_hand(tick * step * 1.28)
    assert slow.read(ENC_POS) == pytest.approx(100 * 16 * 1.28, abs=2)
    assert fast.read(ENC_POS) == 0


@pytest.mark.sheet("DS-TMC4361", "14.1")
def test_an_encoder_of_another_kind_counts_nothing() -> None:
    bench = loose(encoder={"kind": "ssi"})
    bench.turn_by_hand(10_000)
    assert bench.read(ENC_POS) == 0


# --- the N channel (section 3) ---------------------------------------------------------------------


def beside_zero(conf: int, registers: dict[int, int] | None = None) -> Bench:
    """A quarter turn before the N pulse, XACTUAL 777."""
    bench = loose(encoder=AT_ZERO)
    bench.change(rotor_fullsteps=-50.0)
    bench.ticks(2)
    bench.write({ENC_POS: -12_800 & 0xFFFFFFFF, ENC_IN_CONF: conf, ENC_RESET_VAL: 4321} | dict(registers or {}))
    bench.x = 777
    bench.ticks(2)
    return bench


@pytest.mark.sheet("DS-TMC4361", "14.2")
def test_an_n_event_latches_and_clears_enc_pos_each_time() -> None:
    bench = beside_zero(POL_N | 1 << 5 | IGNORE_AB | EACH | CLEAR | LATCH | LATCH_X_TOO)
    bench.change(rotor_fullsteps=50.0)
    word = bench.ticks(2)
    for bit in (FB_N_EVENT, FB_ENC_DONE, FB_LATCH_X, FB_ENC_LATCH):
        assert word & bit
    assert bench.word & FB_ENC_LATCH
    assert bench.read(ENC_LATCH) in (-1, 0)  # count 0 of the turn, before it was set to ENC_RESET_VAL
    bench.ticks(2)
    assert not bench.word & FB_ENC_LATCH  # read
    assert bench.read(ENC_POS) == pytest.approx(4321 + 12_800, abs=2)
    bench.change(rotor_fullsteps=250.0)
    assert bench.ticks(2) & FB_ENC_DONE
    assert bench.read(ENC_POS) == pytest.approx(4321 + 12_800, abs=2)
    assert bench.read(ENC_LATCH) == pytest.approx(4321 + TURN, abs=2)


@pytest.mark.sheet("DS-TMC4361", "17.8")
def test_once_means_once() -> None:
    bench = beside_zero(POL_N | 1 << 5 | IGNORE_AB | ONCE | CLEAR | LATCH)
    for place in (50.0, 250.0):
        bench.change(rotor_fullsteps=place)
        bench.ticks(2)
    assert bench.read(ENC_POS) == pytest.approx(4321 + 12_800 + TURN, abs=2)
    assert not (bench.unit.read(ENC_IN_CONF) or 0) & ONCE  # it clears itself


def test_an_active_n_channel_is_no_event_until_it_is_armed() -> None:
    bench = beside_zero(POL_N | 1 << 5 | IGNORE_AB | CLEAR | LATCH)
    bench.change(rotor_fullsteps=50.0)
    assert not bench.ticks(2) & (FB_N_EVENT | FB_ENC_DONE)
    assert bench.read(ENC_POS) == pytest.approx(12_800, abs=2)


@pytest.mark.sheet("DS-TMC4361", "17.8")
@pytest.mark.parametrize(
    ("sensitivity", "forward", "backward"),
    [(1, 0, 3), (2, 4, -1)],
    ids=["edge to active", "edge to inactive"],
)
def test_the_edge_that_counts_can_be_chosen(sensitivity: int, forward: int, backward: int) -> None:
    for start, end, place in ((-50.0, 50.0, forward), (50.0, -50.0, backward)):
        bench = beside_zero(POL_N | sensitivity << 5 | IGNORE_AB | EACH | LATCH)
        bench.change(rotor_fullsteps=start)
        bench.ticks(2)
        bench.write({ENC_POS: round(start * 256) & 0xFFFFFFFF})
        bench.change(rotor_fullsteps=end)
        bench.ticks(2)
        assert bench.read(ENC_LATCH) == pytest.approx(place * 1.28, abs=1.3)


@pytest.mark.sheet("DS-TMC4361", "17.8")
@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_polarities_of_a_and_b_choose_one_count_of_the_n_pulse(count: int) -> None:
    a, b = count in (1, 2), count >= 2  # A rises first
    bench = beside_zero(POL_N | 1 << 5 | POL_A * a | POL_B * b | EACH | LATCH)
    bench.change(rotor_fullsteps=50.0)
    bench.ticks(2)
    assert bench.read(ENC_LATCH) in (math.floor(count * 1.28) - 1, math.floor(count * 1.28))
    bench.change(rotor_fullsteps=count * 1.28 / 256)
    bench.ticks(2)
    assert bench.word & FB_N_ACTIVE


def test_the_n_channel_may_be_low_active() -> None:
    bench = beside_zero(IGNORE_AB)
    assert bench.word & FB_N_ACTIVE  # between the pulses the line is low
    bench.change(rotor_fullsteps=0.0)
    bench.ticks(2)
    assert not bench.word & FB_N_ACTIVE


# --- supervision (section 3) -----------------------------------------------------------------------


def test_enc_pos_dev_is_enc_pos_minus_xactual_a_choice_as_no_source_tells_the_sign() -> None:
    bench = loose(encoder=AT_ZERO)
    bench.turn_by_hand(500)
    bench.x = 200
    bench.ticks(2)
    assert bench.read(ENC_POS_DEV) == bench.read(ENC_POS) - 200
    assert bench.read(ENC_POS_DEV) > 0


@pytest.mark.sheet("DS-TMC4361", "17.19")
def test_enc_fail_means_beyond_the_tolerance_either_way() -> None:
    bench = loose({ENC_POS_DEV_TOL: 100}, encoder=AT_ZERO)
    for x, fails in ((100, False), (101, True), (-100, False), (-101, True)):
        bench.x = x
        bench.ticks(2)
        assert bool(bench.word & FB_ENC_FAIL) is fails


@pytest.mark.sheet("DS-TMC4361", "17.8")
def test_cl_clr_xact_makes_xactual_follow_the_encoder() -> None:
    bench = loose({ENC_POS_DEV_TOL: 100, ENC_IN_CONF: 1 << 26}, encoder=AT_ZERO)
    bench.turn_by_hand(90)
    assert bench.x == 0
    bench.change(rotor_fullsteps=2.0)
    assert bench.ticks(2) & FB_SET_X
    assert bench.x == bench.read(ENC_POS) == pytest.approx(512, abs=2)


def test_enc_pos_can_be_circular() -> None:
    bench = loose({REFERENCE_CONF: 1 << 31, X_RANGE: 1000}, encoder=AT_ZERO)
    for place, shown in ((999, 999), (1010, -990), (2990, 990), (-1000.1, -1000), (-1020, 980)):
        bench.turn_by_hand(place)
        assert bench.read(ENC_POS) == pytest.approx(shown, abs=2)
    bench.x = -990
    bench.ticks(2)
    assert bench.read(ENC_POS_DEV) == pytest.approx(-30, abs=2)  # the short way around


@pytest.mark.parametrize(
    ("registers", "period"),
    [
        ({X_RANGE: 300, 0x7C: 0x8000_0000}, 601),  # NOTES-TMC4361-IO 6
        ({X_RANGE: 300, ENC_IN_CONF: 1 << 15}, TURN),
    ],
)
def test_a_circular_turn_may_be_odd_or_that_of_the_motor(registers: dict[int, int], period: int) -> None:
    bench = loose({REFERENCE_CONF: 1 << 31, **registers}, encoder={**AT_ZERO, "lines": 1 << 20})
    shown = []
    for turns in range(-20, 21):
        bench.turn_by_hand(turns * period + 100.5)
        shown.append(bench.read(ENC_POS))
    assert shown == pytest.approx([100] * 41, abs=1)


def test_a_deviation_is_right_at_once_when_a_position_is_written() -> None:
    bench = loose(encoder=AT_ZERO)
    bench.turn_by_hand(500)
    bench.write({0x21: 200})
    assert bench.read(ENC_POS_DEV) == bench.read(ENC_POS) - 200
    bench.write({ENC_POS: 150})
    assert bench.read(ENC_POS_DEV) == -50


# --- misalignment (section 4) ------------------------------------------------------------------------


def test_unequal_phases_of_an_encoder_move_its_counts_within_a_line() -> None:
    bench = loose(encoder={**AT_ZERO, "lines": 50, "line_error": 0.1})
    for index in range(41):
        place = index / 20 + 0.003  # lines
        bench.turn_by_hand(place * TURN / 50)
        assert bench.unit.encoder_counts == math.floor(4 * (place + 0.1 * math.sin(2 * math.pi * place)) + 0.5)


@pytest.mark.sheet("DS-TMC4361", "14.5")
def test_the_compensating_triangle_leaves_a_seventh_of_an_eccentricity() -> None:
    eccentricity_deg = 0.7
    amplitude = eccentricity_deg / 360 * TURN  # 99.6 microsteps
    height = round(2.28 * amplitude)
    # sin is lowest at three quarters of the turn; there the triangle has to be highest
    compensation = TURN // 4 * 65_536 // TURN | (-height // 2 & 0xFF) << 16 | height << 24
    encoder = {**AT_ZERO, "lines": 1 << 20, "eccentricity_deg": eccentricity_deg}
    plain, helped = loose(encoder=encoder), loose({ENC_COMP: compensation}, encoder=encoder)
    places = np.arange(0, TURN, 200) + 0.5
    for bench in (plain, helped):
        bench.turn_by_hand(0.0)
        bench.write({ENC_POS: 0})
    errors = {}
    for name, bench in (("plain", plain), ("helped", helped)):
        shown = []
        for place in places:
            bench.turn_by_hand(float(place))
            shown.append(bench.read(ENC_POS))
        wrong = np.array(shown) - places
        errors[name] = float(np.ptp(wrong)) / 2
    assert errors["plain"] == pytest.approx(amplitude, rel=0.02)
    assert errors["helped"] / amplitude == pytest.approx(0.14, abs=0.015)


@pytest.mark.sheet("DS-TMC4361", "14.5")
def test_the_triangle_is_lowest_at_xoffset_and_yoffset_is_signed() -> None:
    bench = loose({ENC_COMP: 0x4000 | (-100 & 0xFF) << 16 | 200 << 24}, encoder={**AT_ZERO, "lines": 1 << 20})
    offsets = []
    for quarter in range(4):
        bench.turn_by_hand(quarter * TURN / 4 + 0.01)
        offsets.append(bench.read(ENC_POS) - quarter * TURN // 4)
    assert offsets == pytest.approx([0, -100, 0, 100], abs=1)


# --- velocity (section 7) ------------------------------------------------------------------------------


class PlainSpeed:
    """V_ENC and V_ENC_MEAN again, slowly, from the places of the shaft and the rules in the unit's docstring."""

    def __init__(self, constant: float, interval: int, wait: int, exponent: int) -> None:
        self.constant, self.interval, self.wait, self.exponent = constant, interval, wait, exponent
        self.now = self.updated = self.filtered = 0
        self.edge = self.last_edge = 0.0
        self.place = self.counted = 0.0
        self.v = 0
        self.mean = 0

    def turn(self, place: float) -> None:
        """The shaft goes there in 256 clocks; the unit looks in the middle and at the end."""
        self.tick(self.place)
        self.tick(place)

    def tick(self, place: float) -> None:
        self.now += 128
        before, after = math.floor(self.place + 0.5), math.floor(place + 0.5)
        if after != before:
            border = after - 0.5 if after > before else after + 0.5
            self.edge = self.now - 256 * (place - border) / (place - self.place)
        self.place = place
        if self.now - self.updated >= self.interval:
            if after != self.counted:
                self.v = math.floor((after - self.counted) * self.constant * 16e6 / (self.edge - self.last_edge) + 0.5)
                self.last_edge, self.counted = self.edge, after
            else:
                most = math.floor(self.constant * 16e6 / (self.now - self.last_edge))
                self.v = max(-most, min(most, self.v))
            self.updated = self.now
        while self.now - self.filtered >= self.wait:
            self.filtered += self.wait
            self.mean += math.floor((self.v * 65536 - self.mean) / 2**self.exponent)


@pytest.mark.sheet("DS-TMC4361", "14.2")
@pytest.mark.parametrize(("interval", "wait", "exponent"), [(500, 100, 7), (256, 33, 2), (4000, 255, 5)])
def test_velocities_are_those_of_a_slow_reference(interval: int, wait: int, exponent: int) -> None:
    bench = loose({ENC_VMEAN: wait | exponent << 8 | interval << 16}, encoder={**AT_ZERO, "lines": 2500})
    reference = PlainSpeed(5.12 + 0.0, interval, wait, exponent)
    reference.constant = round(5.12 * 65536) / 65536
    place = 0.0
    for tick in range(4000):
        place += 3.0 * math.sin(tick / 300)  # microsteps: up to 187,500 pps either way
        bench.turn_by_hand(place)
        reference.turn(place / 5.12)
        assert abs(bench.read(V_ENC) - reference.v) <= 1
        assert abs(bench.read(0x66) - (reference.mean + 32768 >> 16)) <= 1


def test_v_enc_is_the_shafts_velocity_and_its_mean_follows_with_the_time_constant() -> None:
    bench = loose({ENC_VMEAN: 100 | 7 << 8 | 500 << 16}, encoder=AT_ZERO)
    place, mean = 0.0, []
    for _ in range(1250):
        place += 51_200 * MOTOR_S
        bench.turn_by_hand(place)
        mean.append(bench.read(0x66))
    assert bench.read(V_ENC) == pytest.approx(51_200, rel=0.01)
    assert mean[-1] == pytest.approx(51_200, rel=0.01)
    reached = next(tick for tick, value in enumerate(mean) if value > 51_200 * (1 - math.exp(-1))) * MOTOR_S
    assert reached == pytest.approx(2**7 * 100 / 16e6, rel=0.1)  # 0.8 ms


@pytest.mark.sheet("DS-TMC4361", "17.19")
def test_an_encoder_without_counts_stands() -> None:
    bench = loose({ENC_VEL_ZERO: 16_000, ENC_VMEAN: 100 | 2 << 8 | 500 << 16})
    for tick in range(500):
        bench.turn_by_hand(tick * 0.8)
    assert bench.read(V_ENC) != 0
    assert not bench.word & FB_ENC_VEL0
    bench.ticks(100)
    assert not bench.word & FB_ENC_VEL0  # 12,800 clocks
    bench.ticks(30)
    assert bench.word & FB_ENC_VEL0
    assert (bench.read(V_ENC), bench.read(0x66)) == (0, 0)


def test_a_bench_at_rest_tells_that_nothing_will_happen() -> None:
    bench = Bench({ENC_VEL_ZERO: 4_800_000})
    assert not bench.run(0.29) & FB_QUIET  # V_ENC may still have to become 0
    bench.run(0.1)
    assert bench.word & FB_QUIET
    before = bench.unit.fb.copy()
    bench.unit.write(CL_OFFSET, 0)
    bench.ticks(4)
    assert bench.word & FB_QUIET
    changed = {int(cell) for cell in np.flatnonzero(before.view(np.int64) != bench.unit.fb.view(np.int64))}
    assert len(changed) <= 4  # clocks, standstill counter: no place, no current, no speed
    assert bench.unit.plant_state.speed_rad_s == 0.0


# --- serial encoders (sections 1 and 3) ------------------------------------------------------------------


def absolute(conf: int = 0, mode: int = SSI, registers: dict[int, int] | None = None, **encoder: object) -> Bench:
    """An absolute encoder of 13 bits, with 12 turn bits before them for `MULTI`, the chip set to read it."""
    kind, turns = "ssi" if mode == SSI else "spi", 12 if conf & MULTI else 0
    bench = loose(encoder={"kind": kind, "single_turn_bits": 13, "multi_turn_bits": turns, **AT_ZERO, **encoder})
    settings = {GENERAL_CONF: mode, ENC_IN_CONF: conf, ENC_IN_DATA: 12 | 11 << 5}
    bench.write(settings | dict(registers or {}))
    return bench


def put(bench: Bench, microsteps: float) -> int:
    """Turn the shaft there and wait for two requests."""
    bench.change(rotor_fullsteps=microsteps / 256)
    return bench.run(2e-3)


@pytest.mark.sheet("DS-TMC4361", "14.3")
@pytest.mark.parametrize("gray", [False, True])
@pytest.mark.parametrize("mode", [SSI, SPI])
def test_an_absolute_encoder_tells_its_place_in_the_turn(mode: int, gray: bool) -> None:
    bench = absolute(GRAY * gray, mode=mode, gray=gray)
    for place in (0, 10_000, 51_190, 51_300, -100, 30_000_000):
        put(bench, place)
        assert bench.read(ENC_POS) == pytest.approx(place % TURN, abs=7)


def test_it_knows_its_place_after_power_on() -> None:
    bench = absolute(MULTI)
    put(bench, 123_456)
    bench.unit.reset()
    bench.write({GENERAL_CONF: SSI, ENC_IN_CONF: MULTI, ENC_IN_DATA: 12 | 11 << 5, ENC_IN_RES: 8192})
    bench.run(1e-3)
    assert bench.read(ENC_POS) == pytest.approx(123_456, abs=7)


@pytest.mark.sheet("DS-TMC4361", "14.3")
def test_turns_may_be_signed() -> None:
    unsigned, with_sign = absolute(MULTI), absolute(MULTI | MULTI_SIGNED)
    put(unsigned, -10_000)
    put(with_sign, -10_000)
    assert with_sign.read(ENC_POS) == pytest.approx(-10_000, abs=7)
    assert unsigned.read(ENC_POS) == pytest.approx(4096 * TURN - 10_000, abs=7)


@pytest.mark.sheet("DS-TMC4361", "14.3")
def test_turns_are_counted_from_single_turn_data_while_steps_stay_below_half_a_turn() -> None:
    bench = absolute(CALC_MULTI)
    put(bench, 0)
    for place in range(0, -200_000, -20_000):
        put(bench, place)
    assert bench.read(ENC_POS) == pytest.approx(-180_000, abs=7)
    put(bench, -180_000 + 30_000)  # more than half a turn at once: taken for a step back
    assert bench.read(ENC_POS) == pytest.approx(-180_000 + 30_000 - TURN, abs=7)


def test_requests_come_every_ser_ptime() -> None:
    bench = absolute(registers={SER_PTIME: 160_000})  # 10 ms
    bench.run(0.02)
    bench.change(rotor_fullsteps=40.0)
    bench.ticks(2)
    waited = 0.0
    while bench.read(ENC_POS) == 0 and waited < 0.02:
        bench.ticks(2)
        waited += MOTOR_S
    assert waited <= 0.01
    bench.change(rotor_fullsteps=80.0)
    seen = bench.read(ENC_POS)
    bench.run(0.0098)
    assert bench.read(ENC_POS) == seen
    bench.run(0.0004)
    assert bench.read(ENC_POS) == pytest.approx(80 * 256, abs=7)


def test_a_wrong_width_reads_nonsense_as_it_would_on_a_bench() -> None:
    bench = absolute(MULTI)
    bench.write({ENC_IN_CONF: 0})  # asked for 13 bits, the encoder begins with its turns
    put(bench, 10_000 + 7 * TURN)
    assert abs(bench.read(ENC_POS) - 10_000) > 1000


@pytest.mark.sheet("DS-TMC4361", "17.9")
def test_status_bits_of_the_encoder_come_through() -> None:
    bench = absolute(MULTI | LEFT, status_bits=2)
    bench.write({ENC_IN_DATA: 12 | 11 << 5 | 2 << 10})
    bench.change(encoder={"status_bits": 2})
    put(bench, 10_000)
    assert bench.word >> 20 & 15 == 2
    assert bench.read(ENC_POS) == pytest.approx(10_000, abs=7)


@pytest.mark.sheet("DS-TMC4361", "14.3")
def test_a_jump_beyond_the_variation_limit_is_refused() -> None:
    # 64/256 of an eighth of 8192 counts: 256 counts, 1600 microsteps
    bench = absolute(LIMIT, registers={ENC_VMEAN: 64})
    put(bench, 20_000)
    start = bench.read(ENC_POS)
    assert not put(bench, start + 1590) & FB_SER_FAIL
    place = bench.read(ENC_POS)
    assert put(bench, place + 1620) & FB_SER_FAIL
    assert bench.read(ENC_POS) == place
    assert bench.word & FB_MULTI_FAIL


@pytest.mark.sheet("DS-TMC4361", "14.3")
def test_asking_twice_finds_a_bit_that_was_lost_on_the_way() -> None:
    once, twice = absolute(MULTI), absolute(MULTI | MULTI_CYCLE)
    for bench, fooled in ((once, True), (twice, False)):
        put(bench, 5000)
        bench.change(encoder={"spoil_next": 1 << 12})
        seen = bench.run(0.6e-3)
        assert bool(seen & FB_SER_FAIL) is not fooled
    bench = absolute(MULTI)
    bench.write({SER_PTIME: 16_000})
    put(bench, 5000)
    bench.change(encoder={"spoil_next": 1 << 12})
    bench.run(1.1e-3)
    assert abs(bench.read(ENC_POS) - 5000) > 1000  # nobody noticed


@pytest.mark.sheet("DS-TMC4361", "17.21")
def test_registers_of_an_spi_encoder_are_exchanged() -> None:
    bench = absolute(mode=SPI)
    bench.write({0x68: 0x23, 0x69: 0xCAFE})
    assert bench.run(1e-3) & FB_SER_DONE
    bench.write({0x68: 0x24})
    bench.run(1e-3)
    assert (bench.unit.read(0x6A), bench.unit.read(0x6B)) == (0x24, 0)
    bench.write({0x68: 0x23})
    bench.run(1e-3)
    assert (bench.unit.read(0x6A), bench.unit.read(0x6B)) == (0x23, 0xCAFE)


def test_registers_read_back_with_their_signs() -> None:
    bench = loose({CL_OFFSET: -300 & 0xFFFFFFFF})
    assert signed(bench.unit.read(CL_OFFSET)) == -300
    assert bench.unit.read(0x24) is None  # VMAX is the ramp generator's


def _with_encoder(lines: int, conf: int) -> tuple[Floats, Cells]:
    cells = FeedbackUnit(FeedbackOptions(encoder=ShaftEncoder(lines=lines)), F_CLK).fb
    integers = cells[layout.INTEGERS_AT :].view(np.int64)
    integers[layout.ENC_IN_CONF] = conf
    return cells, integers


@pytest.mark.parametrize("armed", range(4))
@pytest.mark.parametrize("sensitivity", range(4))
def test_many_counts_at_once_are_as_good_as_one_after_another(armed: int, sensitivity: int) -> None:
    random = Random(armed * 4 + sensitivity)
    for _ in range(40):
        conf = random.getrandbits(32) & ~0b110_1100 | sensitivity << 5 | armed << 2
        at_once, one_by_one = _with_encoder(50, conf), _with_encoder(50, conf)
        old = random.randrange(-500, 500)
        new = old + random.choice((-1, 1)) * random.randrange(1, 390)
        word = pass_counts(*at_once, old, new)
        way, each = (1 if new > old else -1), 0
        for count in range(old, new, way):
            each |= pass_counts(*one_by_one, count, count + way)
        assert word == each
        assert at_once[0].tobytes() == one_by_one[0].tobytes()


@pytest.mark.timeout(100)  # count by count these would take ten minutes
def test_a_shaft_that_runs_away_costs_no_more_than_one_that_turns() -> None:
    """As with a load that no motor holds: an emulator that falls behind keeps everything else from being answered."""
    turn = 4 * 4_194_304
    encoder = _with_encoder(4_194_304, 0b1_0001_0100)
    for number in range(20_000):
        pass_counts(*encoder, number * turn, number * turn + turn - 1)
    assert encoder[1][layout.N_LEVEL] == 0
