"""Ramps of an emulated TMC4361 against the planner of calc/, the data sheet's rules, and a plain tick-by-tick law."""

from __future__ import annotations

import itertools
import math
import random
from dataclasses import replace

import pytest

from app.calc.ramps.sramp import SRamp, position_plan, velocity_plan
from tests.emulators.tmc4361.moves import random_ramp
from tests.emulators.tmc4361.rig import (
    HOLD_POSITION,
    HOLD_VELOCITY,
    S_POSITION,
    S_VELOCITY,
    TICK_S,
    TRAPEZOID_POSITION,
    TRAPEZOID_VELOCITY,
    Ramp,
    Rig,
)

BASE = Ramp()


def planned(ramp: Ramp) -> SRamp:
    """The ramp as the registers hold it."""
    return SRamp(
        vmax=ramp.vmax,
        amax=ramp.amax,
        dmax=ramp.dmax,
        bow1=ramp.bow1,
        bow2=ramp.bow2,
        bow3=ramp.bow3,
        bow4=ramp.bow4,
        vstart=ramp.vstart,
        vstop=ramp.vstop,
        astart=ramp.astart,
        dfinal=ramp.dfinal,
    )


def rounded(ramp: Ramp) -> Ramp:
    """The ramp cut to the registers' formats."""
    words = ramp.words()
    scales = {"V": 256, "A": 4, "D": 4, "B": 1}
    return Ramp(**{name.lower(): word / scales[name[0]] for name, word in words.items()})


def curve(rig: Rig, seconds: float, looks: int) -> list[tuple[float, int, int, int]]:
    """(time since now [s], XACTUAL, VACTUAL, AACTUAL) at `looks` instants."""
    begin_s = rig.now_s
    found = []
    for look in range(1, looks + 1):
        rig.now_s = begin_s + seconds * look / looks
        found.append((rig.now_s - begin_s, rig.position, rig.signed("VACTUAL"), rig.signed("AACTUAL")))
    return found


# --- against the planner -----------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "8.2")
@pytest.mark.parametrize("seed", range(12))
def test_an_s_ramp_from_rest_to_rest_is_the_planner_s_within_a_tick(seed: int) -> None:
    source = random.Random(seed)
    ramp = rounded(replace(random_ramp(source, S_POSITION), vstart=0.0, vstop=0.0))
    distance = source.choice((-1, 1)) * round(ramp.vmax * source.choice((0.05, 0.3, 1.0)))
    plan = position_plan(planned(ramp), distance)
    rig = Rig()
    rig.ramp(ramp, S_POSITION)
    rig.write("XTARGET", distance)
    for t, x, v, a in curve(rig, plan.duration_s * 1.1, 60):
        wanted = plan.at(t - TICK_S / 2)
        slack_s = TICK_S  # XACTUAL is of the latest tick
        assert abs(x - float(wanted.position)) <= 1.0 + slack_s * ramp.vmax
        assert abs(v - float(wanted.velocity_pps)) <= 1.0 + slack_s * max(ramp.amax, ramp.dmax)
        assert abs(a - float(wanted.acceleration_pps2)) <= 1.0 + slack_s * 2**24 or t < 2 * TICK_S
    assert rig.position == distance


@pytest.mark.parametrize("seed", range(8))
def test_an_s_ramp_with_vstart_and_vstop_takes_as_long_as_planned(seed: int) -> None:
    source = random.Random(100 + seed)
    ramp = rounded(replace(random_ramp(source, S_POSITION), vstart=200.0, vstop=500.0))
    distance = round(ramp.vmax * 0.7)
    plan = position_plan(planned(ramp), distance)
    rig = Rig()
    rig.ramp(ramp, S_POSITION)
    rig.write("XTARGET", distance)
    rig.wait(plan.duration_s - 3 * TICK_S)
    assert rig.state().ramp.kind == "ramp"
    rig.wait(6 * TICK_S)
    assert rig.state().ramp.kind == "rest"
    assert rig.position == distance


