"""Plots and tables of reports."""

from __future__ import annotations

import itertools
import random
import re

import pytest

from app.html_report import CHARACTER, EDGE, HEIGHT, LINE, WIDTH, PlotAxis, frame, page, table


@pytest.mark.parametrize(
    ("values", "ticks"),
    [
        ([0.0, 1.5], [0.0, 0.5, 1.0, 1.5]),
        ([16.0, 32.0], [20.0, 25.0, 30.0]),
        ([1.0, 10.0], [2.0, 4.0, 6.0, 8.0, 10.0]),
        ([-0.004, 0.0], [-0.004, -0.003, -0.002, -0.001, 0.0]),
    ],
)
def test_an_axis_is_marked_at_round_values(values: list[float], ticks: list[float]) -> None:
    assert PlotAxis(values, EDGE, WIDTH).ticks() == pytest.approx(ticks)


def test_each_axis_has_some_marks_and_all_are_on_it() -> None:
    rng = random.Random(1)
    for _ in range(500):
        log, least = rng.random() < 0.5, 10 ** rng.uniform(-6, 6)
        values = [least, least * (1 + 10 ** rng.uniform(-2, 4))]
        axis = PlotAxis(values, EDGE, WIDTH, log=log)
        ticks = axis.ticks()
        assert 2 <= len(ticks) <= 9, (values, log, ticks)
        assert all(EDGE - 0.01 <= axis.at(each) <= WIDTH + 0.01 for each in ticks)
    assert PlotAxis([3.0], EDGE, WIDTH).ticks()


def test_a_step_that_is_all_but_a_power_of_ten_is_one_too() -> None:
    assert PlotAxis([0.0, 267.85714285714283], EDGE, WIDTH).ticks() == pytest.approx(
        [0.0, 50.0, 100.0, 150.0, 200.0, 250.0]
    )


def test_no_mark_of_an_axis_lies_upon_another() -> None:
    """The values of a logarithm crowd at its upper end: 1000, 1500 and 2000 were one black spot."""
    x = PlotAxis([150_000.0, 880_000.0], EDGE, WIDTH - 10, log=True)
    y = PlotAxis([40.0, 2200.0], HEIGHT - EDGE, 10, log=True)
    drawn = frame(x, y, "speed", "frequency", "")
    beside = [float(at) for at in re.findall(rf'<text x="{EDGE - 6}" y="([^"]+)" text-anchor="end">\d', drawn)]
    assert len(beside) >= 2
    assert min(abs(one - other) for one, other in itertools.pairwise(beside)) >= LINE
    below = re.findall(rf'<text x="([^"]+)" y="{HEIGHT - EDGE + 18}" text-anchor="middle">(\d+)', drawn)
    assert len(below) >= 2
    for (one, _), (other, name) in itertools.pairwise(below):
        assert float(other) - float(one) >= CHARACTER * len(name)


def test_figures_of_a_table_stay_on_their_line() -> None:
    shown = table(("a", "b"), [("-0.208 to 0.886", "its ramp alone takes longer than the best so far")])
    assert "<td>-0.208" in shown
    assert "<td class=long>its ramp" in shown


def test_a_report_fits_a_phone_and_its_tables_scroll() -> None:
    axis = PlotAxis([0, 1], 0, 1)
    whole = page("A <report>", [table(("a", "b"), [("1", "<2>")]), frame(axis, axis, "x", "y", "")])
    assert '<meta name="viewport" content="width=device-width">' in whole
    assert "<title>A &lt;report&gt;</title>" in whole
    assert '<div class="wide"><table>' in whole
    assert "&lt;2&gt;" in whole
