"""Motion: DS-TMC428 sections 8.1 to 8.8, 8.10 to 8.12 and 8.14; DS-TMC4210 section 6.1."""

from __future__ import annotations

from math import isqrt, sqrt

import pytest

from tests.emulators.harness import (
    A_ACTUAL,
    A_MAX,
    DIVIDERS,
    HOLD,
    INTERRUPT,
    MODE,
    NO_STOPS,
    RAMP,
    SOFT,
    V_ACTUAL,
    V_MAX,
    V_TARGET,
    VELOCITY,
    X_ACTUAL,
    X_TARGET,
    Bench,
    P,
    free_bench,
)

BOTH = pytest.mark.parametrize("model", ["tmc428", "tmc4210"])


def moving(model: str = "tmc428", mode: int = RAMP, **changed: int) -> Bench:
    bench = free_bench(model)
    bench.ramp(mode=mode, **changed)
    return bench


@pytest.mark.sheet("DS-TMC428", "8.1")
@pytest.mark.sheet("DS-TMC4210", "6.1.1")
@pytest.mark.sheet("DS-TMC4210", "1.5")
@BOTH
@pytest.mark.parametrize("target", [1, 5000, -1, -5000, 40_000])
def test_the_motor_goes_where_the_target_is(model: str, target: int) -> None:
    bench = moving(model)
    bench.write(X_TARGET, target)
    bench.seconds(1.0)
    assert (bench.x, bench.v) == (target, 0)


@pytest.mark.sheet("DS-TMC428", "8.1")
@pytest.mark.sheet("DS-TMC4210", "6.1.1")
@BOTH
def test_nothing_moves_after_power_on(model: str) -> None:
    bench = free_bench(model)
    bench.write(X_TARGET, 1000)
    bench.seconds(1.0)
    assert (bench.x, bench.v) == (0, 0)


@pytest.mark.sheet("DS-TMC428", "8.1")
@pytest.mark.sheet("DS-TMC428", "5")
@pytest.mark.parametrize("later", [-2000, 8000, 900])
def test_the_target_may_be_changed_during_motion(later: int) -> None:
    bench = moving()
    bench.write(X_TARGET, 3000)
    bench.ticks(2000)
    assert bench.v > 0
    bench.write(X_TARGET, later)
    bench.seconds(0.5)
    assert (bench.x, bench.v) == (later, 0)


@pytest.mark.sheet("DS-TMC428", "8.1")
@pytest.mark.parametrize(
    ("start", "target", "sign"), [(0x7FFFF0, -0x7FFFF0, 1), (-0x7FFFF0, 0x7FFFF0, -1), (0, -(2**23), -1)]
)
def test_the_shorter_way_round_the_24_bit_circle(start: int, target: int, sign: int) -> None:
    bench = moving()
    bench.write(MODE, VELOCITY)
    bench.write(X_ACTUAL, start)
    bench.write(X_TARGET, target)
    bench.write(MODE, RAMP | NO_STOPS)
    bench.ticks(100)
    assert bench.signed(V_TARGET, 12) * sign > 0


@pytest.mark.sheet("DS-TMC428", "8.2")
@pytest.mark.sheet("DS-TMC4210", "6.1.2")
@BOTH
def test_overwriting_the_position_in_ramp_mode_drives_back_to_the_target(model: str) -> None:
    bench = moving(model)
    bench.write(X_ACTUAL, 700)
    assert bench.x == 700
    bench.seconds(0.2)
    assert bench.x == 0


@pytest.mark.sheet("DS-TMC428", "8.4")
@pytest.mark.sheet("DS-TMC4210", "6.1.4")
@BOTH
def test_v_max_zero_holds_the_motor_while_positions_are_written(model: str) -> None:
    bench = moving(model, v_max=0)
    carriage = bench.place()
    bench.write(X_TARGET, 1234)
    bench.seconds(0.2)
    bench.write(X_ACTUAL, 1234)
    assert (bench.x, bench.place()) == (1234, carriage)


@pytest.mark.sheet("DS-TMC428", "8.3")
@pytest.mark.sheet("DS-TMC4210", "6.1.3")
def test_v_min_is_the_speed_of_the_last_steps_and_shortens_the_way() -> None:
    def time_of(v_min: int) -> float:
        bench = moving(v_min=v_min, a_max=20, p=24 << 8 | 7)  # 0.95 * 20 / 128
        bench.write(X_TARGET, 2000)
        while bench.x != 2000 or bench.v:
            bench.ticks(20)
            if bench.x > 1990 and bench.x != 2000:
                assert bench.signed(V_TARGET, 12) >= v_min
        return bench.clock.now()

    assert time_of(300) < time_of(1)