@pytest.mark.parametrize("seed", range(12))
def test_velocities_are_changed_on_the_fly_as_planned(seed: int) -> None:
    source = random.Random(200 + seed)
    ramp = rounded(replace(random_ramp(source, S_VELOCITY), vstart=0.0, vstop=0.0, astart=0.0, dfinal=0.0))
    rig = Rig()
    rig.ramp(ramp, S_VELOCITY)
    rig.wait(source.uniform(0.0, 0.5))
    now = rig.state().ramp
    goal = round(ramp.vmax * source.uniform(-1.0, 1.0) * 256) / 256
    plan = velocity_plan(planned(ramp), goal, now.velocity_pps, now.acceleration_pps2)
    begin = rig.position
    rig.write("VMAX", round(goal * 256))
    for t, x, v, _ in curve(rig, plan.duration_s + 0.01, 40):
        wanted = plan.at(t)
        assert abs(x - begin - float(wanted.position)) <= 2.0 + 2 * TICK_S * ramp.vmax
        assert abs(v - float(wanted.velocity_pps)) <= 1.0 + 2 * TICK_S * max(ramp.amax, ramp.dmax)


@pytest.mark.parametrize("seed", range(12))
def test_a_target_changed_on_the_fly_is_reached_as_soon_as_planned(seed: int) -> None:
    source = random.Random(300 + seed)
    ramp = rounded(replace(random_ramp(source, S_POSITION), vstart=0.0, vstop=0.0, astart=0.0, dfinal=0.0))
    rig = Rig()
    rig.ramp(ramp, S_POSITION)
    rig.write("XTARGET", round(ramp.vmax))
    rig.wait(source.uniform(0.0, 0.6))
    now = rig.state().ramp
    target = source.choice((-1, 1)) * round(ramp.vmax * source.uniform(0.0, 1.0))
    plan = position_plan(planned(ramp), target - now.position, now.velocity_pps, now.acceleration_pps2)
    rig.write("XTARGET", target)
    rig.wait(max(plan.duration_s - 3 * TICK_S, 0.0))
    assert rig.state().ramp.kind == "ramp"
    rig.wait(6 * TICK_S)
    assert rig.state().ramp.kind == "rest"
    assert rig.position == target


# --- a plain law ---------------------------------------------------------------------------------------------------


def slope_by_ticks(vmax: float, amax: float, bow_up: float, bow_down: float) -> tuple[float, float]:
    """(seconds, pulses) of an S-slope from rest to `vmax`, worked out tick by tick with the bow update of DS-TMC4361
    8.2."""
    v = a = x = t = 0.0
    falling = False
    while v < vmax and t < 100:
        falling = falling or vmax - v <= a * a / (2 * bow_down)
        a = max(a - bow_down * TICK_S, 0.0) if falling else min(a + bow_up * TICK_S, amax)
        if falling and a == 0.0:
            break
        v += a * TICK_S
        x += v * TICK_S
        t += TICK_S
    return t, x


@pytest.mark.sheet("DS-TMC4361", "8.2")
@pytest.mark.parametrize(
    ("bow", "seconds", "pulses"), [(2e6, 0.35, 8750.0), (4e5, 0.7071, 17678.0), (8e5, 0.5, 12500.0)]
)
def test_slopes_are_those_of_a_plain_tick_law(bow: float, seconds: float, pulses: float) -> None:
    """The three cases of the fact sheet: with B12, AMAX not reached, and just reached."""
    t, x = slope_by_ticks(50_000.0, 200_000.0, bow, bow)
    assert t == pytest.approx(seconds, rel=6e-3)
    assert x == pytest.approx(pulses, rel=6e-3)
    rig = Rig()
    rig.ramp(replace(BASE, bow1=bow, bow2=bow, bow3=bow, bow4=bow), S_VELOCITY)
    rig.wait(seconds - 1e-3)
    assert not rig.flag(2)
    rig.wait(2e-3)
    assert rig.flag(2)
    assert rig.position == pytest.approx(x, rel=1e-2)
    assert rig.signed("VACTUAL") == 50_000


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_the_bow_changes_the_acceleration_every_64_clocks() -> None:
    rig = Rig()
    rig.ramp(BASE, S_VELOCITY)
    seen = []
    for clock in range(0, 64 * 20, 16):
        rig.now_s = clock / 16e6
        seen.append(rig.state().ramp.acceleration_pps2)
    steps = sorted(set(seen))
    assert [round(b - a, 6) for a, b in itertools.pairwise(steps)] == [8.0] * (len(steps) - 1)
    assert all(seen.count(step) == 4 for step in steps[1:-1])


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_a_trapezoid_with_a_break_has_the_four_slopes_of_the_worked_example() -> None:
    ramp = Ramp(
        vmax=50_000, vstart=1000, vbreak=10_000, vstop=2000, astart=50_000, amax=200_000, dmax=250_000, dfinal=60_000
    )
    rig = Rig()
    rig.ramp(ramp, TRAPEZOID_POSITION)
    rig.write("XTARGET", 12_590)  # the sum of the slopes: no time at VMAX
    seen = []
    for _ in range(66):
        rig.wait(0.01)
        seen.append((rig.signed("VACTUAL"), rig.signed("AACTUAL")))
    expected = [50_000] * 17 + [200_000] * 20 + [-250_000] * 16 + [-60_000] * 12
    accelerations = [a for _, a in seen]
    for a in (50_000, 200_000, -250_000, -60_000):
        assert abs(accelerations.count(a) - expected.count(a)) <= 2
    assert max(v for v, _ in seen) == pytest.approx(50_000, abs=2500)
    rig.wait(0.02)
    assert rig.position == 12_590
    assert rig.now_s == pytest.approx(0.18 + 0.20 + 0.16 + 0.1333, abs=0.01)


