"""The measured path of a line: samples with their own times, gaps, and how far off the line that was."""

from __future__ import annotations

import pytest

from app.procedures.line_path import LegMotion, LegPath

LONG = LegMotion("a", 0, 1000, 4000, 2000.0, lambda t: 2000 * t)
SHORT = LegMotion("b", 0, 0, -1000, 500.0, lambda t: -500 * t)
RESTS = LegMotion("c", 0, 7, 0, 0.0, lambda t: 0 * t)


def test_off_the_line_is_by_the_way_that_the_longest_has_gone_at_that_very_time() -> None:
    leg = LegPath([SHORT, LONG, RESTS], 100)
    for time_s in (0.5, 1.0, 1.5, 2.0):
        leg.add(1, time_s, 0.0, round(1000 + 2000 * time_s))
    for time_s, late in ((0.25, 0), (0.75, 0), (1.25, 30), (1.75, 0), (2.0, 0)):
        leg.add(0, time_s, 0.0, round(-500 * time_s) + late)
    short, long = leg.paths()
    assert (short.device, long.device) == ("b", "a"), "one that rests has no path"
    assert short.off_line == pytest.approx(30, abs=1)
    assert short.uncertainty == 0.0
    assert (long.off_line, long.uncertainty) == (0.0, 0.0)
    assert short.time_s == (0.25, 0.75, 1.25, 1.75, 2.0)


def test_times_that_are_not_sure_make_the_figure_unsure() -> None:
    leg = LegPath([SHORT, LONG], 100)
    leg.add(0, 1.0, 0.002, -500)
    leg.add(1, 1.0, 0.004, 3000)
    short, _ = leg.paths()
    assert short.off_line == pytest.approx(0)
    assert short.uncertainty == pytest.approx(500 * 0.006)


def test_between_two_samples_it_is_as_planned() -> None:
    """Both speed up all the time: a straight line between samples 1 s apart would be off by 250 of 4000."""
    curved = [
        LegMotion("a", 0, 0, 4000, 4000.0, lambda t: 1000 * t**2),
        LegMotion("b", 0, 0, 2000, 2000.0, lambda t: 500 * t**2),
    ]
    leg = LegPath(curved, 100)
    for time_s in (1.0, 2.0):
        leg.add(0, time_s, 0.0, round(1000 * time_s**2))
    for time_s in (0.5, 1.5):
        leg.add(1, time_s, 0.0, round(500 * time_s**2))
    _, short = leg.paths()
    assert short.off_line == pytest.approx(0)
    assert short.uncertainty == pytest.approx(0)
    leg.add(0, 3.0, 0.0, 9000 - 40)
    _, short = leg.paths()
    assert short.uncertainty == pytest.approx(40 / 2 / 2)


def test_a_lost_reading_is_a_gap_and_judges_nothing() -> None:
    leg = LegPath([SHORT, LONG], 100)
    for time_s, position in ((0.5, 2000), (1.0, None), (1.5, 4000), (2.0, 5000)):
        leg.add(1, time_s, 0.0, position)
    leg.add(0, 0.9, 0.0, 500)  # far off, but nobody knows where the other one was
    leg.add(0, 1.0, 0.0, None)
    leg.add(0, 1.75, 0.0, -875)
    short, long = leg.paths()
    assert short.position == (500, None, -875)
    assert long.position == (2000, None, 4000, 5000)
    assert short.off_line == pytest.approx(0)


def test_nothing_seen_is_no_figure() -> None:
    leg = LegPath([SHORT, LONG], 100)
    assert [axis.off_line for axis in leg.paths()] == [None, None]


def test_a_long_leg_keeps_so_many_samples_and_its_whole_length() -> None:
    leg = LegPath([LONG], 100)
    for number in range(10_000):
        leg.add(0, number * 0.01, 0.0, 1000 + number)
    (path,) = leg.paths()
    assert 50 <= len(path.time_s) <= 100
    assert path.time_s[0] < 2.0
    assert path.time_s[-1] > 97.0
    gaps = [after - before for before, after in zip(path.time_s, path.time_s[1:], strict=False)]
    assert max(gaps) == pytest.approx(min(gaps), rel=0.01)