@pytest.mark.sheet("DS-TMC428", "8.3")
@pytest.mark.sheet("DS-TMC4210", "6.1.3")
def test_without_v_min_the_motor_may_stay_short_of_its_target() -> None:
    bench = moving(v_min=0, p=13)  # p = 128 / 2^16: sqrt(2048 p d) is below 1 only for d = 0, so take SOFT_MODE
    bench.write(MODE, SOFT | NO_STOPS)
    bench.write(X_TARGET, 5000)
    bench.seconds(30.0)
    assert 4000 < bench.x < 5000
    bench.write(0x02, 1)
    bench.seconds(30.0)
    assert bench.x == 5000


@pytest.mark.sheet("DS-TMC428", "8.4")
@pytest.mark.sheet("DS-TMC4210", "6.1.4")
def test_v_max_limits_the_speed_and_may_be_lowered_in_motion() -> None:
    bench = moving(v_max=900)
    bench.write(X_TARGET, 100_000)
    top = 0
    for _ in range(50):
        bench.ticks(40)
        top = max(top, bench.v)
    assert top == 900
    bench.write(V_MAX, 300)
    assert bench.v == 900  # above the limit until the ramp has brought it down
    bench.ticks(1)
    assert 890 < bench.v < 900
    bench.ticks(1000)
    assert bench.v == 300


@pytest.mark.sheet("DS-TMC428", "8.5")
@pytest.mark.sheet("DS-TMC4210", "6.1.5")
@BOTH
def test_v_target_is_the_users_in_velocity_mode_and_the_generators_in_ramp_mode(model: str) -> None:
    bench = moving(model, mode=VELOCITY)
    bench.write(V_TARGET, -700)
    bench.ticks(2000)
    assert (bench.signed(V_TARGET, 12), bench.v) == (-700, -700)
    bench.write(MODE, RAMP | NO_STOPS)
    bench.ticks(1)
    assert bench.signed(V_TARGET, 12) > 0
    bench.write(V_TARGET, 5)
    bench.ticks(1)
    assert bench.signed(V_TARGET, 12) != 5


@pytest.mark.sheet("DS-TMC428", "8.5")
def test_velocity_mode_keeps_to_v_max_and_a_max() -> None:
    bench = moving(mode=VELOCITY, v_max=500, a_max=256)
    bench.write(V_TARGET, 2000)
    bench.ticks(100)
    assert bench.v == 100
    bench.ticks(1000)
    assert (bench.v, bench.signed(V_TARGET, 12)) == (500, 2000)


@pytest.mark.sheet("DS-TMC428", "8.5")
@pytest.mark.sheet("DS-TMC428", "2.2")
@pytest.mark.sheet("DS-TMC4210", "1.5.2")
@BOTH
def test_hold_mode_ignores_v_target_and_all_limits(model: str) -> None:
    bench = moving(model, mode=HOLD, v_max=10, a_max=1)
    bench.write(V_TARGET, 1500)
    bench.ticks(500)
    assert (bench.v, bench.x) == (0, 0)
    bench.write(V_ACTUAL, -1800)
    assert bench.v == -1800
    bench.ticks(1000)
    assert bench.v == -1800
    assert bench.x == pytest.approx(-1800 * 1000 / 2048, abs=1)


@pytest.mark.sheet("DS-TMC428", "8.6")
@pytest.mark.sheet("DS-TMC4210", "6.1.6")
@pytest.mark.parametrize("mode", [RAMP, SOFT, VELOCITY])
def test_v_actual_is_read_only_outside_hold_mode(mode: int) -> None:
    bench = moving(mode=mode)
    bench.write(V_ACTUAL, 900)
    assert bench.v == 0


def hard_stop(bench: Bench) -> None:
    """As Trinamic's software for the chip stops a motor at once."""
    bench.write(MODE, VELOCITY | NO_STOPS)
    bench.write(V_TARGET, 0)
    bench.write(V_ACTUAL, 0)