@pytest.mark.sheet("DS-TMC4361", "8.2")
@pytest.mark.parametrize("sign", [1, -1])
def test_a_hold_ramp_jumps_to_vmax_and_at_the_target_to_zero(sign: int) -> None:
    rig = Rig()
    rig.ramp(BASE, HOLD_POSITION)
    rig.write("XTARGET", sign * 5000)
    assert rig.signed("VACTUAL") == sign * 50_000
    rig.wait(0.1 - TICK_S)
    assert rig.signed("VACTUAL") == sign * 50_000
    rig.wait(2 * TICK_S)
    assert (rig.signed("VACTUAL"), rig.position) == (0, sign * 5000)


@pytest.mark.sheet("DS-TMC4361", "1.5")
@pytest.mark.sheet("DS-TMC4361", "1.5.1")
@pytest.mark.sheet("DS-TMC4361", "8")
@pytest.mark.sheet("DS-TMC4361", "17.16")
@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_in_velocity_mode_the_sign_of_vmax_counts_and_in_positioning_it_does_not() -> None:
    rig = Rig()
    rig.ramp(replace(BASE, vmax=-20_000.0), HOLD_VELOCITY)
    rig.wait(0.1)
    assert rig.position == pytest.approx(-2000, abs=1)
    rig.write("XACTUAL", 0)
    rig.write("XTARGET", 100)
    rig.write("RAMPMODE", HOLD_POSITION)
    rig.wait(0.1)
    assert rig.position == 100


# --- VSTART, VSTOP ------------------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "8.2.1")
def test_with_vstart_an_s_ramp_begins_with_amax_and_without_b1() -> None:
    rig = Rig()
    rig.ramp(replace(BASE, vstart=1000.0, astart=5000.0), S_VELOCITY)
    ramp = rig.state().ramp
    assert (ramp.velocity_pps, ramp.acceleration_pps2) == (1000.0, 200_000.0)


@pytest.mark.sheet("DS-TMC4361", "8.2.1")
def test_astart_is_used_without_vstart_and_by_choice_with_it() -> None:
    rig = Rig()
    rig.ramp(replace(BASE, astart=5000.0), S_VELOCITY)
    assert rig.state().ramp.acceleration_pps2 == 5000.0
    rig = Rig()
    rig.write("GENERAL_CONF", 0x6021)
    rig.ramp(replace(BASE, vstart=1000.0, astart=5000.0), S_VELOCITY)
    ramp = rig.state().ramp
    assert (ramp.velocity_pps, ramp.acceleration_pps2) == (1000.0, 5000.0)


