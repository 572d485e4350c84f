"""Axes that turn for ever, against exact fractions; the note's OFFSET against the extended position."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from app.calc.positions.extended import Counter
from app.calc.positions.rotary import Rotary, Way
from tests.calc.turn_offset import MissedWrap, TurnOffset

turns = st.builds(Fraction, st.integers(1, 1 << 30), st.integers(1, 1000))
positions = st.integers(-(1 << 60), 1 << 60)


@given(turns, positions, st.integers(-1000, 1000))
def test_turns_and_place_are_the_position(turn: Fraction, position: int, zero: int) -> None:
    whole, place = Rotary(turn, zero).split(position)
    assert whole * turn + place == position - zero
    assert 0 <= place < turn
    assert 0 <= Rotary(turn, zero).angle_deg(position) <= 360


def test_a_gear_is_an_exact_fraction() -> None:
    rotary = Rotary.geared(51_200, 3, 7)
    assert rotary.microsteps_per_turn == Fraction(358_400, 3)
    assert rotary.split(358_400) == (3, Fraction(0))
    assert rotary.angle_deg(358_400 // 4) == pytest.approx(270)
    assert rotary.place_at(Fraction(-90)) == Fraction(268_800, 3)
    # A year at one turn a second, and not a microstep beside it.
    year = 365 * 86_400
    assert rotary.split(year * 358_400 // 3) == (year, Fraction(0))


@given(turns, positions, st.integers(0, 359_999), st.sampled_from(["shortest", "positive", "negative"]))
def test_the_way_to_an_angle(turn: Fraction, position: int, millidegrees: int, way: Way) -> None:
    assume(turn > 4)
    rotary = Rotary(turn)
    place = rotary.place_at(Fraction(millidegrees, 1000))
    target = rotary.target(position, place, way)
    beside = (Fraction(target) - place) % turn
    assert min(beside, turn - beside) <= Fraction(1, 2)  # microsteps are whole
    if way == "shortest":
        assert abs(target - position) <= turn / 2 + 1
    elif way == "positive":
        assert 0 <= target - position < turn + 1
    else:
        assert 0 <= position - target < turn + 1
    assert rotary.target(target, place, way) == target


def test_of_two_shortest_ways_the_positive_one() -> None:
    assert Rotary(Fraction(100)).target(0, 50) == 50
    assert Rotary(Fraction(100)).target(100, 50) == 150
    assert Rotary(Fraction(100)).target(0, 51) == -49


@pytest.mark.sheet("AN-001", "3.2")
@given(turns, st.sampled_from([Counter(8), Counter(24), Counter(32)]), st.data())
def test_the_offset_follows_as_the_whole_position_would(turn: Fraction, counter: Counter, data: st.DataObject) -> None:
    """Any two neighbouring bits, both directions, many overflows."""
    low_bit = data.draw(st.integers(2, counter.bits - 2))
    position = data.draw(st.integers(0, (1 << (low_bit + 2)) - 1))
    offset = TurnOffset(turn, counter, position, low_bit)
    assert offset.displacement_const == Fraction(1 << (low_bit + 2)) % turn
    step = 1 << low_bit
    for _ in range(data.draw(st.integers(0, 40))):
        position += data.draw(st.integers(-step, step))
        assert offset.update(counter.shows(position)) == Fraction(position) % turn


@pytest.mark.sheet("AN-001", "3.1")
def test_the_bicycles_valve() -> None:
    """A lane of 256 microsteps and a wheel of 100: each round the valve comes round 56 further."""
    offset = TurnOffset(Fraction(100), Counter(8), 0)
    assert offset.displacement_const == 56
    places = [offset.update(Counter(8).shows(position)) for position in range(0, 600, 50)]
    assert places == [position % 100 for position in range(0, 600, 50)]
    assert offset.offset == 2 * 56 % 100


@given(st.integers(0, 3), st.integers(0, 63), st.integers(0, 63))
def test_a_look_that_came_too_late_is_told(quarter: int, before: int, now: int) -> None:
    offset = TurnOffset(Fraction(100), Counter(8), 64 * quarter + before)
    kept = offset.offset
    with pytest.raises(MissedWrap, match="looked at too late"):
        offset.update(64 * (quarter + 2) + now)
    assert offset.offset == kept


def test_what_cannot_be_is_refused() -> None:
    for turn in (Fraction(0), Fraction(-1), Fraction(1 << 41)):
        with pytest.raises(ValueError, match="a turn is"):
            Rotary(turn)
    with pytest.raises(ValueError, match="teeth"):
        Rotary.geared(51_200, 0, 1)
    with pytest.raises(ValueError, match="lower bit"):
        TurnOffset(Fraction(1), Counter(8), 0, 7)
    with pytest.raises(ValueError, match="a turn is above 0"):
        TurnOffset(Fraction(0), Counter(8), 0)
