"""Spectra against sines that are known, and against Parseval."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.calc.signals.alignment import REACH, usual_interval_s
from app.calc.signals.spectrum import WINDOWS, Detrend, Window, longest_part, spectrum

RATE_HZ = 1000.0
ALL_WINDOWS: tuple[Window, ...] = ("hann", "flattop", "blackman", "none")


def times(samples: int) -> np.ndarray:
    return 12.5 + np.arange(samples) / RATE_HZ


@pytest.mark.parametrize("window", ALL_WINDOWS)
@pytest.mark.parametrize("samples", [1000, 1001])
def test_a_sine_shows_with_its_amplitude_at_its_frequency(window: Window, samples: int) -> None:
    line_hz = RATE_HZ / samples
    for line in (50, 120):
        wave = 3.5 * np.sin(2 * np.pi * line * line_hz * times(samples) + 0.7)
        found = spectrum(times(samples), wave + 100.0, window=window, detrend="mean")
        at = int(found.amplitude.argmax())
        assert found.frequency_hz[at] == pytest.approx(line * line_hz)
        assert found.amplitude[at] == pytest.approx(3.5, rel=1e-9)
        assert found.line_hz == pytest.approx(line_hz)
        assert not found.resampled


def test_between_two_lines_the_flat_top_still_tells_the_amplitude() -> None:
    for offset in (0.0, 0.25, 0.5):
        wave = 2.0 * np.sin(2 * np.pi * (100 + offset) * times(1000))
        assert spectrum(times(1000), wave, window="flattop").amplitude.max() == pytest.approx(2.0, rel=2e-3)


@given(arrays(np.float64, st.integers(8, 300), elements=st.floats(-1e3, 1e3, width=32)))
def test_parseval(values: np.ndarray) -> None:
    found = spectrum(times(len(values)), values, window="none", detrend="none")
    assert found.density.sum() * found.line_hz == pytest.approx(np.mean(values**2), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("window", ALL_WINDOWS)
def test_noise_has_its_power_under_every_window(window: Window) -> None:
    noise = np.random.default_rng(4).normal(0, 0.5, 1 << 16)
    found = spectrum(times(len(noise)), noise, window=window, detrend="mean")
    assert found.density.sum() * found.line_hz == pytest.approx(0.25, rel=0.03)
    # of an amplitude spectrum the same power is found through the bandwidth of the window
    lines = found.amplitude[1:-1] ** 2 / 2
    assert lines.sum() * found.line_hz / found.resolution_hz == pytest.approx(0.25, rel=0.03)


@pytest.mark.parametrize(("detrend", "left"), [("none", True), ("mean", True), ("line", False)])
def test_a_ramp_is_taken_off(detrend: Detrend, left: bool) -> None:
    found = spectrum(times(500), 40 * times(500), detrend=detrend, window="none")
    assert bool(found.amplitude.max() > 1e-6) is left


def test_uneven_times_are_told_and_the_sine_is_found_all_the_same() -> None:
    noise = np.random.default_rng(1)
    time_s = times(2000) + noise.uniform(-0.3, 0.3, 2000) / RATE_HZ
    found = spectrum(time_s, 5 * np.sin(2 * np.pi * 20 * time_s))
    assert found.resampled
    at = int(found.amplitude.argmax())
    assert found.frequency_hz[at] == pytest.approx(20, abs=found.line_hz)
    assert found.amplitude[at] == pytest.approx(5, rel=0.02)


def test_of_gaps_the_longest_part_between_is_analysed() -> None:
    time_s, values = times(100), np.sin(np.arange(100.0))
    values[40] = np.nan
    assert longest_part(time_s, values) == (41, 100)
    time_s = time_s + np.where(np.arange(100) >= 80, 0.1, 0.0)
    assert longest_part(time_s, values) == (0, 40)
    found = spectrum(time_s, values)
    assert (found.samples, found.from_s, found.to_s) == (40, time_s[0], time_s[39])


@given(st.lists(st.tuples(st.sampled_from([0.0, np.nan]), st.booleans()), min_size=3, max_size=60))
def test_holes_in_the_times_part_it_too(rows: list[tuple[float, bool]]) -> None:
    """A hole is before a row; a part may begin there like behind a missing sample."""
    holes = [hole and index > 2 and not rows[index - 1][1] for index, (_, hole) in enumerate(rows)]
    time_s = np.cumsum([0.0, 1.0, 1.0, *(100.0 if hole else 1.0 for hole in holes[3:])])
    values = np.array([value for value, _ in rows])
    first, last = longest_part(time_s, values)
    cut = np.flatnonzero(np.diff(time_s) > REACH * usual_interval_s(time_s)) + 1
    runs = ["".join("x" if value == 0 else " " for value in part).split() for part in np.split(values, cut)]
    assert last - first == max((len(run) for part in runs for run in part), default=0)
    assert not np.isnan(values[first:last]).any()


def test_the_longest_part_may_be_behind_a_hole() -> None:
    time_s = np.concatenate((np.arange(10.0), 15 + np.arange(100.0)))
    assert longest_part(time_s, np.zeros(110)) == (10, 110)


@given(st.lists(st.sampled_from([0.0, np.nan]), max_size=60))
def test_the_longest_part_is_the_longest(values: list[float]) -> None:
    first, last = longest_part(np.arange(float(len(values))), np.array(values))
    runs = "".join("x" if value == 0 else " " for value in values).split()
    assert last - first == max(map(len, runs), default=0)
    assert not np.isnan(values[first:last]).any()


@pytest.mark.parametrize("values", [np.zeros(7), np.full(50, np.nan)])
def test_too_few_samples(values: np.ndarray) -> None:
    with pytest.raises(ValueError, match="8 samples"):
        spectrum(times(len(values)), values)


def test_unknown_windows() -> None:
    with pytest.raises(ValueError, match="kaiser"):
        spectrum(times(100), np.zeros(100), window="kaiser")  # type: ignore[arg-type]
    assert set(ALL_WINDOWS) == set(WINDOWS)