@pytest.mark.sheet("DS-TMC4361", "8.2.1")
@pytest.mark.parametrize("mode", [TRAPEZOID_VELOCITY, S_VELOCITY])
def test_vstop_ends_a_ramp_to_zero_and_no_other(mode: int) -> None:
    rig = Rig()
    rig.ramp(replace(BASE, vstop=5000.0), mode)
    rig.wait(1.0)
    rig.write("VMAX", 1000 << 8)  # below VSTOP, but not zero
    rig.wait(1.0)
    assert rig.signed("VACTUAL") == 1000
    rig.write("VMAX", 50_000 << 8)
    rig.wait(1.0)
    rig.write("VMAX", 0)
    slowest = 50_000
    for _ in range(2000):
        rig.wait(0.0005)
        v = rig.signed("VACTUAL")
        if v == 0:
            break
        slowest = min(slowest, v)
    assert v == 0
    assert 5000 <= slowest < 5200


@pytest.mark.sheet("DS-TMC4361", "8.2.1")
@pytest.mark.parametrize("mode", [TRAPEZOID_VELOCITY, S_VELOCITY])
def test_a_reversal_passes_zero_without_vstart_and_vstop(mode: int) -> None:
    rig = Rig()
    rig.ramp(replace(BASE, vstart=8000.0, vstop=8000.0), mode)
    rig.wait(1.0)
    rig.write("VMAX", -50_000 << 8)
    speeds = []
    for _ in range(600):
        rig.wait(0.001)
        speeds.append(rig.signed("VACTUAL"))
    assert speeds[-1] == -50_000
    assert max(abs(b - a) for a, b in itertools.pairwise(speeds)) < 300  # no jump anywhere


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_dfinal_ends_an_s_ramp_in_velocity_mode_and_is_ignored_in_positioning() -> None:
    rig = Rig()
    ramp = replace(BASE, dfinal=100_000.0)
    rig.ramp(ramp, S_VELOCITY)
    rig.wait(1.0)
    rig.write("VMAX", 0)
    last = 0.0
    while (now := rig.state().ramp).kind != "rest":
        last = now.acceleration_pps2
        rig.wait(20 * TICK_S)
    assert last == pytest.approx(-100_000, rel=0.01)
    rig = Rig()
    rig.ramp(ramp, S_POSITION)
    rig.write("XTARGET", 20_000)
    while (now := rig.state().ramp).kind != "rest":
        last = now.acceleration_pps2
        rig.wait(0.0005)
    assert abs(last) < 1100


