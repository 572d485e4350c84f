"""Plots and tables of reports."""

from __future__ import annotations

import random

import pytest

from app.html_report import EDGE, WIDTH, PlotAxis, frame, page, table


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


def test_a_report_fits_a_phone_and_its_tables_scroll() -> None:
    axis = PlotAxis([0, 1], 0, 1)
    whole = page("A <report>", [table(("a", "b"), [("1", "<2>")]), frame(axis, axis, "x", "y", "")])
    assert '<meta name="viewport" content="width=device-width">' in whole
    assert "<title>A &lt;report&gt;</title>" in whole
    assert '<div class="wide"><table>' in whole
    assert "&lt;2&gt;" in whole
