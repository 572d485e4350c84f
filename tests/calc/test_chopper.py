"""Chopper hints: the sheets' worked examples, the application note's measured motor, and what must always hold."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.motor_torque import StepperMotor
from app.calc.tmc5xxx.chopper import BLANK_CLOCKS, PWM_DIVIDERS, Winding
from app.calc.tmc5xxx.chopper_hints import blank_setting, hints, split
from app.calc.tmc5xxx.chopper_notes import SHEETS, ChopperChoices
from app.calc.tmc5xxx.stealth import pwm_setting
from app.registers.tmc5xxx import driver as tmc5xxx_driver

MOTOR = Winding(2.3, 4.4e-3, 1.06, 24, 16e6, holding_torque_nm=0.45, rated_current_a=1.5)
"""A common motor of 40 mm."""

windings = st.builds(
    Winding,
    resistance_ohm=st.floats(0.2, 30),
    inductance_h=st.floats(2e-4, 5e-2),
    current_a=st.floats(0.05, 5),
    supply_v=st.floats(5, 60),
    clock_hz=st.floats(4e6, 18e6),
    irun=st.integers(0, 31),
    holding_torque_nm=st.floats(0.01, 10) | st.none(),
    full_steps_per_rev=st.sampled_from([200, 400]),
)


@pytest.mark.parametrize(("clock_hz", "toff"), [(12e6, 3.0), (16e6, 4.25)])
def test_the_sheets_off_time(clock_hz: float, toff: float) -> None:
    """DS-TMC5160 8.1: 25 kHz, half of a cycle in two slow decays; the results take 24 clocks, the formula says 12."""
    assert Winding(1, 1e-3, 1, 24, clock_hz).toff(25e3) == pytest.approx(toff)
    assert Winding(1, 1e-3, 1, 24, clock_hz).off_s(3) == 120 / clock_hz


def test_the_sheets_hysteresis() -> None:
    """DS-TMC5160 8.1: 4 with as much as can be in HSTRT is HSTRT 6 and HEND 0."""
    assert split(4) == (6, 0)
    assert split(-2) == (0, 0)
    assert split(16) == (7, 11)
    with pytest.raises(ValueError, match="-2 to 16"):
        split(17)


def test_the_register_tables_know_the_same_blank_times() -> None:
    """Neither may import the other."""
    assert tuple(tmc5xxx_driver.BLANK_CLOCKS.values()) == BLANK_CLOCKS


@given(hysteresis=st.integers(-2, 16))
def test_a_hysteresis_is_what_both_fields_make(hysteresis: int) -> None:
    start, end = split(hysteresis)
    assert (start + 1) + (end - 3) == hysteresis
    assert 0 <= start <= 7
    assert 0 <= end <= 15


def test_the_sheets_lowest_current() -> None:
    """DS-TMC5160 7.3.1: 5 Ohm at 24 V with TBL 1 and pwm_freq 0 takes 225 mA."""
    assert Winding(5, 1e-3, 1, 24, 16e6).lowest_current_a(1, 0) == pytest.approx(0.225)


@pytest.mark.parametrize(
    ("clock_hz", "khz"),
    [(18e6, (35.2, 52.7, 70.3, 87.8)), (16e6, (31.3, 46.9, 62.5, 78.0)), (8e6, (15.6, 23.4, 31.2, 39.0))],
)
def test_the_sheets_pwm_frequencies(clock_hz: float, khz: tuple[float, ...]) -> None:
    """DS-TMC5160 7.2, table 7.1."""
    winding = Winding(1, 1e-3, 1, 24, clock_hz)
    assert [winding.pwm_hz(n) / 1e3 for n in range(4)] == pytest.approx(khz, abs=0.06)


@given(clock_hz=st.floats(8e6, 18e6))
def test_pwm_frequencies_that_are_chosen_are_recommended(clock_hz: float) -> None:
    assert 20e3 <= 2 * clock_hz / PWM_DIVIDERS[pwm_setting(clock_hz)] <= 50e3


@pytest.mark.parametrize(("clock_hz", "tbl"), [(18e6, 2), (16e6, 1), (12e6, 1), (8e6, 0), (4e6, 0)])
def test_blank_times_of_one_to_two_microseconds(clock_hz: float, tbl: int) -> None:
    """AN-001."""
    assert blank_setting(clock_hz) == tbl


def test_amplitude_and_gradient() -> None:
    """DS-TMC5160 7.4: PWM_OFS = 374 R I / V; C_BEMF = T / 2 I; PWM_GRAD = C_BEMF 2 pi fCLK 1.46 / (V MSPR)."""
    assert MOTOR.amplitude() == pytest.approx(374 * 2.3 * 1.06 / 24)
    assert MOTOR.back_emf == pytest.approx(0.15)
    assert MOTOR.gradient == pytest.approx(0.15 * 2 * math.pi * 16e6 * 1.46 / (24 * 51_200))


@given(winding=windings)
def test_at_its_limit_stealthchops_amplitude_is_255(winding: Winding) -> None:
    limit, gradient = winding.stealth_limit_rad_s(), winding.gradient
    if limit and gradient:
        steps_hz = limit / (2 * math.pi) * 256 * winding.full_steps_per_rev
        assert winding.amplitude() + gradient * 256 * steps_hz / winding.clock_hz == pytest.approx(255)


@given(winding=windings)
def test_at_its_limit_the_supply_is_used_up(winding: Winding) -> None:
    """The voltage equation of a coil whose current is in phase with the back-EMF."""
    limit, back_emf = winding.current_limit_rad_s(), winding.back_emf
    if limit and back_emf:
        resistive = winding.resistance_ohm * winding.peak_a + back_emf * math.sqrt(2) * limit
        reactive = winding.full_steps_per_rev / 4 * limit * winding.inductance_h * winding.peak_a
        assert math.hypot(resistive, reactive) == pytest.approx(winding.supply_v)


def test_the_speed_limit_is_the_ramp_designers_motors_too() -> None:
    """Beyond it the designer's curve of torque falls off: both know the same motor."""
    motor = StepperMotor(0.45, 1.5, MOTOR.peak_a, 2.3, 4.4e-3, 24)
    limit = MOTOR.current_limit_rad_s()
    assert limit is not None
    pps = limit / motor.microstep_rad
    held = motor.torque_constant * motor.current_a
    assert motor.available_nm(pps * 0.9) == pytest.approx(held)
    assert motor.available_nm(pps * 2) < held * 0.9