# --- limitations ---------------------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_a_changed_ramp_parameter_may_overshoot_and_is_corrected() -> None:
    rig = Rig()
    rig.ramp(replace(BASE, bow1=1e7, bow2=1e7, bow3=1e7, bow4=1e7), S_POSITION)
    rig.write("XTARGET", 20_000)
    while rig.signed("AACTUAL") > -150_000:
        rig.wait(0.001)
    rig.write("DMAX", 50_000 << 2)
    highest = 0
    while rig.state().ramp.kind != "rest":
        rig.wait(0.001)
        highest = max(highest, rig.position)
    assert highest > 20_000
    assert rig.position == 20_000


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_vmax_zero_alone_does_not_stop_an_s_ramp_that_positions() -> None:
    """The sheet forbids it and does not say what happens: here it is not obeyed. Both ways that it names work."""
    rig = Rig()
    rig.ramp(BASE, S_POSITION)
    rig.write("XTARGET", 100_000)
    rig.wait(0.5)
    rig.write("VMAX", 0)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == 50_000
    rig.write("RAMPMODE", S_VELOCITY)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == 0
    assert "VEL_REACHED" in rig.events()
    rig.write("RAMPMODE", S_POSITION)
    rig.write("VMAX", 50_000 << 8)
    rig.wait(0.5)
    rig.write("VMAX", 1 << 8)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == 1
    assert "VEL_REACHED" in rig.events()
    rig.write("VMAX", 0)
    rig.wait(0.01)
    assert rig.signed("VACTUAL") == 0
    stood = rig.position
    rig.wait(1.0)
    assert rig.position == stood < 100_000


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_a_trapezoid_that_slows_down_finishes_that_before_it_speeds_up_again() -> None:
    rig = Rig()
    rig.ramp(BASE, TRAPEZOID_POSITION)
    rig.write("XTARGET", 20_000)
    while rig.signed("AACTUAL") >= 0:
        rig.wait(0.001)
    rig.wait(0.05)
    rig.write("XTARGET", 60_000)
    lowest = 50_000
    while rig.position < 25_000:
        rig.wait(0.0005)
        lowest = min(lowest, rig.signed("VACTUAL"))
    assert lowest < 200
    rig.wait_for_rest()
    assert rig.position == 60_000


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_setting_vmax_below_the_speed_first_avoids_that() -> None:
    rig = Rig()
    rig.ramp(BASE, TRAPEZOID_VELOCITY)
    rig.wait(1.0)
    rig.write("VMAX", 10_000 << 8)
    rig.wait(0.1)
    assert rig.signed("AACTUAL") == -200_000
    now = rig.signed("VACTUAL")
    rig.write("VMAX", (now - 2000) << 8)
    rig.wait(0.05)
    assert rig.signed("VACTUAL") == now - 2000
    rig.write("VMAX", 50_000 << 8)
    lowest = 50_000
    for _ in range(400):
        rig.wait(0.001)
        lowest = min(lowest, rig.signed("VACTUAL"))
    assert lowest >= now - 2000


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
@pytest.mark.parametrize(("dmax", "overruns"), [(50.0, True), (2500.0, False)])
def test_a_very_slow_trapezoid_overruns_the_target_and_comes_back(dmax: float, overruns: bool) -> None:
    """How far the sheet does not say: a step here."""
    rig = Rig()
    rig.ramp(Ramp(vmax=1000.0, amax=10_000.0, dmax=dmax), TRAPEZOID_POSITION)
    rig.write("XTARGET", 12_000)
    rig.wait(10.0 if overruns else 11.0)
    highest = 0
    while rig.state().ramp.kind != "rest" or rig.position != 12_000:
        rig.wait(0.05)
        highest = max(highest, rig.position)
        assert rig.now_s < 100
    assert highest == (12_001 if overruns else 12_000)


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_the_speed_may_exceed_a_vmax_that_was_lowered_while_a_bow_is_finished() -> None:
    rig = Rig()
    rig.ramp(BASE, S_POSITION)
    rig.write("XTARGET", 100_000)
    rig.wait(0.1)
    speed = rig.signed("VACTUAL")
    rig.write("VMAX", speed << 8)
    fastest = 0
    for _ in range(200):
        rig.wait(0.001)
        fastest = max(fastest, rig.signed("VACTUAL"))
    assert fastest > speed + 1000
    rig.wait(0.3)
    assert rig.signed("VACTUAL") == speed


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_an_astart_that_does_not_fit_vmax_is_altered() -> None:
    rig = Rig()
    rig.ramp(replace(BASE, vmax=1000.0, astart=200_000.0), S_VELOCITY)
    assert rig.state().ramp.acceleration_pps2 == pytest.approx(math.sqrt(2 * 2e6 * 1000.0))
    fastest = 0
    for _ in range(100):
        rig.wait(0.0005)
        fastest = max(fastest, rig.signed("VACTUAL"))
    assert fastest == 1000


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_a_vstart_too_high_for_the_way_overshoots_and_comes_back_without_it() -> None:
    rig = Rig()
    rig.ramp(replace(BASE, vstart=20_000.0), S_POSITION)
    rig.write("XTARGET", 10)
    highest = 0
    for _ in range(2000):
        rig.wait(0.001)
        highest = max(highest, rig.position)
    assert highest > 1000
    assert rig.position == 10


# --- units ---------------------------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "8.2.3")
def test_direct_values_are_changes_a_clock() -> None:
    rig = Rig()
    rig.write("GENERAL_CONF", 0x6020 | 2 | 4)
    for name, word in (
        ("VMAX", 100_000 << 8),
        ("AMAX", 5369),
        ("DMAX", 5369),
        *((f"BOW{n}", 220) for n in (1, 2, 3, 4)),
    ):
        rig.write(name, word)
    rig.write("RAMPMODE", S_VELOCITY)
    rig.wait(1e-4)
    assert rig.signed("AACTUAL") == pytest.approx(100.04e6 * 1e-4, rel=0.05)  # 100 Mpps^3
    rig.write("RAMPMODE", TRAPEZOID_VELOCITY)
    rig.write("VMAX", 1000_000 << 8)
    assert rig.signed("AACTUAL") == pytest.approx(10e6, rel=1e-3)  # 10 Mpps^2


