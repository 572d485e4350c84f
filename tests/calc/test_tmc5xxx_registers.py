"""Every register of a velocity, an acceleration or a time, of every chip, over its whole range."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.calc.units.tmc5xxx_registers import MODELS, Format, formats
from app.calc.units.tmc5xxx_times import TSTEP_MAX

EVERY = [(model, name) for model in MODELS for name in formats(model)]
clocks = st.floats(4e6, 18e6)
resolutions = st.sampled_from([1, 16, 256])


def least_raw(form: Format) -> int:
    """The step from one number to the next: thresholds in velocity do not look at eight bits."""
    return 256 if form.name in ("VCOOLTHRS", "VHIGH", "VDCMIN") else 1


@settings(max_examples=300)
@given(which=st.sampled_from(EVERY), part=st.floats(0, 1), clock_hz=clocks, microsteps=resolutions)
def test_numbers_there_and_back(which: tuple[str, str], part: float, clock_hz: float, microsteps: int) -> None:
    model, name = which
    form = formats(model, clock_hz, microsteps)[name]
    step = least_raw(form)
    top = TSTEP_MAX if form.rising else form.to_raw(form.highest)
    raw = max(round(part * top / step) * step, 1 if form.rising or name == "TPOWERDOWN" else 0)
    value = form.from_raw(raw)
    back = form.to_raw(value)
    assert back == raw or (name == "TPOWERDOWN" and raw == 1), "of a TMC5130 a single clock is nearly nothing"
    assert value <= form.highest * (1 + 1e-12)


@settings(max_examples=300)
@given(which=st.sampled_from(EVERY), part=st.floats(0, 1), clock_hz=clocks)
def test_the_nearest_is_within_half_a_step(which: tuple[str, str], part: float, clock_hz: float) -> None:
    model, name = which
    form = formats(model, clock_hz)[name]
    value = part * form.highest
    raw = form.to_raw(value)
    if form.rising is None:
        assert abs(form.from_raw(raw) - value) <= form.least * (0.5 + 1e-6) or raw == 1
    else:
        around = [form.from_raw(min(max(raw + step, 1), TSTEP_MAX)) for step in (-1, 1)]
        assert min(around) <= max(value, form.least) <= max(around), "between the numbers beside it"
        assert form.rising(raw) > form.from_raw(raw)


@pytest.mark.parametrize(("model", "name"), EVERY)
def test_more_than_a_register_holds_is_refused(model: str, name: str) -> None:
    form = formats(model)[name]
    with pytest.raises(ValueError, match=r" 0 to |up to"):
        form.to_raw(form.highest * 1.01 + form.least)
    with pytest.raises(ValueError, match=r"\b0 to |below 0|up to"):
        form.to_raw(-1.0)
    with pytest.raises(ValueError, match=r"\b0 to "):
        form.from_raw(1 << 24)


def test_another_chip_has_none() -> None:
    with pytest.raises(ValueError, match="model is one of"):
        formats("tmc4361")
