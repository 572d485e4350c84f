"""A TMC26x on the shared drive: datagrams in, answers out, and what its settings do to the motor."""

from __future__ import annotations

import math

import pytest

from app.emulators.drive import DriveOptions
from app.emulators.drive.tmc26x import CHOPCONF, DRVCONF, DRVCTRL, SGCSCONF, SMARTEN, Tmc26x, currents_of, register_of

CLOCK_HZ = 16e6
TICK = 256
CHOPPER = CHOPCONF << 17 | 2 << 15 | 3 << 7 | 4 << 4 | 5
SG, OT, OTPW, S2GA, S2GB, OLA, OLB, STST = (1 << n for n in range(8))


def made(*, currents: bool = False, cs: int = 15, sgt: int = 0, rdsel: int = 1, **options: object) -> Tmc26x:
    """With its bridges on; by default it follows STEP in sixteenths of a full step."""
    driver = Tmc26x(DriveOptions(clock_hz=CLOCK_HZ, full_scale_a=3.1, **options))
    driver.write(DRVCONF << 17 | currents << 7 | rdsel << 4)
    driver.write(SGCSCONF << 17 | (sgt & 0x7F) << 8 | cs)
    driver.write(SMARTEN << 17)
    driver.write(CHOPPER)
    if not currents:
        driver.write(4)
    return driver


def run(driver: Tmc26x, seconds: float, from_s: float = 0.0) -> float:
    driver.advance(round((from_s + seconds) * CLOCK_HZ))
    return from_s + seconds


def wave(driver: Tmc26x, fullsteps: float, seconds: float, from_s: float = 0.0) -> float:
    """Coil currents of a field that turns at constant speed, one datagram every sixteenth of a full step."""
    count = round(abs(fullsteps) * 16)
    way = 1 if fullsteps > 0 else -1
    for n in range(count + 1):
        driver.advance(round((from_s + seconds * n / count) * CLOCK_HZ))
        angle = way * n / 16 * math.pi / 2 + 0.5 * math.pi / 512
        a, b = round(248 * math.sin(angle)), round(248 * math.cos(angle))
        driver.write((a < 0) << 17 | abs(a) << 9 | (b < 0) << 8 | abs(b))
    return from_s + seconds


def peak_a(driver: Tmc26x) -> float:
    state = driver.drive.plant_state
    return math.hypot(state.current_a_a, state.current_b_a)


def test_the_upper_bits_say_the_register() -> None:
    assert [register_of(tag << 17) for tag in range(8)] == [DRVCTRL] * 4 + [CHOPCONF, SMARTEN, SGCSCONF, DRVCONF]
    assert currents_of(1 << 17 | 248 << 9 | 7) == (-248, 7)
    assert currents_of(1 << 8 | 100) == (0, -100)


def test_it_is_off_until_toff_is_written() -> None:
    driver = Tmc26x(DriveOptions(clock_hz=CLOCK_HZ, full_scale_a=3.1))
    driver.write(SGCSCONF << 17 | 31)
    at = run(driver, 0.01)
    assert peak_a(driver) == 0
    driver.write(CHOPPER)
    run(driver, 0.01, at)
    assert peak_a(driver) == pytest.approx(3.1, rel=0.01)


@pytest.mark.parametrize(("cs", "vsense"), [(31, 0), (15, 0), (31, 1), (0, 1)])
def test_current_scale_and_vsense_set_the_current(cs: int, vsense: int) -> None:
    driver = made(cs=cs)
    driver.write(DRVCONF << 17 | vsense << 6)
    run(driver, 0.02)
    assert peak_a(driver) == pytest.approx(3.1 * (cs + 1) / 32 * (0.165 / 0.310 if vsense else 1), rel=0.01)


def test_an_answer_shows_what_rdsel_selected_before_the_datagram() -> None:
    driver = made(rdsel=0)
    driver.step(24)
    run(driver, 0.01)
    assert driver.exchange(DRVCONF << 17 | 2 << 4) >> 10 == 24 * 16 + 8
    answer = driver.exchange(DRVCONF << 17 | 1 << 4)
    assert answer >> 10 & 0x1F == 15
    assert answer & 0xFF == driver.flags


@pytest.mark.parametrize("way", [1, -1])
def test_counted_steps_turn_the_motor(way: int) -> None:
    driver = made()
    for n in range(1600):
        driver.step(way)
        driver.advance((n + 1) * 8000)  # 2,000 steps a second
    assert not driver.flags & STST
    assert driver.drive.plant_state.rotor_fullsteps == pytest.approx(way * 100, abs=0.6)
    assert abs(driver.drive.read("VACTUAL")) == pytest.approx(2000 * 2**24 / CLOCK_HZ, rel=0.02)
    driver.advance(1600 * 8000 + (1 << 20) + 2 * TICK)
    assert driver.flags == STST