@pytest.mark.sheet("DS-TMC4361", "8.2.3")
def test_velocities_are_of_the_clock_that_clk_freq_tells() -> None:
    rig = Rig()
    rig.write("CLK_FREQ", 8_000_000)  # the oscillator has 16 MHz
    rig.ramp(BASE, HOLD_VELOCITY)
    rig.wait(0.1)
    assert rig.signed("VACTUAL") == 50_000
    assert rig.position == pytest.approx(10_000, abs=1)


@pytest.mark.sheet("DS-TMC4361", "8.2.3")
def test_vactual_and_aactual_have_no_decimals() -> None:
    rig = Rig()
    rig.ramp(replace(BASE, vmax=-1000.75), HOLD_VELOCITY)
    assert rig.signed("VACTUAL") == -1000


def test_without_an_acceleration_no_ramp_begins() -> None:
    for missing in ("amax", "bow1", "bow2"):
        rig = Rig()
        rig.ramp(replace(BASE, **{missing: 0.0}), S_POSITION)
        rig.write("XTARGET", 1000)
        rig.wait(1.0)
        assert (rig.position, rig.state().ramp.kind) == (0, "rest")


def test_an_undefined_rampmode_changes_nothing() -> None:
    rig = Rig()
    rig.ramp(BASE, S_VELOCITY)
    rig.wait(1.0)
    rig.write("RAMPMODE", 3)
    rig.wait(1.0)
    assert rig.signed("VACTUAL") == 50_000


def test_tzerowait_rests_before_the_next_ramp() -> None:
    rig = Rig()
    rig.ramp(BASE, TRAPEZOID_POSITION)
    rig.write("TZEROWAIT", 1_600_000)
    rig.write("XTARGET", 100)
    while rig.position != 100:
        rig.wait(0.001)
    rig.write("XTARGET", 0)
    rig.wait(0.098)
    assert rig.position == 100
    rig.wait(0.2)
    assert rig.position == 0


# --- robustness ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mode", [TRAPEZOID_POSITION, S_POSITION])
@pytest.mark.parametrize("vstop", [0.0, 3000.0])
def test_writing_the_same_target_again_and_again_changes_nothing(mode: int, vstop: float) -> None:
    ramp = replace(BASE, vstop=vstop, bow2=1e6, bow4=5e6)
    durations = []
    for repeated in (False, True):
        rig = Rig()
        rig.ramp(ramp, mode)
        rig.write("XTARGET", 20_000)
        while rig.state().ramp.kind != "rest":
            rig.wait(0.001)
            if repeated:
                rig.write("XTARGET", 20_000)
        assert rig.position == 20_000
        durations.append(rig.now_s)
    assert durations[1] == pytest.approx(durations[0], abs=0.0021)


@pytest.mark.parametrize("begin", [2**31 - 100, -(2**31) + 100])
def test_positions_wrap_at_32_bits_and_the_way_is_the_short_one(begin: int) -> None:
    rig = Rig()
    rig.write("XACTUAL", begin)
    rig.write("XTARGET", begin)
    rig.ramp(BASE, S_POSITION)
    rig.write("XTARGET", -begin)
    rig.wait_for_rest()
    assert rig.position == -begin
    assert abs(rig.state().step_output.microsteps_256) == 200


def test_constant_velocity_stays_exact_for_minutes() -> None:
    rig = Rig()
    rig.ramp(Ramp(vmax=12_345.0), HOLD_VELOCITY)
    for seconds in (17.0, 60.0, 100.0):
        rig.now_s = seconds
        assert rig.position == pytest.approx(12_345 * seconds, abs=1)


def test_several_writes_in_one_tick_are_one_start() -> None:
    """VSTART is taken once, and the ramp that begins is that of all of them."""
    rig = Rig()
    rig.ramp(replace(BASE, vstart=1000.0), S_POSITION)
    rig.write("XTARGET", 5000)
    rig.write("VSTART", 2000 << 8)
    rig.write("XTARGET", 6000)
    assert rig.state().ramp.velocity_pps == 2000.0
    rig.write("XTARGET", 0)
    assert rig.state().ramp.kind == "rest"
    assert rig.signed("VACTUAL") == 0
