"""StealthChop: a voltage at the coils, what the current makes of it, and what the chip finds by itself."""

from __future__ import annotations

import math

import pytest

from app.emulators.drive import TICK_CLOCKS, Drive, MotorOptions
from app.emulators.drive import kernel as k
from app.emulators.drive.options import DriveOptions
from tests.emulators.drive.oracle import PlainMotor
from tests.emulators.drive.rig import (
    CHOPPER_ON,
    ONE_TURN_A_SECOND,
    RATED,
    SECOND,
    TRAPEZOID,
    wait,
    write,
)
from tests.emulators.drive.test_motor import speeds

MOTOR = MotorOptions(detent_torque_nm=0.0, friction_nm=0.0, viscous_nms=1e-4)
FULL_SCALE_A = 4.2
CURRENT_A = FULL_SCALE_A * (RATED + 1) / 32
SUPPLY_V = 24.0
AUTOSCALE, AUTOGRAD = 1 << 18, 1 << 19


def pwmconf(ofs: int = 30, grad: int = 0, more: int = AUTOSCALE | AUTOGRAD, reg: int = 4, lim: int = 12) -> int:
    return ofs | grad << 8 | more | reg << 24 | lim << 28


def quiet_drive(
    conf: int, motor: MotorOptions = MOTOR, supply_v: float = SUPPLY_V, hold: int = RATED, kind: int = k.TUNED
) -> Drive:
    """A drive in StealthChop that was just switched on."""
    drive = Drive(DriveOptions(motor=motor, supply_v=supply_v))
    drive.stealth_chop = kind
    write(drive, TRAPEZOID | {"PWMCONF": conf, "GCONF": 4, "CHOPCONF": CHOPPER_ON})
    drive.write("IHOLD_IRUN", hold | RATED << 8 | 1 << 16)
    return drive


def turned(drive: Drive, turns: float, seconds: float = 1.0) -> Drive:
    write(drive, {"VMAX": round(turns * ONE_TURN_A_SECOND), "RAMPMODE": 1})
    wait(drive, seconds)
    return drive


def current(drive: Drive) -> float:
    return math.hypot(drive.plant_state.current_a_a, drive.plant_state.current_b_a)


def volts(amplitude: float, supply_v: float = SUPPLY_V) -> float:
    """Peak voltage of an amplitude: 374 R I_rms / V is the amplitude of a current (DS-TMC5160 7.4)."""
    return amplitude * supply_v * math.sqrt(2) / 374


def unloaded_current(peak_v: float, turns: float, motor: MotorOptions = MOTOR) -> float:
    """Of a motor without load: its current makes no torque, so it is a quarter of a turn off the back-EMF.

    U^2 = (R I)^2 + ((Kt + N L I) w)^2.
    """
    w = 2 * math.pi * turns
    r, x, emf = motor.resistance_ohm, motor.rotor_teeth * motor.inductance_h * w, motor.torque_constant * w
    a, half_b, c = r * r + x * x, x * emf, emf * emf - peak_v * peak_v
    return (math.sqrt(half_b * half_b - a * c) - half_b) / a


def needed_amplitude(turns: float, motor: MotorOptions = MOTOR, supply_v: float = SUPPLY_V) -> float:
    """The amplitude for the run current of a motor without load."""
    w = 2 * math.pi * turns
    across = (motor.torque_constant + motor.rotor_teeth * motor.inductance_h * CURRENT_A) * w
    return math.hypot(motor.resistance_ohm * CURRENT_A, across) * 374 / math.sqrt(2) / supply_v


def amplitude(drive: Drive) -> int:
    return drive.read("PWM_SCALE") & 0xFF


def regulation(drive: Drive) -> int:
    part = drive.read("PWM_SCALE") >> 16 & 0x1FF
    return part - 512 if part > 255 else part


def tuned(drive: Drive) -> tuple[int, int]:
    """PWM_OFS_AUTO, PWM_GRAD_AUTO."""
    word = drive.read("PWM_AUTO")
    return word & 0xFF, word >> 16


