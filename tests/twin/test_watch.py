"""Lost steps, and what was seen of a stage."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.twin.shape import Shape, Slips
from app.twin.watch import SlipWatch, TravelWatch, Watches

STAGE = Shape("bench", 0, "X", microsteps=16, travel_mm_per_rev=8.0)
TURN = 4 * 16
"""Microsteps of an electrical turn."""


def fed(watch: SlipWatch, *deviations: float) -> Slips:
    watch.feed(np.arange(len(deviations), dtype=np.float64), np.array(deviations), 16)
    return watch.slips


def test_a_rotor_that_swings_has_not_slipped() -> None:
    assert fed(SlipWatch(), 0, 0.45 * TURN, -0.55 * TURN, 0.5 * TURN, 0) == Slips()


def test_a_rotor_a_turn_behind_has_lost_four_full_steps() -> None:
    assert fed(SlipWatch(), 0, -0.4 * TURN, -0.9 * TURN, -TURN) == Slips(4, 1, 2.0)


def test_there_and_back_is_two_slips_and_nothing_lost() -> None:
    assert fed(SlipWatch(), 0, TURN, 0) == Slips(0, 2, 2.0)


def test_what_was_there_at_the_first_look_is_no_slip() -> None:
    assert fed(SlipWatch(), 7 * TURN, 7.2 * TURN) == Slips()


def test_a_counter_that_is_set_anew_is_no_slip() -> None:
    watch = SlipWatch()
    fed(watch, 0, -TURN)
    watch.restart()
    assert fed(watch, 1000 * TURN).lost_full_steps == 4


def test_missing_samples_and_an_unknown_resolution_tell_nothing() -> None:
    assert fed(SlipWatch(), 0, np.nan, np.nan) == Slips()
    watch = SlipWatch()
    assert watch.feed(np.zeros(2), np.array([0.0, 1e6]), None) == []


@given(st.lists(st.integers(-5, 5), min_size=1, max_size=40), st.integers(1, 7))
def test_rests_are_counted_however_the_samples_come(rests: list[int], at_once: int) -> None:
    watch, rows = SlipWatch(), np.array([0, *rests], dtype=np.float64)
    for first in range(0, len(rows), at_once):
        part = rows[first : first + at_once]
        watch.feed(np.arange(len(part), dtype=np.float64), part * float(TURN), 16)
    assert watch.slips.lost_full_steps == -4 * rests[-1]
    assert watch.slips.events == np.abs(np.diff(rows)).sum()


def test_a_switch_is_between_the_samples_that_saw_it_change() -> None:
    watch = TravelWatch()
    low = np.zeros(4)
    watch.feed(np.array([0.0, 10.0, 20.0, 30.0]), {"left": low, "right": np.array([0, 0, 1, 1.0])})
    watch.feed(np.array([29.0, 0.0, -20.0, -22.0]), {"left": np.array([0, 0, 0, 1.0]), "right": low})
    travel = watch.travel(STAGE)
    assert travel is not None
    assert (travel.left_mm, travel.right_mm, travel.home_mm) == (-21.0, 29.5, None)


def test_the_drawn_stretch_is_whole_and_holds_all_that_was_seen() -> None:
    watch = TravelWatch()
    watch.feed(np.array([-3.0, 55.0]), {})
    travel = watch.travel(STAGE)
    assert travel is not None
    assert travel.from_mm <= -3.0 < 55.0 <= travel.to_mm
    assert travel.from_mm % 40.0 == travel.to_mm % 40.0 == 0.0


def test_soft_limits_belong_to_the_stretch() -> None:
    limited = Shape("bench", 0, "X", microsteps=16, travel_mm_per_rev=8.0, limits=(-40_000.0, 60_000.0))
    travel = TravelWatch().travel(limited)
    assert travel is not None
    assert travel.from_mm <= -100.0
    assert travel.to_mm >= 150.0


def test_a_table_has_no_stretch() -> None:
    assert TravelWatch().travel(Shape("pair", 0, "turn", microsteps=256)) is None


def test_watches_take_the_encoder_for_the_place_where_there_is_one() -> None:
    watches = Watches()
    columns = {"position": np.array([0.0, 0.0]), "encoder_position": np.array([0.0, 400_000.0])}
    watches.feed(STAGE, np.array([0.0, 1.0]), columns)
    travel = watches.travel(STAGE)
    assert travel is not None
    assert travel.to_mm >= 1000.0