@pytest.mark.sheet("DS-TMC428", "8.6")
@BOTH
@pytest.mark.parametrize(("writable", "dead"), [(None, False), ("hold-mode", False), ("velocity-mode", True)])
@pytest.mark.parametrize("before", [RAMP, VELOCITY])
def test_zero_written_in_velocity_mode_brakes_or_stops_dead_as_the_option_says(
    model: str, before: int, writable: str | None, dead: bool
) -> None:
    bench = free_bench(model, **({} if writable is None else {"v_actual_writable": writable}))
    assert bench.device.state().v_actual_writable == (writable or "hold-mode")
    bench.ramp(mode=before, v_max=1000, a_max=100)
    bench.write(X_TARGET if before == RAMP else V_TARGET, -500_000 if before == RAMP else -1000)
    bench.ticks(5000)
    assert bench.v == -1000
    at = bench.x
    hard_stop(bench)
    assert bench.v == (0 if dead else -1000)
    bench.ticks(5000)
    assert bench.v == 0
    assert (bench.x == at) is dead
    # it is no lock: the next target counts
    bench.write(V_TARGET, 500)
    bench.ticks(5000)
    assert bench.v == 500
    # nor does it make the register writable where the ramp generator positions
    bench.write(X_TARGET, bench.x)
    bench.write(MODE, RAMP | NO_STOPS)
    bench.write(V_ACTUAL, 0)
    assert bench.v != 0


@pytest.mark.sheet("DS-TMC428", "8.6")
@pytest.mark.sheet("DS-TMC4210", "6.1.6")
def test_zero_written_in_hold_mode_stops_at_once_hidden_bits_and_all() -> None:
    bench = moving(mode=VELOCITY, a_max=100)
    bench.write(V_TARGET, 1000)
    bench.ticks(2)  # 200/256: below one, and reads as zero
    assert bench.v == 0
    bench.write(MODE, HOLD | NO_STOPS)
    bench.write(V_ACTUAL, 0)
    bench.write(MODE, VELOCITY | NO_STOPS)
    bench.ticks(2)
    assert bench.v == 0  # 200/256 again: with the old hidden bits it would be 400/256
    bench.ticks(1)
    assert bench.v == 1


@pytest.mark.sheet("DS-TMC428", "8.6")
@pytest.mark.sheet("DS-TMC4210", "6.1.6")
@pytest.mark.parametrize("sign", [1, -1])
def test_a_velocity_below_one_reads_as_zero(sign: int) -> None:
    bench = moving(mode=VELOCITY, a_max=255)
    bench.write(V_TARGET, 100 * sign)
    bench.ticks(1)
    assert bench.v == 0
    bench.ticks(1)
    assert bench.v == sign


@pytest.mark.sheet("DS-TMC428", "8.7")
@pytest.mark.sheet("DS-TMC4210", "6.1.7")
@BOTH
def test_without_acceleration_the_motor_can_neither_start_nor_stop(model: str) -> None:
    bench = moving(model, mode=VELOCITY)
    bench.write(V_TARGET, 800)
    bench.ticks(1000)
    bench.write(A_MAX, 0)
    bench.write(V_TARGET, 0)
    bench.seconds(1.0)
    assert bench.v == 800


@pytest.mark.sheet("DS-TMC428", "8.7.1")
@pytest.mark.sheet("DS-TMC4210", "6.1.7.1.1")
@pytest.mark.parametrize("distance", [2**19 - 1, 2**19, 2**19 + 500_000, 8_000_000])
def test_the_ramp_generator_sees_no_further_than_2_to_the_19(distance: int) -> None:
    bench = moving(v_max=2047, p=5 << 8 | 13)  # p = 133 / 2^16
    bench.write(X_TARGET, distance)
    bench.ticks(1)
    seen = min(distance, 2**19 - 1)
    assert bench.read(V_TARGET) == min(2047, isqrt(2048 * 133 * seen >> 16))


@pytest.mark.sheet("DS-TMC428", "8.7.1")
@pytest.mark.sheet("DS-TMC4210", "6.1.7.1.1")
@pytest.mark.parametrize(
    ("share", "pmul_pdiv", "speed", "fits"), [(1, 12, 2047, True), (2, 13, 1448, True), (4, 13, 1448, False)]
)
def test_a_max_lower_limit(share: int, pmul_pdiv: int, speed: int, fits: bool) -> None:
    """At 2^(ramp_div - pulse_div - 1) full speed is possible, at half of that 2048 / sqrt(2), below nothing fits.

    p is exact for the first two; a quarter of the limit would need a smaller p than there is.
    """
    difference = 6
    a_max = 2 ** (difference - 1) // share
    bench = moving(a_max=a_max, p=pmul_pdiv, dividers=difference << 8 | 6)
    bench.write(X_TARGET, 1_600_000)
    bench.ticks(64)
    assert bench.read(V_TARGET) == speed
    furthest = 0
    for _ in range(500):
        bench.seconds(0.04)
        furthest = max(furthest, bench.x)
    assert (furthest <= 1_600_001) == fits