@pytest.mark.parametrize("ofs", [0, 30, 107, 200])
@pytest.mark.parametrize("hold", [3, RATED])
@pytest.mark.parametrize("supply_v", [12.0, 24.0])
def test_a_standing_motors_current_is_voltage_over_resistance(ofs: int, hold: int, supply_v: float) -> None:
    drive = quiet_drive(pwmconf(ofs, more=0), supply_v=supply_v, hold=hold)
    wait(drive, 1.0)
    expected = volts(ofs * (hold + 1) / 32, supply_v) / MOTOR.resistance_ohm
    assert current(drive) == pytest.approx(expected, rel=0.003, abs=1e-9)
    assert amplitude(drive) == round(ofs * (hold + 1) / 32)
    assert drive.plant_state.bridges == "voltage"


@pytest.mark.parametrize("turns", [0.5, 1.0, 2.0])
@pytest.mark.parametrize(("ofs", "grad"), [(107, 0), (107, 20), (180, 40)])
def test_a_turning_motors_current_is_what_back_emf_and_inductance_leave(turns: float, ofs: int, grad: int) -> None:
    drive = turned(quiet_drive(pwmconf(ofs, grad, more=0)), turns)
    asked = min(ofs * (RATED + 1) / 32 + grad * 256 / drive.read("TSTEP"), 255)
    assert amplitude(drive) == round(asked)
    if MOTOR.torque_constant * 2 * math.pi * turns > 0.9 * volts(asked):
        assert drive.plant_state.lost_fullsteps > 0  # nothing is left that could turn it
    else:
        assert current(drive) == pytest.approx(unloaded_current(volts(asked), turns), rel=0.02)


def test_the_kernel_equals_the_plain_motor_behind_a_voltage() -> None:
    drive = quiet_drive(pwmconf(107, 30, more=0))
    plain = PlainMotor(drive.options)
    write(drive, {"VMAX": 3 * ONE_TURN_A_SECOND, "RAMPMODE": 1})
    for tick in range(8000):
        drive.advance(drive.clocks + TICK_CLOCKS)
        if tick == 0:
            plain.currents = [drive.plant_state.current_a_a, drive.plant_state.current_b_a]
            plain.theta, plain.omega = drive.plant_state.rotor_rad, drive.plant_state.speed_rad_s
            continue
        place = drive.read("MSCNT")
        # StealthChop's own sum, not the register's rounded one
        peak = volts(107 * (RATED + 1) / 32 + (30 * 256 / drive.read("TSTEP") if drive.read("VACTUAL") else 0))
        wave = [round(248 * math.sin(2 * math.pi * (at + 0.5) / 1024) - 0.5) + 0.5 for at in (place, place + 256)]
        plain.tick((peak * wave[0] / 248, peak * wave[1] / 248), volts=True)
    assert drive.plant_state.current_a_a == pytest.approx(plain.currents[0], abs=0.02)
    assert drive.plant_state.current_b_a == pytest.approx(plain.currents[1], abs=0.02)
    assert drive.plant_state.rotor_rad == pytest.approx(plain.theta, abs=1e-3)
    assert drive.plant_state.rotor_rad > 0.2


@pytest.mark.parametrize("resistance_ohm", [1.2, 2.3, 4.0])
@pytest.mark.parametrize("supply_v", [16.0, 24.0, 36.0])
def test_the_offset_is_tuned_at_rest_to_resistance_and_supply(resistance_ohm: float, supply_v: float) -> None:
    motor = MOTOR.model_copy(update={"resistance_ohm": resistance_ohm})
    drive = quiet_drive(pwmconf(), motor, supply_v)
    wait(drive, 0.13)  # the sheet's longest time for it
    expected = 374 * resistance_ohm * FULL_SCALE_A / math.sqrt(2) / supply_v
    found = tuned(drive)[0]
    if 36 * 2 / 1024 * supply_v / resistance_ohm > CURRENT_A:  # see the test of the shortest pulse
        assert found == 30
        return
    assert found == pytest.approx(min(expected, 255), abs=1.5)
    if expected < 255:
        assert current(drive) == pytest.approx(CURRENT_A, rel=0.02)
    wait(drive, 0.5)
    assert tuned(drive)[0] == found


@pytest.mark.parametrize(("power_down", "tunes"), [(0, False), (3, True)])
def test_the_offset_is_tuned_with_the_run_current_only(power_down: int, tunes: bool) -> None:
    drive = quiet_drive(pwmconf(), hold=2)
    drive.write("TPOWERDOWN", power_down)
    wait(drive, 0.3)
    assert tuned(drive)[0] == 30  # it stands with the hold current
    write(drive, {"VMAX": ONE_TURN_A_SECOND, "XTARGET": 1})
    wait(drive, 0.5)
    assert (tuned(drive)[0] == pytest.approx(106.4, abs=1.5)) is tunes