def test_the_application_notes_motor() -> None:
    """AN-001 0.5 Ohm, 0.6 mH, IRUN 23 at 0.15 Ohm: 26 kHz with TBL 2, TOFF 5 and hysteresis 6, then 60 kHz with TBL 1
    and TOFF 2, where it takes a hysteresis beyond what is usual. The estimate leaves out what switching takes."""
    winding = Winding(0.5, 0.6e-3, 1.01, 24, 16e6, irun=23)
    assert 26e3 < winding.chopper_hz(2, 5, 6) < 26e3 * 1.5
    found = hints("tmc5130", winding, ChopperChoices(tbl=1, toff=2))
    assert next(f.value for f in found.figures if f.name == "chopper_frequency") == pytest.approx(60e3, rel=0.25)
    assert found.value("hstrt") + 1 + found.value("hend") - 3 > 8
    assert any("kHz" in said for said in found.warnings)


@given(winding=windings, toff=st.integers(1, 15), tbl=st.integers(1, 3), hysteresis=st.integers(1, 16))
def test_no_chopper_is_faster_than_its_shortest_cycle(winding: Winding, toff: int, tbl: int, hysteresis: int) -> None:
    assert 0 <= winding.chopper_hz(tbl, toff, hysteresis) <= winding.highest_chopper_hz(tbl, toff) * (1 + 1e-9)


@pytest.mark.parametrize("model", list(SHEETS))
@given(winding=windings, automatic=st.booleans(), chopper_hz=st.floats(5e3, 200e3))
def test_every_hint_fits_its_field_and_says_why(
    model: str, winding: Winding, automatic: bool, chopper_hz: float
) -> None:
    found = hints(model, winding, ChopperChoices(automatic=automatic, chopper_hz=chopper_hz))
    tops = {
        "toff": 15,
        "tbl": 3,
        "hstrt": 7,
        "hend": 15,
        "pwm_freq": 3,
        "PWM_OFS": 255,
        "PWM_AMPL": 255,
        "PWM_GRAD": 255,
    }
    for setting in found.settings:
        assert 0 <= setting.value <= tops.get(setting.field, 1)
        assert setting.meaning
        assert setting.reason
        assert setting.source
    names = [setting.field for setting in found.settings]
    assert len(names) == len(set(names)), "none is said twice"
    assert ("pwm_freq" in names) == (SHEETS[model].stealth != "none")
    assert ("pwm_autograd" in names) == (SHEETS[model].stealth == "tuned" and winding.holding_torque_nm is not None)
    assert found.value("toff") > 1 or found.value("tbl") > 0
    assert all(math.isfinite(figure.value) and figure.reason and figure.source for figure in found.figures)


