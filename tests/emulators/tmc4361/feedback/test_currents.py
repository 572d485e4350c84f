"""Sequencer, current scale and PWM against NOTES-TMC4361-IO 9 and NOTES-MSLUT."""

from __future__ import annotations

import math

import pytest

from app.emulators.drive import MotorOptions
from app.emulators.tmc4361.feedback import layout as c
from app.emulators.tmc4361.layout import FB_FS_ACTIVE, FB_QUIET
from tests.emulators.tmc4361.feedback.rig import (
    BOOST_TIME,
    CURRENT_CONF,
    CURRENTS,
    CURRENTS_SPI,
    DRV_SCALE_DELAY,
    FREEWHEEL_DELAY,
    FREEZE,
    GENERAL_CONF,
    HOLD_SCALE_DELAY,
    MSCNT,
    PWM_FREQ,
    PWM_VMAX,
    SCALE_PARAM,
    SCALE_VALUES,
    SPI_OUT_CONF,
    STDBY_DELAY,
    STEP_CONF,
    UP_SCALE_DELAY,
    VDRV_SCALE_LIMIT,
    Bench,
    signed,
)

HOLD, DRIVE, BOOST_ACC, BOOST_DEC, BOOST_START, DRIVE2, FREEWHEEL = (1 << n for n in range(7))
PWM_SCALE = 1 << 8
VALUES = 50 | 100 << 8 | 150 << 16 | 25 << 24
"""Boost 50, drive 100, second drive 150, hold 25: all unlike, and boost below drive."""
FS_EN, PWM_OUT, REVERSE = 1 << 19, 1 << 23, 1 << 28
RESET_CONF = 0x6020
FS_VEL = 0x60
IDEAL = MotorOptions(detent_torque_nm=0.0, friction_nm=0.0)