@pytest.mark.parametrize("turns", [2.0, 3.0])
@pytest.mark.parametrize("kt", [0.8, 1.0])
def test_the_gradient_is_tuned_in_motion_to_back_emf_and_inductance(turns: float, kt: float) -> None:
    motor = MOTOR.model_copy(update={"holding_torque_nm": 0.45 * kt})
    drive = quiet_drive(pwmconf(), motor)
    wait(drive, 0.2)
    turned(drive, turns, 3.0)
    wanted = needed_amplitude(turns, motor)
    expected = (wanted - 374 * 2.3 * CURRENT_A / math.sqrt(2) / SUPPLY_V) * drive.read("TSTEP") / 256
    assert tuned(drive)[1] == pytest.approx(expected, abs=2)
    assert amplitude(drive) == pytest.approx(wanted, abs=1.5)
    assert regulation(drive) in (-1, 0, 1)
    assert current(drive) == pytest.approx(CURRENT_A, rel=0.02)
    assert drive.plant_state.lost_fullsteps == 0


@pytest.mark.parametrize(("more", "turns"), [(AUTOSCALE, 2.0), (AUTOSCALE | AUTOGRAD, 0.5)])
def test_without_autograd_or_too_slow_the_regulation_does_it_alone(more: int, turns: float) -> None:
    drive = quiet_drive(pwmconf(more=more))
    wait(drive, 0.2)
    turned(drive, turns, 3.0)
    assert tuned(drive)[1] == 0
    assert regulation(drive) == pytest.approx(needed_amplitude(turns) - 39.9, abs=1.5)
    assert current(drive) == pytest.approx(CURRENT_A, rel=0.02)


@pytest.mark.parametrize("kind", [k.TUNED, k.AMPLITUDE, k.FIXED])
def test_the_greatest_change_a_half_wave_is_what_was_set(kind: int) -> None:
    """PWM_REG is in half increments; PWM_GRAD is it for the chips that have none, and in increments there."""
    changes = []
    for setting in (1, 2, 4):
        conf = pwmconf(255, 0 if kind == k.TUNED else setting, AUTOSCALE, reg=setting)
        drive = turned(quiet_drive(conf, kind=kind), 2.0, 1.5)
        drive.plant.supply_v = 9.0  # far more is needed at once
        most, before = 0.0, float(drive._f[k.PWM_AUTO])
        for _ in range(1600):
            drive.advance(drive.clocks + TICK_CLOCKS)
            now = float(drive._f[k.PWM_AUTO])
            most, before = max(most, abs(now - before)), now
        changes.append(most)
    assert changes == pytest.approx([0.5, 1.0, 2.0], rel=1e-6)


@pytest.mark.parametrize("kind", [k.AMPLITUDE, k.FIXED])
def test_an_amplitude_without_tuning_is_regulated_at_rest_and_in_motion(kind: int) -> None:
    drive = quiet_drive(pwmconf(255, 4, AUTOSCALE), kind=kind)
    wait(drive, 0.3)
    assert current(drive) == pytest.approx(CURRENT_A, rel=0.02)
    turned(drive, 2.0, 1.0)
    assert amplitude(drive) == pytest.approx(needed_amplitude(2.0), abs=1.5)


def test_a_fixed_amplitude_knows_no_current_scale_and_one_kind_no_velocity() -> None:
    for kind, grows in ((k.AMPLITUDE, True), (k.FIXED, False)):
        drive = quiet_drive(pwmconf(60, 20, more=0), kind=kind, hold=2)
        wait(drive, 1.0)
        assert amplitude(drive) == 60
        turned(drive, 1.0, 1.0)
        assert amplitude(drive) == (60 + round(20 * 256 / drive.read("TSTEP")) if grows else 60)


@pytest.mark.parametrize(("freq", "divider"), [(0, 1024), (1, 683), (2, 512), (3, 410)])
@pytest.mark.parametrize(("tbl", "blank"), [(0, 16), (1, 24), (2, 36), (3, 54)])
def test_no_current_below_the_shortest_pulse_is_regulated(freq: int, divider: int, tbl: int, blank: int) -> None:
    """t_blank f_PWM V / R (DS-TMC5160 7.3.1)."""
    drive = quiet_drive(pwmconf(255, 8, AUTOSCALE | freq << 16), kind=k.AMPLITUDE)
    write(drive, {"CHOPCONF": 0x3 | tbl << 15, "IHOLD_IRUN": 1 << 16})
    wait(drive, 0.5)
    lowest = blank * 2 / divider * SUPPLY_V / MOTOR.resistance_ohm
    expected = max(lowest, FULL_SCALE_A / 32)
    step = volts(0.6) / MOTOR.resistance_ohm  # half an increment is left alone
    assert current(drive) == pytest.approx(expected, abs=step)