@given(winding=windings)
def test_the_band_holds_the_ripple_or_it_is_said(winding: Winding) -> None:
    found = hints("tmc5160", winding)
    figures = {figure.name: figure.value for figure in found.figures}
    enough = figures["hysteresis_band"] >= (figures["blank_ripple"] + figures["decay_ripple"]) * (1 - 1e-6)
    assert enough or any("is the most" in said for said in found.warnings)


def test_what_is_asked_for_is_kept() -> None:
    found = hints("tmc5160", MOTOR, ChopperChoices(tbl=2, toff=3, hysteresis=9, pwm_freq=2))
    assert [found.value(name) for name in ("tbl", "toff", "hstrt", "hend", "pwm_freq")] == [2, 3, 7, 4, 2]
    assert not any(s.chosen for s in found.settings if s.field in ("tbl", "toff", "hstrt", "hend", "pwm_freq"))
    with pytest.raises(ValueError, match="24 clocks"):
        hints("tmc5160", MOTOR, ChopperChoices(tbl=0, toff=1))


def test_a_common_motor_at_every_chip() -> None:
    """Effective hysteresis 4 for most motors (DS-TMC5160 8.1), and this is one of them."""
    for model in SHEETS:
        found = hints(model, MOTOR)
        assert [found.value(name) for name in ("tbl", "toff", "hstrt", "hend")] == [1, 4, 6, 0]
        assert not found.warnings
    assert [hints("tmc5160", MOTOR).value(name) for name in ("PWM_OFS", "PWM_GRAD")] == [38, 18]
    assert [hints("tmc5130", MOTOR).value(name) for name in ("PWM_AMPL", "PWM_GRAD")] == [255, 4]
    fixed = ChopperChoices(automatic=False)
    assert [hints("tmc5130", MOTOR, fixed).value(name) for name in ("PWM_AMPL", "PWM_GRAD")] == [38, 18]
    assert [hints("tmc5072", MOTOR, fixed).value(name) for name in ("PWM_AMPL", "PWM_GRAD")] == [38, 1]


def test_speeds_in_every_unit_that_is_of_use() -> None:
    """DS-TMC5160 13.5: a turn a second is where StallGuard begins to work for many motors."""
    figures = {figure.name: figure.value for figure in hints("tmc5160", MOTOR).figures}
    assert figures["stallguard_least"] == pytest.approx(51_200)
    assert figures["stallguard_least_rpm"] == pytest.approx(60)
    assert figures["stallguard_least_tstep"] == 312
    assert figures["stallguard_least"] < figures["current_limit"] < figures["stealthchop_limit"]
    sixteenth = {f.name: f.value for f in hints("tmc5160", MOTOR, ChopperChoices(microsteps=16)).figures}
    assert sixteenth["current_limit"] == pytest.approx(figures["current_limit"] / 16)
    assert sixteenth["current_limit_tstep"] == figures["current_limit_tstep"]


@pytest.mark.parametrize(
    ("winding", "text"),
    [
        (Winding(20, 4e-3, 1.5, 24, 16e6), "cannot drive this current"),
        (Winding(10, 4e-3, 1.5, 24, 16e6), "below twice"),
        (Winding(0.5, 4e-3, 1.0, 24, 16e6), "above 25 times"),
        (Winding(5, 4e-3, 0.2, 24, 16e6), "regulates nothing below 0.225 A"),
        (Winding(2.3, 4e-3, 1.0, 24, 16e6, irun=7), "IRUN 7 is below 8"),
        (Winding(2.3, 4e-3, 1.0, 24, 16e6), "no PWM_GRAD"),
        (Winding(2.3, 1e-4, 1.0, 24, 16e6), "is the most"),
        (Winding(2.3, 1e-4, 1.0, 24, 16e6), "IRUN of 30"),
        (Winding(20, 4e-3, 1.5, 24, 16e6), "even at rest"),
        (Winding(8, 3e-1, 1.5, 24, 16e6), "may be heard"),
    ],
)
def test_what_is_warned_of(winding: Winding, text: str) -> None:
    assert any(text in said for said in hints("tmc5160", winding).warnings)


def test_what_cannot_be() -> None:
    with pytest.raises(ValueError, match="model is one of"):
        hints("tmc4361", MOTOR)
    with pytest.raises(ValueError, match="resistance_ohm is above 0"):
        Winding(0, 1e-3, 1, 24, 16e6)
    with pytest.raises(ValueError, match="supply_v is above 0"):
        Winding(1, 1e-3, 1, math.inf, 16e6)
    with pytest.raises(ValueError, match="holding_torque_nm is above 0"):
        Winding(1, 1e-3, 1, 24, 16e6, holding_torque_nm=-1)
    with pytest.raises(ValueError, match="irun"):
        Winding(1, 1e-3, 1, 24, 16e6, irun=32)
