"""The motor against what can be said of it in closed form."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest

from app.emulators.drive import TICK_CLOCKS, Drive, EventKind, MotorOptions
from app.emulators.drive import kernel as k
from tests.emulators.drive.oracle import PlainMotor
from tests.emulators.drive.rig import (
    ONE_TURN_A_SECOND,
    RATED,
    SECOND,
    TICK_S,
    energised,
    load_value,
    static_angle_deg,
    until,
    wait,
    write,
)

FULL_SCALE_A = 4.2
PEAK_A = FULL_SCALE_A * (RATED + 1) / 32 * 247.5 / 248
"""At MSCNT 0 the cosine is 247 and a half of 248."""
IDEAL = MotorOptions(detent_torque_nm=0.0, friction_nm=0.0)


def speeds(drive: Drive, seconds: float) -> np.ndarray:
    """Rotor speed of every tick [rad/s]."""
    values = []
    for _ in range(round(seconds / TICK_S)):
        drive.advance(drive.clocks + TICK_CLOCKS)
        values.append(drive.plant_state.speed_rad_s)
    return np.array(values)


@pytest.mark.parametrize("detent_nm", [0.0, 0.02])
@pytest.mark.parametrize("load_inertia", [0.0, 58e-7])
def test_a_motor_let_go_rings_at_its_natural_frequency(detent_nm: float, load_inertia: float) -> None:
    motor = MotorOptions(detent_torque_nm=detent_nm, friction_nm=0.0, viscous_nms=1e-4)
    drive = energised(motor=motor, load={"inertia_kgm2": load_inertia})
    rest = drive.plant_state.field_fullsteps
    drive.plant.rotor_fullsteps = rest + 0.03  # 2.7 degrees electrical
    offsets = []
    for _ in range(round(0.05 / TICK_S)):
        drive.advance(drive.clocks + TICK_CLOCKS)
        offsets.append(drive.plant_state.rotor_fullsteps - rest)
    swing = np.array(offsets)
    rising = np.flatnonzero((swing[:-1] < 0) & (swing[1:] >= 0))
    exact = rising - swing[rising] / (swing[rising + 1] - swing[rising])
    measured_hz = (len(exact) - 1) / ((exact[-1] - exact[0]) * TICK_S)
    stiffness = 50 * (motor.torque_constant * PEAK_A + 4 * detent_nm)
    expected_hz = math.sqrt(stiffness / (58e-7 + load_inertia)) / 2 / math.pi
    assert measured_hz == pytest.approx(expected_hz, rel=0.01)


@pytest.mark.parametrize("load_nm", [-0.25, -0.1, 0.0, 0.05, 0.2, 0.3])
def test_the_static_load_angle_is_the_arc_sine_of_the_load(load_nm: float) -> None:
    drive = energised(motor=IDEAL)
    for part in range(1, 51):  # put on gently: all at once it would swing to twice the angle
        drive.plant.load_torque_nm = load_nm * part / 50
        wait(drive, 0.02)
    wait(drive, 1.0)
    expected = static_angle_deg(drive, load_nm, PEAK_A)
    assert drive.plant_state.load_angle_deg == pytest.approx(expected, abs=0.1)  # the table is 0.06 off at this place
    assert drive.plant_state.lost_fullsteps == 0
    assert drive.plant_state.torque_nm == pytest.approx(load_nm, abs=1e-6)


def test_friction_holds_the_rotor_within_its_dead_band() -> None:
    drive = energised(motor=MotorOptions(detent_torque_nm=0.0, friction_nm=0.03, stiction_ratio=1.0))
    width = static_angle_deg(drive, 0.03, PEAK_A) / 90
    here = drive.plant_state.field_fullsteps
    for offset, stays in ((0.9 * width, True), (-0.9 * width, True), (1.5 * width, False)):
        drive.plant.rotor_fullsteps = here + offset
        wait(drive, 0.2)
        assert (drive.plant_state.rotor_fullsteps == pytest.approx(here + offset, abs=1e-9)) is stays
        assert abs(drive.plant_state.rotor_fullsteps - here) <= width * 1.001


@pytest.mark.parametrize("load_nm", [0.31, -0.31])
def test_an_overload_slips_by_multiples_of_four_full_steps(load_nm: float) -> None:
    drive = energised(motor=MotorOptions(detent_torque_nm=0.0, viscous_nms=0.02))
    write(drive, {"VMAX": ONE_TURN_A_SECOND, "RAMPMODE": 1 if load_nm > 0 else 2})
    wait(drive, 0.5)
    assert drive.plant_state.lost_fullsteps == 0
    drive.plant.load_torque_nm = load_nm * 1.5
    wait(drive, 0.2)
    drive.plant.load_torque_nm = 0.0
    drive.write("VMAX", 0)
    until(drive, EventKind.STOPPED)
    wait(drive, 1.0)
    behind = drive.plant_state.field_fullsteps - drive.plant_state.rotor_fullsteps
    assert behind * load_nm > 0
    assert drive.plant_state.lost_fullsteps != 0
    assert behind == pytest.approx(drive.plant_state.lost_fullsteps, abs=0.05)
    assert drive.plant_state.lost_fullsteps % 4 == 0


def test_the_ripple_of_the_velocity_is_the_detent() -> None:
    ripple = {}
    for detent_nm in (0.0, 0.02, -0.02, None):
        drive = energised(motor=MotorOptions(detent_torque_nm=detent_nm or 0.0))
        if detent_nm is None:  # a sine that no table can hold
            drive._table[:] = np.sin((np.arange(k.TABLE) + 0.5) * math.pi / 512)
        write(drive, {"VMAX": ONE_TURN_A_SECOND // 2, "RAMPMODE": 1})
        wait(drive, 0.7)
        values = speeds(drive, 0.2)  # twenty full steps
        assert values.mean() == pytest.approx(math.pi, rel=2e-3)
        ripple[detent_nm] = values.std() / values.mean()
    assert ripple[None] < 0.003  # what whole microsteps leave
    assert ripple[0.0] < 0.015  # the default table is up to 0.22 degrees off, once a full step or faster
    assert ripple[0.02] > 10 * ripple[0.0]
    assert ripple[-0.02] > 10 * ripple[0.0]


def test_the_detent_bends_the_position_once_a_full_step() -> None:
    """Without load the rotor deviates by Td / (Kt I) sin(4e) / (1 + 4 Td / (Kt I) cos(4e)), to first order."""
    share = 0.02 / (MotorOptions().torque_constant * PEAK_A)
    drive = energised(motor=MotorOptions(detent_torque_nm=0.02, friction_nm=0.0))
    deviations = {}
    for microstep in range(0, 257, 32):
        drive.write("XTARGET", microstep)
        wait(drive, 0.4)
        deviations[microstep] = drive.plant_state.load_angle_deg
    for microstep, deviation in deviations.items():
        e = math.radians((microstep + 0.5) * 360 / 1024 - deviation)
        assert deviation == pytest.approx(math.degrees(share * math.sin(4 * e)), abs=0.3)  # the table adds 0.22
    assert max(deviations.values()) > 2.5
    assert min(deviations.values()) < -2.5


@pytest.mark.parametrize(
    ("what", "sine", "cosine", "order"),
    [
        ({"phase_unbalance": 0.05}, math.degrees(0.025), 0.0, 2),
        ({"quadrature_error_deg": 3.0}, 0.0, -1.5, 2),
        ({"fourth_harmonic_deg": 4.0}, 4.0, 0.0, 4),
        ({"detent_torque_nm": -0.02}, math.degrees(0.02 / (MotorOptions().torque_constant * PEAK_A)), 0.0, 4),
    ],
)
def test_an_uneven_motor_is_off_by_its_harmonic_of_the_electrical_angle(
    what: dict[str, float], sine: float, cosine: float, order: int
) -> None:
    """Rotor less field, over an electrical period."""
    motor = MotorOptions(**{"detent_torque_nm": 0.0, "friction_nm": 0.0, **what})
    drive = energised(motor=motor)
    drive._table[:] = np.sin((np.arange(k.TABLE) + 0.5) * math.pi / 512)
    error = []
    for microstep in range(0, 1024, 64):
        drive.write("XTARGET", microstep)
        wait(drive, 0.3)
        error.append(-drive.plant_state.load_angle_deg)
    angle = (np.arange(0, 1024, 64) + 0.5) * math.pi / 512
    parts = [2 * float(np.mean(error * shape(order * angle))) for shape in (np.sin, np.cos)]
    assert parts == pytest.approx([sine, cosine], abs=0.1)


def test_electrical_power_goes_into_heat_field_and_work() -> None:
    drive = energised()
    motor = drive.options.motor
    assert drive.options.steps_a_tick == 1  # so that every physics step is seen
    write(drive, {"VMAX": 2 * ONE_TURN_A_SECOND, "RAMPMODE": 1})
    drive.plant.load_torque_nm = 0.1
    electrical = copper = field = work = shaft = 0.0
    last = drive.plant_state
    kinetic_before = 0.5 * drive.options.inertia_kgm2 * last.speed_rad_s**2
    for _ in range(round(0.5 / TICK_S)):
        drive.advance(drive.clocks + TICK_CLOCKS)
        now = drive.plant_state
        for voltage, i0, i1 in (
            (now.voltage_a_v, last.current_a_a, now.current_a_a),
            (now.voltage_b_v, last.current_b_a, now.current_b_a),
        ):
            middle = (i0 + i1) / 2
            electrical += voltage * middle * TICK_S
            copper += motor.resistance_ohm * middle**2 * TICK_S
            field += motor.inductance_h * (i1**2 - i0**2) / 2
        work += now.torque_nm * (now.speed_rad_s + last.speed_rad_s) / 2 * TICK_S
        shaft += (0.1 * now.speed_rad_s + motor.viscous_nms * now.speed_rad_s**2) * TICK_S
        shaft += motor.friction_nm * abs(now.speed_rad_s) * TICK_S
        last = now
    assert electrical == pytest.approx(copper + field + work, rel=0.005)
    assert work > 0.2
    kinetic = 0.5 * drive.options.inertia_kgm2 * last.speed_rad_s**2 - kinetic_before
    assert work == pytest.approx(shaft + kinetic, rel=0.02)


def test_the_supply_limits_the_current_at_speed() -> None:
    currents, lags = [], []
    for turns in (2.5, 10, 15):
        drive = energised(load={"inertia_kgm2": 2e-6})
        write(drive, {"AMAX": 600, "VMAX": round(turns * ONE_TURN_A_SECOND), "RAMPMODE": 1})
        until(drive, EventKind.VELOCITY_REACHED)
        wait(drive, 0.3)
        assert drive.plant_state.lost_fullsteps == 0
        samples = []
        lags.append(drive.plant_state.load_angle_deg)
        for _ in range(500):
            drive.advance(drive.clocks + TICK_CLOCKS)
            samples.append(math.hypot(drive.plant_state.current_a_a, drive.plant_state.current_b_a))
        currents.append(sum(samples) / len(samples))
    assert currents[0] == pytest.approx(FULL_SCALE_A * 12 / 32, rel=0.01)
    # A simulation with another regulator, for 1.5 A: 1.27 A and 40 degrees at 2000 full steps/s, 0.68 A and 77 at 3000
    assert currents[1] == pytest.approx(1.27, rel=0.15)
    assert currents[2] == pytest.approx(0.68, rel=0.15)
    assert lags == pytest.approx([7, 40, 77], abs=12)


@pytest.mark.parametrize(("turns", "load_nm", "loses"), [(2, 0.15, False), (18, 0.15, True), (4, 0.6, True)])
def test_too_much_load_or_speed_pulls_the_motor_out_of_step(turns: float, load_nm: float, loses: bool) -> None:
    drive = energised()
    drive.plant.extra_friction_nm = load_nm
    write(drive, {"AMAX": 1500, "VMAX": round(turns * ONE_TURN_A_SECOND), "RAMPMODE": 1})
    until(drive, EventKind.VELOCITY_REACHED)
    wait(drive, 1.0)
    assert (drive.plant_state.lost_fullsteps > 0) is loses


def test_a_blocked_shaft_loses_every_step_and_the_load_value_falls_to_nothing() -> None:
    drive = energised()
    write(drive, {"VMAX": 2 * ONE_TURN_A_SECOND, "RAMPMODE": 1})
    wait(drive, 1.0)
    free = load_value(drive)
    here = drive.plant_state.rotor_fullsteps
    drive.plant.blocked = True
    wait(drive, 0.5)
    assert drive.plant_state.rotor_fullsteps == pytest.approx(here, abs=1e-9)
    assert free > 300
    assert load_value(drive) < 15
    assert drive.plant_state.lost_fullsteps == pytest.approx(200, abs=4)
    drive.plant.blocked = False
    drive.write("VMAX", 0)
    wait(drive, 1.0)
    assert drive.plant_state.speed_rad_s == 0.0


UNEVEN = MotorOptions(phase_unbalance=0.05, quadrature_error_deg=-3.0, fourth_harmonic_deg=4.0)


@pytest.mark.parametrize("motor", [MotorOptions(), UNEVEN], ids=["even", "uneven"])
def test_the_kernel_equals_the_plain_motor_and_resting_changes_nothing(motor: MotorOptions) -> None:
    """Standing, moving and standing again under a load: the oracle works out every tick, the kernel skips rests."""
    drive = energised(motor=motor)
    drive.plant.load_torque_nm = 0.03
    plain = PlainMotor(drive.options, load_nm=0.03)
    plain.theta, plain.omega = drive.plant_state.rotor_rad, drive.plant_state.speed_rad_s
    plain.currents = [drive.plant_state.current_a_a, drive.plant_state.current_b_a]
    scale = FULL_SCALE_A * (RATED + 1) / 32
    for target in (0, 700, -300):
        drive.write("XTARGET", target)
        for _ in range(14_000):
            drive.advance(drive.clocks + TICK_CLOCKS)
            at = drive.read("MSCNT")
            sine, cosine = (drive._wave[(at + shift) % 1024] + 0.5 for shift in (0, 256))
            plain.tick((scale * sine / 248, scale * cosine / 248))
        truth = drive.plant_state
        assert truth.rotor_rad == pytest.approx(plain.theta, abs=1e-9)
        assert (truth.speed_rad_s, plain.omega) == (0.0, 0.0)
        assert [truth.current_a_a, truth.current_b_a] == pytest.approx(plain.currents, abs=1e-9)


@pytest.mark.parametrize("turns_per_s", [0.01, 2, 8, 25])
def test_sine_and_cosine_that_are_carried_on_stay_those_of_the_rotor(turns_per_s: float) -> None:
    """Also where the rotor is put elsewhere by hand, and where it turns too far in a tick to carry anything on."""
    drive = energised()
    f = drive._f
    for look in range(200):
        f[k.OMEGA] = 2 * math.pi * turns_per_s
        if look % 50 == 25:
            drive.plant.rotor_fullsteps += 0.05
        drive.write("XTARGET", look)  # what rests is not worked out
        drive.advance(drive.clocks + 37 * TICK_CLOCKS)
        assert f[k.SINE] == pytest.approx(math.sin(f[k.ANGLE]), abs=1e-12)
        assert f[k.COSINE] == pytest.approx(math.cos(f[k.ANGLE]), abs=1e-12)
        last_step = f[k.TEETH] * f[k.OMEGA] * f[k.DT]
        assert f[k.ANGLE] == pytest.approx(f[k.TEETH] * f[k.THETA] - last_step, abs=1e-9)


def test_a_motor_that_stands_costs_nothing() -> None:
    drive = energised()
    wait(drive, 10.0)
    before = drive.plant_state
    drive.advance(drive.clocks + 10_000_000 * SECOND)  # would take hours, were it worked out
    assert drive.plant_state == before
    drive.write("XTARGET", 51_200)
    assert until(drive, EventKind.POSITION_REACHED).position == 51_200
    wait(drive, 0.1)
    assert drive.internal.position == pytest.approx(51_200, abs=110)


@pytest.mark.parametrize(("coil", "told"), [("a", 1), ("b", 2)])
def test_a_coil_that_is_open_makes_no_torque_and_is_told(coil: Literal["a", "b"], told: int) -> None:
    drive = energised(motor=MotorOptions(open_phase=coil))
    assert (drive.read("DRV_STATUS") >> 29) & 3 == told
    write(drive, {"XTARGET": 256 * 400})
    wait(drive, 4.0)
    assert drive.read("XACTUAL") == 256 * 400
    assert abs(drive.plant_state.rotor_fullsteps - 400) > 4