@pytest.mark.sheet("DS-TMC428", "8.8")
@pytest.mark.sheet("DS-TMC4210", "6.1.8")
@BOTH
def test_a_actual_is_the_smoothed_signed_acceleration(model: str) -> None:
    bench = moving(model, mode=VELOCITY, a_max=400)
    assert bench.read(A_ACTUAL) == 0
    bench.write(V_TARGET, 1500)
    readings = []
    for _ in range(5):
        bench.ticks(1)
        readings.append(bench.signed(A_ACTUAL, 12))
    assert readings == [100, 200, 300, 400, 400]  # mean of four ramp ticks: our choice of smoothing
    bench.ticks(2000)
    assert bench.read(A_ACTUAL) == 0
    bench.write(V_TARGET, -1500)
    bench.ticks(10)
    assert bench.signed(A_ACTUAL, 12) == -400


@pytest.mark.sheet("DS-TMC428", "8.10")
@pytest.mark.sheet("DS-TMC4210", "6.1.9")
@BOTH
@pytest.mark.parametrize("pmul", [0, 1, 127])
def test_the_msb_of_p_mul_is_fixed(model: str, pmul: int) -> None:
    bench = free_bench(model)
    bench.write(P, pmul << 8 | 7)
    assert bench.read(P) == (128 + pmul) << 8 | 7


@pytest.mark.sheet("DS-TMC428", "8.10")
@pytest.mark.sheet("DS-TMC4210", "6.1.9.1")
@pytest.mark.parametrize(("pmul", "pdiv"), [(0, 0), (0, 5), (60, 5), (127, 9), (127, 13)])
@pytest.mark.parametrize("distance", [1, 2, 77, 5000])
def test_wanted_velocity_follows_p_and_the_distance(pmul: int, pdiv: int, distance: int) -> None:
    """The law is a reading; floats here, integers there."""
    p = (128 + pmul) / 2 ** (3 + pdiv)
    for mode, wanted in ((RAMP, sqrt(2048 * p * distance)), (SOFT, p * distance)):
        bench = moving(mode=mode, a_max=0, p=pmul << 8 | pdiv)
        bench.write(X_TARGET, -distance)
        bench.ticks(1)
        assert bench.signed(V_TARGET, 12) == -min(2047, max(1, int(wanted)))


@pytest.mark.sheet("DS-TMC428", "8.11")
@pytest.mark.sheet("DS-TMC4210", "6.1.9.2")
def test_five_percent_less_than_exact_p_never_overshoots_and_exact_p_by_one_step_at_most() -> None:
    for a_max in (64, 256, 1000):
        for reduction, allowed in ((0.95, 0), (1.0, 1)):
            p = a_max / 128 * reduction
            pdiv = next(pdiv for pdiv in range(14) if p * 2 ** (3 + pdiv) >= 128)
            bench = moving(a_max=a_max, p=int(p * 2 ** (3 + pdiv)) - 128 << 8 | pdiv)
            bench.write(X_TARGET, 9000)
            furthest = 0
            for _ in range(30_000):
                bench.ticks(1)
                furthest = max(furthest, bench.x)
                if bench.v == 0 and bench.x >= 9000:
                    break
            assert 9000 <= furthest <= 9000 + allowed, (a_max, reduction)


@pytest.mark.sheet("DS-TMC428", "8.11")
@pytest.mark.sheet("DS-TMC4210", "6.1.9.1")
def test_a_far_too_large_p_swings_about_the_target_and_a_small_one_is_slow() -> None:
    def settled_after(p: int) -> float:
        bench = moving(a_max=64, p=p)
        bench.write(X_TARGET, 4000)
        for _ in range(4000):
            bench.ticks(100)
            if bench.x == 4000 and bench.v == 0:
                return bench.clock.now()
        return float("inf")

    fitting = settled_after(115 << 8 | 6)  # 0.95 * 64/128
    assert settled_after(115 << 8 | 10) > 1.5 * fitting
    assert settled_after(127 << 8 | 0) > 1.5 * fitting


@pytest.mark.sheet("DS-TMC428", "8.12")
@pytest.mark.sheet("DS-TMC428", "2.2")
@pytest.mark.sheet("DS-TMC4210", "1.5.2")
def test_soft_mode_approaches_more_gently_than_ramp_mode() -> None:
    def last_phase(mode: int) -> float:
        # In SOFT_MODE v falls with d itself: p such that both begin to brake from the same speed.
        bench = moving(mode=mode, a_max=1024, p=(115 << 8 | 2) if mode == RAMP else (0 << 8 | 8))
        bench.write(X_TARGET, 20_000)
        while bench.x < 19_900:
            bench.ticks(10)
        began = bench.clock.now()
        while bench.x != 20_000 or bench.v:
            bench.ticks(10)
        return bench.clock.now() - began

    assert last_phase(SOFT) > 2 * last_phase(RAMP)