@pytest.mark.parametrize("way", [1, -1])
def test_told_currents_turn_the_motor(way: int) -> None:
    driver = made(currents=True)
    wave(driver, way * 100, 0.5)
    state = driver.drive.plant_state
    assert state.rotor_fullsteps == pytest.approx(way * 100, abs=0.6)
    assert state.lost_fullsteps == 0
    assert driver.flags & (SG | STST) == STST, "no step comes at STEP"


def test_half_the_told_current_is_half_the_current() -> None:
    driver = made(currents=True, cs=31)
    driver.write(124)
    run(driver, 0.02)
    assert peak_a(driver) == pytest.approx(1.55, rel=0.01)


@pytest.mark.parametrize("currents", [True, False])
def test_a_held_shaft_stalls_and_a_free_one_does_not(currents: bool) -> None:
    def flag(*, held: bool) -> int:
        driver = made(currents=currents)
        driver.drive.plant.blocked = held
        if currents:
            wave(driver, 60, 0.15)
        else:
            driver.step_hz = 6400.0
            run(driver, 0.15)
        return driver.answer & SG

    assert (flag(held=True), flag(held=False)) == (SG, 0)


def test_cool_step_lowers_the_current_of_an_unloaded_motor() -> None:
    driver = made(cs=31, rdsel=2)
    driver.write(SMARTEN << 17 | 3 << 13 | 1)
    driver.step_hz = 6400.0
    run(driver, 0.5)
    assert driver.answer >> 10 & 0x1F == 15, "half of CS without SEIMIN"


@pytest.mark.parametrize("currents", [True, False])
def test_faults_show_as_flags(currents: bool) -> None:
    driver = made(currents=currents)
    plant = driver.drive.plant
    at = run(driver, 0.07)
    at = run(driver, 0.001, at)
    calm = driver.flags
    assert calm & ~STST == 0
    plant.temperature_c = 101.0
    assert driver.flags & (OT | OTPW) == OTPW
    plant.temperature_c = 151.0
    at = run(driver, 0.01, at)
    assert (driver.flags & (OT | OTPW), peak_a(driver)) == (OT | OTPW, 0)
    plant.temperature_c = 40.0
    plant.motor_connected = False
    assert driver.flags & (OLA | OLB) == OLA | OLB
    plant.motor_connected = True
    plant.short_to_ground = "b"
    at = run(driver, 0.01, at)
    assert driver.flags & (S2GA | S2GB) == S2GB
    plant.short_to_ground = "none"
    assert driver.flags & S2GB, "kept until the driver was off"
    driver.write(CHOPPER & ~0xF)
    driver.write(CHOPPER)
    assert not driver.flags & S2GB


def test_time_in_pieces_makes_no_difference() -> None:
    def end(piece: int) -> tuple[float, int]:
        driver = made(currents=True)
        for n in range(200):
            for clock in range(n * 4000 + piece, (n + 1) * 4000 + 1, piece):
                driver.advance(clock)
            angle = n / 8 * math.pi / 2
            a, b = round(248 * math.sin(angle)), round(248 * math.cos(angle))
            driver.write((a < 0) << 17 | abs(a) << 9 | (b < 0) << 8 | abs(b))
        driver.advance(800_000)
        return driver.drive.plant_state.rotor_rad, driver.answer

    assert end(4000) == end(1000)


def test_a_motor_at_rest_costs_nothing_and_wakes_up() -> None:
    driver = made(currents=True)
    at = wave(driver, 2, 0.05)
    at = run(driver, 0.5, at)
    assert driver.quiet
    wave(driver, 1, 0.05, at)
    assert not driver.quiet


def test_a_rigid_motor_follows_too() -> None:
    driver = made(currents=True, rigid=True)
    wave(driver, 40, 0.1)
    assert driver.drive.plant_state.rotor_fullsteps == pytest.approx(40, abs=0.1)
    at = 0.1
    steps = made(rigid=True)
    steps.step(320)
    run(steps, 0.01)
    assert steps.drive.plant_state.rotor_fullsteps == pytest.approx(20, abs=0.1)
    steps.step_hz = 1600.0
    run(steps, at, 0.01)
    assert steps.drive.plant_state.rotor_fullsteps == pytest.approx(30, abs=0.3)


def test_switching_off_forgets_registers_and_keeps_the_shaft() -> None:
    driver = made(currents=True)
    wave(driver, 10, 0.05)
    before = driver.drive.plant_state.rotor_fullsteps
    driver.reset()
    assert driver.words == dict.fromkeys((DRVCTRL, CHOPCONF, SMARTEN, SGCSCONF, DRVCONF), 0)
    assert not driver.takes_currents
    assert driver.drive.plant_state.rotor_fullsteps == before