@pytest.mark.parametrize(("ofs", "regulated"), [(0, True), (30, False)])
def test_an_offset_of_zero_forbids_what_cannot_be_measured(ofs: int, regulated: bool) -> None:
    drive = quiet_drive(pwmconf(ofs, more=AUTOSCALE))
    drive.write("CHOPCONF", 0x3 | 3 << 15)
    wait(drive, 0.5)
    drive.write("IHOLD_IRUN", 1 | 1 << 8 | 1 << 16)
    turned(drive, 0.1, 3.0)
    lowest = 54 * 2 / 1024 * SUPPLY_V / MOTOR.resistance_ohm
    expected = lowest if regulated else FULL_SCALE_A * 2 / 32
    assert current(drive) == pytest.approx(expected, rel=0.15)


def test_switching_over_to_spreadcycle_jerks_by_what_the_current_lagged() -> None:
    """With a voltage the current, and the rotor with it, lags the field by the angle of R, L and back-EMF."""
    jerks = []
    for turns in (0.5, 1.0, 2.0):
        drive = quiet_drive(pwmconf())
        wait(drive, 0.2)
        turned(drive, turns, 3.0)
        w = 2 * math.pi * turns
        across = (MOTOR.torque_constant + 50 * MOTOR.inductance_h * CURRENT_A) * w
        lag = math.degrees(math.atan2(across, MOTOR.resistance_ohm * CURRENT_A))
        assert drive.plant_state.load_angle_deg == pytest.approx(lag, abs=3)
        even = speeds(drive, 0.05)
        drive.write("TPWMTHRS", drive.read("TSTEP") + 1)
        jerked = speeds(drive, 0.05)
        wait(drive, 1.0)
        assert drive.plant_state.bridges == "regulated"
        assert abs(drive.plant_state.load_angle_deg) < 10
        assert drive.plant_state.lost_fullsteps == 0
        jerks.append(max(abs(jerked - w)))
        assert jerks[-1] > 20 * max(abs(even - w))
    assert jerks == sorted(jerks)


@pytest.mark.parametrize("lim", [0, 1, 3, 15])
def test_pwm_lim_bounds_the_regulation_as_stealthchop_takes_over_again(lim: int) -> None:
    drive = quiet_drive(pwmconf(more=AUTOSCALE, reg=1, lim=lim))
    wait(drive, 0.2)
    turned(drive, 2.0, 2.0)
    before = regulation(drive)
    assert before > 40
    drive.write("TPWMTHRS", drive.read("TSTEP") + 1)
    wait(drive, 0.2)
    drive.write("TPWMTHRS", 0)
    drive.advance(drive.clocks + TICK_CLOCKS)
    assert regulation(drive) == min(before, 16 * lim + 15)


def test_it_makes_no_difference_in_how_many_pieces_time_is_advanced() -> None:
    seen = []
    for pieces in (1, 977):
        drive = quiet_drive(pwmconf())
        wait(drive, 0.3)
        write(drive, {"VMAX": 2 * ONE_TURN_A_SECOND, "XTARGET": 100_000})
        start = drive.clocks
        for piece in range(1, pieces + 1):
            drive.advance(start + 3 * SECOND * piece // pieces)
        seen.append(
            (drive.read("PWM_AUTO"), drive.read("XACTUAL"), drive.plant_state.current_a_a, drive.plant_state.rotor_rad)
        )
    assert seen[0] == seen[1]
    assert seen[0][1] == 100_000


def test_a_standing_motor_is_left_alone_once_it_is_tuned() -> None:
    for kind in (k.TUNED, k.AMPLITUDE):
        drive = quiet_drive(pwmconf(255, 4), MotorOptions(), kind=kind)
        wait(drive, 0.5)
        before = amplitude(drive)
        assert drive.quiet
        drive.plant.supply_v = 12.0  # half of it: the amplitude has to double
        wait(drive, 0.3)
        assert amplitude(drive) == pytest.approx(2 * before, abs=1)
        assert drive.quiet