@pytest.mark.sheet("DS-TMC428", "8.14")
@pytest.mark.sheet("DS-TMC428", "2.1")
@pytest.mark.sheet("DS-TMC4210", "6.1.12")
@BOTH
@pytest.mark.parametrize("pulse_div", [0, 3, 8, 13])
@pytest.mark.parametrize("velocity", [1, 777, 2047])
def test_pulse_rate(model: str, pulse_div: int, velocity: int) -> None:
    """R = f * v / (2^pulse_div * 2048 * 32): exactly `velocity` steps in 2048 pulse ticks."""
    bench = moving(model, mode=HOLD, dividers=pulse_div << 12 | 6)
    bench.write(V_ACTUAL, velocity)
    bench.ticks(2048 << pulse_div)
    assert bench.x == velocity


@pytest.mark.sheet("DS-TMC428", "8.14")
@pytest.mark.sheet("DS-TMC4210", "6.1.12")
@BOTH
@pytest.mark.parametrize("ramp_div", [0, 4, 9])
@pytest.mark.parametrize("a_max", [1, 100, 2047])
def test_acceleration_rate(model: str, ramp_div: int, a_max: int) -> None:
    """Velocity gains a_max / 256 with each ramp tick of 32 * 2^ramp_div clocks."""
    bench = moving(model, mode=VELOCITY, a_max=a_max, dividers=ramp_div << 8 | 6)
    bench.write(V_TARGET, 2047)
    bench.ticks(200 << ramp_div)
    assert bench.v == min(2047, 200 * a_max // 256)


@pytest.mark.sheet("DS-TMC428", "8.14")
def test_steps_during_acceleration() -> None:
    """S = v^2 / (2 a) * 2^(ramp_div - pulse_div) / 8."""
    bench = moving(mode=VELOCITY, a_max=50, dividers=3 << 12 | 4 << 8 | 6)
    bench.write(V_TARGET, 1600)
    bench.ticks((1600 * 256 // 50) << 4)
    assert bench.v == 1600
    assert bench.x == pytest.approx(1600**2 / 50 / 2 * 2 / 8, rel=0.002)


@pytest.mark.sheet("DS-TMC428", "8.14")
@pytest.mark.parametrize("mode", [RAMP, SOFT, VELOCITY, HOLD])
@pytest.mark.parametrize("odd", [False, True])
def test_changing_pulse_div_may_force_an_internal_microstep(mode: int, odd: bool) -> None:
    """Which position does so is not told: here the odd ones, and only outside RAMP_MODE and SOFT_MODE."""
    bench = moving(dividers=0x006)
    bench.write(X_TARGET, 101 if odd else 100)
    bench.seconds(0.1)
    bench.write(MODE, mode | NO_STOPS)
    bench.write(V_TARGET, 0)
    before, carriage = bench.x, bench.place()
    bench.write(DIVIDERS, 0x3006)
    bench.seconds(0.1)
    forced = odd and mode in (VELOCITY, HOLD)
    assert (bench.x, bench.place() - carriage) == (before, 1 / 64 if forced else 0)


@pytest.mark.sheet("DS-TMC4210", "6.1.11")
@pytest.mark.sheet("DS-TMC428", "8.6")
@pytest.mark.sheet("DS-TMC428", "8.13")
@pytest.mark.sheet("DS-TMC4210", "6.1.6")
@BOTH
def test_the_interrupt_register_tells_that_the_target_is_reached(model: str) -> None:
    bench = moving(model)
    bench.write(INTERRUPT, 0x0100)
    bench.write(X_TARGET, 500)
    bench.ticks(100)
    assert bench.read(INTERRUPT) == 0x0100
    assert bench.status & 0x81 == 0
    bench.seconds(0.1)
    assert bench.read(INTERRUPT) == 0x0101
    assert bench.status & 0x81 == 0x81


@pytest.mark.sheet("DS-TMC4210", "1.4.1")
def test_the_clock_may_run_at_32_mhz() -> None:
    bench = free_bench("tmc4210", clock_hz=32e6)
    bench.ramp(mode=HOLD, dividers=0)
    bench.write(V_ACTUAL, 2047)
    bench.seconds(0.1)
    assert bench.x == pytest.approx(32e6 / 32 * 2047 / 2048 * 0.1, abs=1)
