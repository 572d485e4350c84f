"""The magnet on the shaft, the encoder with lines, and how far they may be apart from XACTUAL."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.emulators.drive import TICK_CLOCKS, Drive, EncoderOptions, EventKind
from tests.emulators.drive.rig import ONE_TURN_A_SECOND, bit, energised, until, wait, write

PERFECT = EncoderOptions(eccentricity_deg=0.0, second_harmonic_deg=0.0)


def by_hand(fullsteps: float, **options: object) -> Drive:
    drive = energised(encoders=EncoderOptions.model_validate(options))
    drive.plant.rotor_fullsteps = fullsteps
    return drive


@given(fullsteps=st.floats(-1000, 1000), zero=st.floats(-300, 300))
@settings(max_examples=60, deadline=None)
def test_the_magnet_tells_the_place_in_the_turn(fullsteps: float, zero: float) -> None:
    drive = by_hand(fullsteps, eccentricity_deg=0.0, second_harmonic_deg=0.0, internal_zero_fullsteps=zero)
    counts = (fullsteps - zero) * 1024 / 200
    assert drive.internal.counts == pytest.approx(counts, abs=0.51)
    assert drive.internal.absolute == drive.internal.counts % 1024


def test_eccentricity_is_an_error_once_a_turn_and_the_second_harmonic_twice() -> None:
    options = {"eccentricity_deg": 2.0, "second_harmonic_deg": 1.0, "internal_counts": 1 << 20}
    drive = by_hand(0.0, internal_zero_fullsteps=0.0, **options)
    errors = []
    for fullstep in range(200):
        drive.plant.rotor_fullsteps = float(fullstep)
        errors.append(drive.internal.counts / (1 << 20) * 360 - fullstep * 1.8)
    for harmonic, amplitude, phase in ((1, 2.0, 40.0), (2, 1.0, 110.0), (3, 0.0, 0.0)):
        sine, cosine = (
            sum(e * f(2 * math.pi * harmonic * i / 200) for i, e in enumerate(errors)) / 100
            for f in (math.sin, math.cos)
        )
        assert sine == pytest.approx(amplitude * math.cos(math.radians(phase)), abs=1e-3)
        assert cosine == pytest.approx(amplitude * math.sin(math.radians(phase)), abs=1e-3)


@pytest.mark.parametrize(("lines", "backwards"), [(1000, False), (1024, True)])
def test_lines_give_four_counts_each(lines: int, backwards: bool) -> None:
    drive = by_hand(0.0, external_lines=lines, external_reversed=backwards)
    drive.external.scale(51_200 * (-1 if backwards else 1), 4 * lines)
    drive.plant.rotor_fullsteps = 300.0
    assert drive.external.counts == (-1 if backwards else 1) * 6 * lines
    assert drive.external.position == pytest.approx(300 * 256, abs=15)


def test_a_graduation_that_is_off_shows_once_and_twice_a_turn() -> None:
    errors = {"eccentricity_deg": 0.4, "eccentricity_phase_deg": 20.0, "second_harmonic_deg": 0.1}
    drive = by_hand(0.0, external_lines=1 << 16, external_errors=errors)
    seen_deg = []
    for index in range(40):
        drive.plant.rotor_fullsteps = 5.0 * index
        seen_deg.append(drive.external.counts * 360 / (1 << 18) - 9.0 * index)
    turned = 2 * math.pi * np.arange(40) / 40
    once = 2 * np.mean(seen_deg * np.exp(-1j * turned)) * 1j
    # what comes twice is seen at the angle that eccentricity has moved already
    assert abs(once) == pytest.approx(0.4, abs=2e-3)
    assert math.degrees(np.angle(once)) == pytest.approx(20, abs=0.5)
    assert abs(2 * np.mean(seen_deg * np.exp(-2j * turned))) == pytest.approx(0.1, abs=5e-3)


@pytest.mark.parametrize("phase_deg", [0.0, 90.0])
def test_unequal_phases_of_an_encoder_move_its_counts_within_a_line(phase_deg: float) -> None:
    errors = {"line_error": 0.1, "line_error_phase_deg": phase_deg}
    drive = by_hand(0.0, external_lines=5, external_errors=errors)
    for index in range(81):
        place = index / 40 + 0.003  # lines
        drive.plant.rotor_fullsteps = place * 40
        seen = place + 0.1 * math.sin(2 * math.pi * place + math.radians(phase_deg))
        assert drive.external.counts == math.floor(4 * seen + 0.5)


def test_positions_are_zero_at_power_on_and_follow_the_rotor() -> None:
    drive = energised(start_fullsteps=1000.0)
    assert (drive.internal.position, drive.external.position) == (0, 0)
    write(drive, {"XTARGET": 512_000})
    until(drive, EventKind.POSITION_REACHED)
    wait(drive, 0.2)
    # a whole count is 50 microsteps, the friction's dead band a few more
    assert drive.internal.position == pytest.approx(512_000, abs=70)
    assert abs(drive.internal.deviation) < 70
    drive.internal.position = -7
    assert drive.internal.position == -7
    drive.internal.scale(200 * 16, 1024)
    assert drive.internal.position == -7
    drive.write("XTARGET", 0)
    until(drive, EventKind.POSITION_REACHED)
    wait(drive, 0.2)
    assert drive.internal.position == pytest.approx(-7 - 32_000, abs=6)


def test_the_chip_counts_by_enc_const_binary_or_decimal() -> None:
    drive = Drive()
    drive.write("ENC_CONST", 12 << 16 | 0xCCCC)
    drive.plant.rotor_fullsteps = 20.0  # 400 counts
    assert drive.read("X_ENC") == 400 * (12 * 65_536 + 0xCCCC) // 65_536
    write(drive, {"ENCMODE": 1 << 10, "ENC_CONST": 12 << 16 | 8000, "X_ENC": 0})
    drive.plant.rotor_fullsteps = 40.0
    assert drive.read("X_ENC") == 5120
    write(drive, {"ENC_CONST": (2**16 - 13) << 16 | 2000, "X_ENC": 0})  # -12.8
    drive.plant.rotor_fullsteps = 60.0
    assert drive.read("X_ENC") == -5120


def test_a_null_clears_once_where_it_is() -> None:
    drive = energised(encoders=PERFECT)
    drive.internal.clear_on_null = True
    write(drive, {"VMAX": ONE_TURN_A_SECOND, "RAMPMODE": 1})
    until(drive, EventKind.INTERNAL_NULL)
    assert drive.plant_state.rotor_fullsteps == pytest.approx(37.3, abs=0.15)
    assert not drive.internal.clear_on_null
    assert drive.internal.position == pytest.approx(0, abs=50)
    wait(drive, 2.0)
    assert drive.internal.position == pytest.approx((drive.plant_state.rotor_fullsteps - 37.3) * 256, abs=60)
    drive.external.clear_on_null = True
    until(drive, EventKind.EXTERNAL_NULL)
    assert drive.external.absolute in (0, 1)


@pytest.mark.parametrize("which", ["internal", "external"])
def test_a_deviation_stops_the_motor_until_it_is_taken_back(which: str) -> None:
    drive = energised()
    drive.external.scale(51_200, 4000)
    encoder = drive.internal if which == "internal" else drive.external
    kind = EventKind.DEVIATION_INTERNAL if which == "internal" else EventKind.DEVIATION_EXTERNAL
    encoder.limit = 1000
    write(drive, {"VMAX": ONE_TURN_A_SECOND, "RAMPMODE": 1})
    wait(drive, 2.0)
    assert drive.read("VACTUAL") == ONE_TURN_A_SECOND
    drive.plant.blocked = True
    event = until(drive, kind, 0.1)
    assert encoder.exceeded
    assert abs(encoder.deviation) == pytest.approx(1000, abs=80)
    wait(drive, 0.5)
    assert drive.read("VACTUAL") == 0
    assert drive.read("XACTUAL") == event.position
    drive.plant.blocked = False
    encoder.position = drive.read("XACTUAL")
    encoder.exceeded = False
    wait(drive, 1.0)
    assert drive.read("VACTUAL") == ONE_TURN_A_SECOND


@given(limit=st.integers(60, 400), slip=st.floats(-1, 1), load_nm=st.floats(-0.25, 0.25))
@settings(max_examples=25, deadline=None)
def test_the_tick_of_a_deviation_is_the_first_in_which_it_is_too_large(limit: int, slip: float, load_nm: float) -> None:
    """The kernel does not work out encoders that are clearly near enough; here they are, in every tick."""
    watched, looked_at = energised(), energised()
    for drive in (watched, looked_at):
        drive.external.scale(51_200, 4000)
        drive.plant.encoder_slip_fullsteps = drive.plant.external_slip_fullsteps = slip
        write(drive, {"VMAX": 2 * ONE_TURN_A_SECOND, "RAMPMODE": 1})
        drive.plant.load_torque_nm = load_nm
    watched.internal.limit = watched.external.limit = limit
    watched.watch = EventKind.DEVIATION_INTERNAL | EventKind.DEVIATION_EXTERNAL
    event = watched.advance(watched.clocks + 1_600_000)
    for _ in range(6250):
        looked_at.advance(looked_at.clocks // TICK_CLOCKS * TICK_CLOCKS + TICK_CLOCKS)
        if max(abs(looked_at.internal.deviation), abs(looked_at.external.deviation)) > limit:
            break
    else:
        assert event is None
        return
    assert event is not None
    assert event.clocks == looked_at.clocks
    assert looked_at.internal.deviation == watched.internal.deviation
    assert looked_at.external.deviation == watched.external.deviation


def test_a_deviation_may_be_only_told() -> None:
    drive = energised()
    drive.write("ENC_CONST", round(12.8 * 65_536))
    write(drive, {"ENC_DEVIATION": 1000, "VMAX": ONE_TURN_A_SECOND, "RAMPMODE": 1})
    wait(drive, 0.5)
    assert drive.read("ENC_STATUS") == 0
    drive.plant.blocked = True
    until(drive, EventKind.DEVIATION_EXTERNAL, 0.1)
    assert bit(drive.read("ENC_STATUS"), 1)
    wait(drive, 0.5)
    assert drive.read("VACTUAL") == ONE_TURN_A_SECOND
    drive.plant.blocked = False
    drive.write("X_ENC", drive.read("XACTUAL"))
    drive.write("ENC_STATUS", 2)
    wait(drive, 0.1)
    assert drive.read("ENC_STATUS") == 0


def test_a_slipping_magnet_is_a_deviation_that_the_rotor_knows_nothing_of() -> None:
    drive = energised()
    before, rotor = drive.internal.position, drive.plant_state.rotor_fullsteps
    drive.internal.limit = 500
    drive.plant.encoder_slip_fullsteps = 4.0
    until(drive, EventKind.DEVIATION_INTERNAL, 0.001)
    assert drive.internal.position - before == pytest.approx(1024, abs=60)
    assert drive.external.position == 0
    drive.plant.external_slip_fullsteps = -10.0
    assert drive.external.position == -200
    assert drive.plant_state.rotor_fullsteps == pytest.approx(rotor, abs=1e-9)


@pytest.mark.parametrize(("numerator", "denominator"), [(1, 0), (1 << 40, 1), (1, 1 << 33)])
def test_scales_that_do_not_fit_are_refused(numerator: int, denominator: int) -> None:
    with pytest.raises(ValueError, match=r"denominator|fit"):
        Drive().internal.scale(numerator, denominator)


def test_play_keeps_an_encoder_where_it_is_until_the_shaft_has_turned_through_it() -> None:
    errors = {"backlash_deg": 0.9}
    drive = energised(encoders=EncoderOptions.model_validate({"external_lines": 1 << 16, "external_errors": errors}))
    seen = []
    for target in (512, 1024, 768, 512):
        write(drive, {"XTARGET": target})
        until(drive, EventKind.POSITION_REACHED)
        wait(drive, 0.3)
        seen.append(drive.external.counts * 200 / (1 << 18) - drive.plant.rotor_fullsteps)
    # 0.9 degrees are half a full step: behind by half of that whichever way it came
    assert seen == pytest.approx([-0.25, -0.25, 0.25, 0.25], abs=0.01)
