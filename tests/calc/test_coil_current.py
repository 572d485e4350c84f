"""Coil currents of the TMC5xxx: the sheets' tables, settings there and back, the nearest setting for any current."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.tmc5xxx.chips import CHIPS
from app.calc.tmc5xxx.coil import (
    CurrentStage,
    error,
    full_scale_rms_a,
    nearest_hold,
    range_share,
    select_share,
    warnings,
)

MODELS = [model for model, chip in CHIPS.items() if not chip.sensing.range_va]
"""With sense resistors, or able to take some."""
SENSE_OHM = st.floats(0.02, 1.0)


def stage(model: str, ohm: float = 0.15) -> CurrentStage:
    return CurrentStage(model, ohm)


@pytest.mark.parametrize(
    ("ohm", "rms_a", "peak_a"),
    [
        (0.22, 1.1, 1.5),
        (0.15, 1.6, 2.2),
        (0.12, 2.0, 2.8),
        (0.10, 2.3, 3.3),
        (0.075, 3.1, 4.4),
        (0.066, 3.5, 5.0),
        (0.050, 4.7, 6.6),
        (0.033, 7.1, 10.0),
        (0.022, 10.6, 15.0),
    ],
)
def test_sense_resistors_of_a_tmc5160(ohm: float, rms_a: float, peak_a: float) -> None:
    """DS-TMC5160 9: the table is rounded, its RMS column from the rounded peaks."""
    full = stage("tmc5160", ohm).setting(31, 256)
    assert full.peak_a == pytest.approx(peak_a, abs=0.26 if ohm < 0.05 else 0.1)
    assert full.rms_a == pytest.approx(rms_a, rel=0.055)


@pytest.mark.parametrize(
    ("ohm", "low", "high"),
    [
        (1.00, 0.23, 0.12),
        (0.82, 0.27, 0.15),
        (0.75, 0.30, 0.17),
        (0.68, 0.33, 0.18),
        (0.50, 0.44, 0.24),
        (0.47, 0.47, 0.26),
        (0.33, 0.66, 0.36),
        (0.27, 0.79, 0.44),
        (0.22, 0.96, 0.53),
        (0.15, 1.35, 0.75),
        (0.12, 1.64, 0.91),
        (0.10, 1.92, 1.06),
    ],
)
def test_sense_resistors_of_a_tmc5130(ohm: float, low: float, high: float) -> None:
    """DS-TMC5130 10, RMS with vsense 0 and 1: reckoned with 0.325 V, as in 30.2, where the text of 10 says 0.32 V."""
    chip = stage("tmc5130", ohm)
    assert chip.setting(31, 0).rms_a == pytest.approx(low, abs=0.0051)
    assert chip.setting(31, 1).rms_a == pytest.approx(high, abs=0.0051)


@pytest.mark.parametrize(
    ("ohm", "low", "high"),
    [(1.00, 0.21, 0.12), (0.50, 0.42, 0.24), (0.33, 0.63, 0.35), (0.22, 0.91, 0.51), (0.15, 1.29, 0.72)],
)
@pytest.mark.parametrize("model", ["tmc5031", "tmc5062", "tmc5072"])
def test_sense_resistors_of_chips_with_two_axes(model: str, ohm: float, low: float, high: float) -> None:
    """DS-TMC5072 7 (and DS-TMC5031 6): the table has some 3 % less than 0.32 V and 0.18 V, stated beside it, give."""
    chip = stage(model, ohm)
    for select, printed in enumerate((low, high)):
        assert 0 < chip.setting(31, select).rms_a / printed - 1 < 0.06


@pytest.mark.parametrize(
    ("ohm", "low", "high"),
    [
        (6800, 1.92, 1.06),
        (7500, 1.76, 0.97),
        (8200, 1.63, 0.90),
        (9100, 1.49, 0.82),
        (10_000, 1.36, 0.75),
        (12_000, 1.15, 0.63),
        (15_000, 0.94, 0.52),
        (18_000, 0.79, 0.43),
        (22_000, 0.65, 0.36),
        (24_000, 0.60, 0.33),
        (27_000, 0.54, 0.29),
    ],
)
def test_a_tmc5130_without_sense_resistors(ohm: float, low: float, high: float) -> None:
    """DS-TMC5130 11: peaks with vsense 0 and 1."""
    chip = CurrentStage("tmc5130", None, reference_ohm=ohm)
    assert chip.full_scale_a(0) == pytest.approx(low, abs=0.0051)
    assert chip.full_scale_a(1) == pytest.approx(high, abs=0.0051)
    assert chip.sense_power_w(1.0) is None


def test_a_voltage_at_ain_scales_the_current() -> None:
    """DS-TMC5130 9: in proportion up to 2.5 V, no more above."""
    inside = stage("tmc5130").full_scale_a(0)
    for volts, share in ((0.0, 0.0), (1.25, 0.5), (2.5, 1.0), (5.0, 1.0)):
        assert CurrentStage("tmc5130", 0.15, ain_v=volts).full_scale_a(0) == pytest.approx(share * inside)


@pytest.mark.parametrize("model", MODELS)
@given(ohm=SENSE_OHM, scale=st.integers(0, 31), part=st.floats(0, 1))
def test_every_setting_is_found_again(model: str, ohm: float, scale: int, part: float) -> None:
    chip = stage(model, ohm)
    select = chip.selects[round(part * (len(chip.selects) - 1))]
    wanted = chip.setting(scale, select)
    found = chip.ranked(wanted.peak_a)
    assert abs(error(found[0], wanted.peak_a)) <= 0.031
    assert chip.ranked(wanted.peak_a, select)[0].select == select
    exact = min(abs(error(setting, wanted.peak_a)) for setting in found)
    assert exact < 1e-9, "the setting itself, or another of the same current, is among them"


@pytest.mark.parametrize("model", MODELS)
@given(ohm=SENSE_OHM, peak_a=st.floats(0.01, 5))
def test_the_best_setting_is_as_near_as_a_scale_allows(model: str, ohm: float, peak_a: float) -> None:
    """Half a step of the scale, once full scale reaches that far; and fine scales wherever they come near."""
    chip = stage(model, ohm)
    best = chip.ranked(peak_a)[0]
    full = chip.full_scale_a(chip.selects[-1] if model == "tmc5160" else 0)
    if peak_a <= full:
        least = full / 32 / (8 if model == "tmc5160" else 1)
        assert abs(best.peak_a - peak_a) <= max(least / 2, 0.03 * peak_a) * (1 + 1e-9) or peak_a < least
    else:
        assert best.scale == 31
        assert best.peak_a == pytest.approx(full)
    fine = [s for s in chip.settings() if s.scale >= 16 and abs(error(s, peak_a)) <= 0.03]
    assert best.scale >= 16 or not fine


def test_a_tmc5160_keeps_irun_at_31_where_the_scaler_can_do_it() -> None:
    """DS-TMC5160 9: IRUN 31, and the rest by GLOBALSCALER."""
    best = stage("tmc5160", 0.075).ranked(2.0 * math.sqrt(2))[0]
    assert (best.scale, best.select) == (31, 167)
    assert best.rms_a == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize("model", MODELS)
@given(peak_a=st.floats(0, 3))
def test_a_hold_current_is_looked_for_with_the_selection_of_the_run_current(model: str, peak_a: float) -> None:
    chip = stage(model)
    run = chip.ranked(1.0)[0]
    held = nearest_hold(chip.settings(run.select), peak_a)
    assert held.select == run.select
    assert all(abs(held.peak_a - peak_a) <= abs(s.peak_a - peak_a) for s in chip.settings(run.select))


def test_power_in_the_sense_resistor() -> None:
    """DS-TMC5160 9: I^2 R, with the peak at rest."""
    assert stage("tmc5160", 0.1).sense_power_w(2.0) == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("scale", "select", "ohm", "text"),
    [
        (15, 256, 0.1, "below 16"),
        (7, 256, 0.1, "below 8"),
        (31, 128, 0.1, "GLOBAL_SCALER 128"),
    ],
)
def test_what_is_to_be_said_of_a_tmc5160(scale: int, select: int, ohm: float, text: str) -> None:
    chip = stage("tmc5160", ohm)
    assert any(text in said for said in warnings(chip, chip.setting(scale, select), None))


def test_what_is_to_be_said_of_the_others() -> None:
    small = stage("tmc5072", 0.1)
    assert any("1.1 A" in said for said in warnings(small, small.setting(31, 0), None))
    assert any("below 6" in said for said in warnings(small, small.setting(5, 0), None))
    inside = CurrentStage("tmc5130", None, reference_ohm=6800)
    assert any("0.2 to 1.2 A" in said for said in warnings(inside, inside.setting(31, 0), None))
    analog = CurrentStage("tmc5130", 0.15, ain_v=0.4)
    assert any("0.5 V" in said for said in warnings(analog, analog.setting(31, 0), None))
    chip = stage("tmc5031")
    assert any("at rest is above" in said for said in warnings(chip, chip.setting(16, 0), chip.setting(17, 0)))
    assert not warnings(chip, chip.setting(20, 0), chip.setting(10, 0)), "and it has no StealthChop"


def test_what_a_chip_has_not() -> None:
    with pytest.raises(ValueError, match="model is one of"):
        stage("tmc4361")
    with pytest.raises(ValueError, match="sense_resistor_ohm is missing"):
        CurrentStage("tmc5160", None)
    with pytest.raises(ValueError, match="no AIN_IREF"):
        CurrentStage("tmc5072", 0.1, ain_v=1)
    with pytest.raises(ValueError, match="reference_resistor_ohm"):
        CurrentStage("tmc5130", None)
    with pytest.raises(ValueError, match="not both"):
        CurrentStage("tmc5130", 0.1, reference_ohm=1e4)
    with pytest.raises(ValueError, match="not a voltage"):
        CurrentStage("tmc5130", None, reference_ohm=1e4, ain_v=1)
    with pytest.raises(ValueError, match="above 0"):
        stage("tmc5160", 0)
    with pytest.raises(ValueError, match="0 to 5 V"):
        CurrentStage("tmc5130", 0.1, ain_v=6)
    with pytest.raises(ValueError, match="vsense is 0 or 1"):
        stage("tmc5072").full_scale_a(2)
    for scaler in (31, 0, 257):
        with pytest.raises(ValueError, match="GLOBAL_SCALER"):
            stage("tmc5160").full_scale_a(scaler)
    with pytest.raises(ValueError, match="scale is 0 to 31"):
        stage("tmc5160").setting(32, 256)
    with pytest.raises(ValueError, match="above 0 A"):
        stage("tmc5160").ranked(0)


@pytest.mark.parametrize(("index", "peak_a"), [(0, 11.75 / 12), (1, 2.0), (2, 3.0), (None, 3.0)])
def test_ranges_of_a_tmc5240_with_12_kohm(index: int | None, peak_a: float) -> None:
    ranged = CurrentStage("tmc5240", None, 12_000, current_range=index)
    assert ranged.setting(31, 256).peak_a == pytest.approx(peak_a)
    assert ranged.setting(15, 128).peak_a == pytest.approx(peak_a / 4)
    assert CurrentStage("tmc5240", None, 24_000, current_range=index).full_scale_a(256) == pytest.approx(peak_a / 2)


@pytest.mark.parametrize(("peak_a", "index"), [(0.5, 0), (0.99, 1), (2.0, 1), (2.1, 2), (9.0, 2)])
def test_a_wanted_current_takes_the_lowest_range_that_gets_there(peak_a: float, index: int) -> None:
    found = CurrentStage("tmc5240", None, 12_000).for_peak(peak_a)
    assert found.current_range == index
    assert found.ranked(min(peak_a, 3.0))[0].peak_a == pytest.approx(min(peak_a, 3.0), rel=0.01)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"sense_ohm": 0.1}, "measures inside"),
        ({"sense_ohm": None}, "12000 to 60000, got None"),
        ({"sense_ohm": None, "reference_ohm": 9000.0}, "12000 to 60000, got 9000"),
        ({"sense_ohm": None, "reference_ohm": 12e3, "current_range": 4}, "current_range is 0 to 3, got 4"),
    ],
)
def test_what_a_tmc5240_cannot_have_is_named(given: dict[str, float], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        CurrentStage("tmc5240", **given)  # type: ignore[arg-type]


def test_full_scale_is_told_by_either_figure() -> None:
    """RMS with vsense 0, the scaler 256 and the widest range; a current that is told counts before a resistor."""
    for model, ohm in (("tmc5130", 0.15), ("tmc5160", 0.075), ("tmc2660", 0.1)):
        chip = stage(model, ohm)
        most = max(chip.full_scale_a(select) for select in chip.selects) / math.sqrt(2)
        assert full_scale_rms_a(model, ohm, None) == pytest.approx(most)
        assert full_scale_rms_a(model, ohm, 2.0) == 2.0
        for select in chip.selects:
            assert select_share(model, select) * most == pytest.approx(chip.setting(31, select).rms_a)
        assert range_share(model, 0) == 1.0
    assert full_scale_rms_a("tmc5160", None, None) is None
    assert full_scale_rms_a("tmc5240", 0.1, None) is None, "it has no sense resistor"
    assert [range_share("tmc5240", n) for n in range(3)] == pytest.approx([11.75 / 36, 24 / 36, 1.0])