def at(mscnt: int) -> Bench:
    """A bench with its sequencer at a place."""
    bench = Bench()
    for _ in range(mscnt // 64):
        bench.state[1] += 64
        bench.ticks(1)
    bench.state[1] += mscnt % 64
    bench.ticks(1)
    return bench


def both(word: int | None) -> tuple[int, int]:
    assert word is not None
    return signed(word, 9), signed(word >> 16, 9)


@pytest.mark.sheet("DS-TMC4361", "11.1")
@pytest.mark.parametrize(
    ("mscnt", "a", "b"),
    [(0, 0, 247), (8, 12, 247), (30, 45, 243), (68, 100, 225), (584, -107, -224), (648, -184, -166)],
)
def test_currents_are_those_of_the_wave_as_dumps_of_real_chips_show_them(mscnt: int, a: int, b: int) -> None:
    bench = at(mscnt)
    assert bench.unit.read(MSCNT) == mscnt
    assert both(bench.unit.read(CURRENTS)) == (a, b)


@pytest.mark.sheet("DS-TMC4361", "17.22")
def test_another_wave_takes_over_at_once() -> None:
    bench = at(68)
    for word in range(8):
        bench.write({0x70 + word: 0xFFFFFFFF})
    bench.write({0x78: 0xFFFFFF55, 0x7E: 0xF7 << 16})  # every step is +1
    bench.ticks(1)
    assert both(bench.unit.read(CURRENTS)) == (68, 255 - 68)


@pytest.mark.sheet("DS-TMC4361", "17.11")
def test_a_coarser_microstep_moves_the_sequencer_further() -> None:
    """The kernel hands over 1/256 full steps, so MSTEP_PER_FS is in them; a turn stays a turn of ENC_CONST."""
    bench = Bench({STEP_CONF: 4 | 200 << 4})
    assert bench.unit.read(0x54) == round(16 * 200 * 65536 / 40_000)
    assert bench.unit.fb[c.TURN] == 3200


def test_reverse_motor_dir_turns_the_table_around() -> None:
    bench = Bench({GENERAL_CONF: RESET_CONF | REVERSE})
    bench.run(0.2)
    bench.state[1] += 300
    bench.run(0.3)
    assert bench.unit.read(MSCNT) == 1024 - 300
    assert bench.rotor == pytest.approx(-300, abs=6)


@pytest.mark.sheet("DS-TMC4361", "11.6")
@pytest.mark.parametrize("scale", [0, 31, 100, 255])
def test_the_scale_multiplies_by_its_value_plus_one(scale: int) -> None:
    bench = at(68)
    bench.write({CURRENT_CONF: DRIVE, SCALE_VALUES: scale << 8})
    bench.ticks(1)
    assert bench.unit.read(SCALE_PARAM) == scale
    assert both(bench.unit.read(CURRENTS_SPI)) == (100 * (scale + 1) // 256, 225 * (scale + 1) // 256)
    assert both(bench.unit.read(CURRENTS)) == (100, 225)


@pytest.mark.sheet("DS-TMC4361", "17.22")
def test_the_dac_offset_only_shifts_what_an_spi_dac_gets() -> None:
    bench = at(68)
    bench.write({0x7E: 0x00F70000 | (-20 & 0xFF) << 24, SPI_OUT_CONF: 0xA})
    bench.ticks(1)
    assert both(bench.unit.read(CURRENTS_SPI)) == (100, 225)
    bench.write({SPI_OUT_CONF: 2})
    bench.ticks(1)
    assert both(bench.unit.read(CURRENTS_SPI)) == (80, 205)


@pytest.mark.parametrize("scale", [60, 255])
def test_the_driver_regulates_the_coils_to_the_scaled_currents(scale: int) -> None:
    bench = at(68)
    bench.write({CURRENT_CONF: DRIVE, SCALE_VALUES: scale << 8})
    bench.run(0.2)
    truth = bench.unit.plant_state
    a, b = both(bench.unit.read(CURRENTS_SPI))
    assert truth.current_a_a == pytest.approx(2.1 * (a + 0.5) / 248, rel=1e-6)
    assert truth.current_b_a == pytest.approx(2.1 * (b + 0.5) / 248, rel=1e-6)


def test_a_supply_that_sags_and_a_load_behind_a_spring_are_there_after_a_reset_too() -> None:
    load = {"inertia_kgm2": 2e-5, "torque_nm": 0.1, "coupling": {"stiffness_nm_rad": 3.0, "damping_nms": 2e-3}}
    bench = Bench({CURRENT_CONF: DRIVE, SCALE_VALUES: 255 << 8}, load=load, supply_resistance_ohm=8.0)
    for reset in (False, True):
        if reset:
            bench.unit.reset()
            bench.write({CURRENT_CONF: DRIVE, SCALE_VALUES: 255 << 8})
        bench.run(0.5)
        truth = bench.unit.plant_state
        assert truth.rotor_fullsteps - truth.load_fullsteps == pytest.approx(0.1 / 3.0 * 100 / math.pi, rel=0.02)
        assert 12.0 < truth.supply_v < 23.0


def scale_while(bench: Bench, ramp_state: int, velocity: float = 1000.0) -> int:
    bench.ticks(1, velocity if ramp_state & 4 else 0.0, ramp_state)
    return int(bench.unit.read(SCALE_PARAM) or 0)


@pytest.mark.sheet("DS-TMC4361", "11.6")
@pytest.mark.parametrize(
    ("conf", "constant", "rising", "falling", "fast"),
    [
        (0, 255, 255, 255, 255),
        (DRIVE, 100, 100, 100, 100),
        (DRIVE | BOOST_ACC, 100, 50, 100, 100),
        (DRIVE | BOOST_DEC, 100, 100, 50, 100),
        (DRIVE | DRIVE2, 100, 100, 100, 150),
        (DRIVE | DRIVE2 | BOOST_ACC | BOOST_DEC, 100, 50, 50, 150),
    ],
)
def test_the_scale_goes_with_what_the_ramp_does(conf: int, constant: int, rising: int, falling: int, fast: int) -> None:
    bench = Bench({CURRENT_CONF: conf, SCALE_VALUES: VALUES, VDRV_SCALE_LIMIT: 5000})
    assert scale_while(bench, 4) == constant
    assert scale_while(bench, 5) == rising
    assert scale_while(bench, 6) == falling
    assert scale_while(bench, 4, 5001.0) == fast
    assert scale_while(bench, 4, -5001.0) == fast


@pytest.mark.sheet("DS-TMC4361", "17.6")
def test_after_a_start_the_boost_lasts_for_its_time() -> None:
    bench = Bench({CURRENT_CONF: DRIVE | BOOST_START, SCALE_VALUES: VALUES, BOOST_TIME: 12_800})
    bench.ticks(10)
    scales = [scale_while(bench, 4) for _ in range(120)]
    assert scales == [50] * 100 + [100] * 20


@pytest.mark.sheet("DS-TMC4361", "17.15")
def test_the_hold_current_comes_after_the_standby_delay_step_by_step() -> None:
    bench = Bench(
        {
            CURRENT_CONF: DRIVE | HOLD,
            SCALE_VALUES: VALUES,
            STDBY_DELAY: 12_800,
            HOLD_SCALE_DELAY: 256,
            UP_SCALE_DELAY: 128,
        }
    )
    bench.ticks(1, 1000.0)
    scales = [scale_while(bench, 0) for _ in range(100 + 160)]
    assert scales[:100] == [100] * 100
    assert scales[100:250] == [100 - (tick + 1) // 2 for tick in range(150)]
    assert scales[250:] == [25] * 10
    scales = [scale_while(bench, 4) for _ in range(80)]
    assert scales == [min(25 + tick, 100) for tick in range(1, 81)]


@pytest.mark.sheet("DS-TMC4361", "17.15")
def test_going_down_to_the_drive_current_takes_its_own_delay() -> None:
    bench = Bench({CURRENT_CONF: DRIVE | DRIVE2, SCALE_VALUES: VALUES, VDRV_SCALE_LIMIT: 10, DRV_SCALE_DELAY: 512})
    assert scale_while(bench, 4) == 255 - 0  # at first everything flows
    for _ in range(4 * 105 - 1):
        scale_while(bench, 4)
    assert scale_while(bench, 4) == 150
    scales = [scale_while(bench, 4, 5.0) for _ in range(8)]
    assert scales == [150, 150, 150, 149, 149, 149, 149, 148]


@pytest.mark.sheet("DS-TMC4361", "17.6")
def test_freewheeling_lets_the_shaft_go() -> None:
    bench = Bench(
        {CURRENT_CONF: HOLD | FREEWHEEL, STDBY_DELAY: 1600, FREEWHEEL_DELAY: 16_000},
        motor=MotorOptions(detent_torque_nm=0.0),
    )
    bench.change(load_torque_nm=0.05)
    bench.run(0.9e-3)
    assert bench.unit.plant_state.bridges == "regulated"
    bench.run(0.5)
    truth = bench.unit.plant_state
    assert truth.bridges == "open"
    assert truth.current_a_a == truth.current_b_a == 0.0
    assert truth.speed_rad_s < -1.0


def test_ticks_may_be_passed_over_only_when_every_delay_is_over() -> None:
    delays = {STDBY_DELAY: 1_600_000, FREEWHEEL_DELAY: 1_600_000, 0x62: 1000}
    bench = Bench({CURRENT_CONF: HOLD | FREEWHEEL, SCALE_VALUES: VALUES} | delays)
    for _ in range(20):
        assert not bench.run(0.0099) & FB_QUIET
        assert bench.unit.plant_state.bridges == "regulated"
    bench.run(0.4)
    assert bench.word & FB_QUIET
    assert bench.word >> 31  # the driver's standstill flag
    assert bench.unit.plant_state.bridges == "open"


@pytest.mark.sheet("DS-TMC4361", "12.1")
@pytest.mark.parametrize(("ifreeze", "scale"), [(0, 100), (30, 30)])
def test_frozen_the_scale_is_ifreeze_or_what_it_was(ifreeze: int, scale: int) -> None:
    bench = Bench({CURRENT_CONF: DRIVE | HOLD, SCALE_VALUES: VALUES, FREEZE: ifreeze << 24})
    scale_while(bench, 4)
    assert [scale_while(bench, 8) for _ in range(5)] == [scale] * 5


@pytest.mark.sheet("DS-TMC4361", "17.20")
def test_above_fs_vel_the_wave_becomes_full_steps() -> None:
    bench = Bench({GENERAL_CONF: RESET_CONF | FS_EN, FS_VEL: 100_000})
    assert not bench.run(0.01, 99_000) & FB_FS_ACTIVE
    seen = set()
    for _ in range(200):
        assert bench.ticks(8, 101_000) & FB_FS_ACTIVE
        seen.add(both(bench.unit.read(CURRENTS)))
    assert seen == {(175, 174), (174, -176), (-176, -175), (-175, 175)}


@pytest.mark.sheet("DS-TMC4361", "1.3.4")
@pytest.mark.parametrize(("word", "frequency_hz"), [(0x280, 25_000.0), (800, 20_000.0)])
def test_the_pwm_frequency_is_the_clocks_over_pwm_freq(word: int, frequency_hz: float) -> None:
    bench = Bench({GENERAL_CONF: RESET_CONF | PWM_OUT, PWM_FREQ: word})
    pwm = bench.unit.describe().pwm
    assert pwm is not None
    assert pwm.frequency_hz == frequency_hz
    bench.write({GENERAL_CONF: RESET_CONF})
    assert bench.unit.describe().pwm is None


@pytest.mark.sheet("DS-TMC4361", "13.1")
@pytest.mark.parametrize(
    ("velocity", "amplitude"), [(0.0, 8192 / 2**17), (25_000.0, (8192 / 2**17 + 0.5) / 2), (50_000.0, 0.5), (9e4, 0.5)]
)
def test_the_duty_grows_from_pwm_ampl_to_full_at_pwm_vmax(velocity: float, amplitude: float) -> None:
    bench = Bench(
        {GENERAL_CONF: RESET_CONF | PWM_OUT, CURRENT_CONF: PWM_SCALE | 8191 << 16, PWM_VMAX: 50_000, PWM_FREQ: 65_535}
    )
    bench.change(blocked=True)
    reached = 0.0
    for _ in range(4000):
        bench.ticks(1, velocity)
        fb = bench.unit.fb
        reached = max(reached, abs(float(fb[c.DUTY_A]) - 0.5), abs(float(fb[c.DUTY_B]) - 0.5))
    assert reached == pytest.approx(amplitude, rel=0.003)


def test_the_duty_has_the_steps_of_a_pwm_period() -> None:
    bench = Bench({GENERAL_CONF: RESET_CONF | PWM_OUT, PWM_FREQ: 10})
    bench.change(blocked=True)
    duties = set()
    for _ in range(300):
        bench.ticks(8, 60_000.0)
        duties.add(round(float(bench.unit.fb[c.DUTY_A]), 9))
    assert duties == {tenth / 10 for tenth in range(11)}


def test_pwm_turns_the_motor() -> None:
    # 1/16 of 24 V at rest: 3 V * 247.5 / 248 over 2.3 ohm
    bench = Bench(
        {GENERAL_CONF: RESET_CONF | PWM_OUT, CURRENT_CONF: PWM_SCALE | 8191 << 16, PWM_VMAX: 300_000}, motor=IDEAL
    )
    bench.run(0.5)
    truth = bench.unit.plant_state
    assert truth.bridges == "voltage"
    assert truth.current_b_a == pytest.approx(24 * 2 * 8192 / 2**17 / 2.3, rel=0.01)
    start = bench.rotor
    bench.move(20_000, 0.1, 0.3)
    bench.run(0.3)
    assert bench.rotor - start == pytest.approx(20_000 * 0.4, abs=8)


def test_reset_begins_at_mscnt_0_in_the_turn_that_the_rotor_is_in() -> None:
    bench = at(700)
    bench.run(0.2)
    bench.unit.reset()
    assert bench.unit.read(MSCNT) == 0
    assert bench.unit.read(CURRENTS) is not None
    bench.ticks(1)
    assert both(bench.unit.read(CURRENTS)) == (0, 247)
    assert abs(bench.unit.plant_state.field_fullsteps * 256 - bench.rotor) < 520
