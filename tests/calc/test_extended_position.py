"""Extended positions, against exact integers: over many wraps, both ways, with looks that come too late."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.positions.extended import LIMIT, Counter, ExtendedPosition, TooLate, compare_count, next_target, pieces

counters = st.sampled_from([Counter(bits) for bits in (4, 24, 32)])


@pytest.mark.sheet("AN-001", "2")
def test_how_far_a_counter_reaches() -> None:
    """(2^31) - 1 steps: 8,388,608 full steps of 256, 41,943 turns of 200 full steps, 11.6 hours at one a second."""
    longest = Counter(32).half - 1
    assert longest == 2_147_483_647
    assert round(longest / 256) == 8_388_608
    assert longest // (200 * 256) == 41_943
    assert Counter(32).allowed_s(200 * 256) / 3600 == pytest.approx(11.65, abs=0.01)


@given(counters, st.integers(-(1 << 40), 1 << 40))
def test_a_counter_shows_the_lowest_bits(counter: Counter, position: int) -> None:
    shown = counter.shows(position)
    assert -counter.half <= shown < counter.half
    assert (shown - position) % counter.modulus == 0
    assert counter.shows(shown) == shown


@pytest.mark.sheet("AN-001", "2.1")
@given(counters, st.data())
def test_random_walks_over_many_wraps_are_followed_exactly(counter: Counter, data: st.DataObject) -> None:
    true = data.draw(st.integers(-(1 << 50), 1 << 50))
    axis = ExtendedPosition(counter, counter.shows(true), 0.0, true)
    speed_pps = 1000.0
    for _ in range(data.draw(st.integers(0, 30))):
        elapsed_s = data.draw(st.floats(0, 0.999 * counter.allowed_s(speed_pps)))  # sums of times are rounded
        reach = math.floor(elapsed_s * speed_pps)
        reach = min(reach, counter.half - 1)
        true += data.draw(st.integers(-reach, reach))
        assert axis.update(counter.shows(true), axis.time_s + elapsed_s, speed_pps) == true
        assert axis.position == true


@given(counters, st.integers(0, 5), st.floats(1.001, 100))
def test_a_look_that_came_too_late_is_told_and_never_guessed(counter: Counter, count: int, late: float) -> None:
    axis = ExtendedPosition(counter, 0, 0.0)
    with pytest.raises(TooLate, match="set the position anew") as caught:
        axis.update(count, late * counter.allowed_s(500.0), 500.0)
    assert caught.value.allowed_s == counter.allowed_s(500.0)
    with pytest.raises(TooLate):  # later looks do not make it known again
        axis.update(count, 1e9, 0.0)
    with pytest.raises(TooLate):
        axis.latched(count)
    with pytest.raises(TooLate):
        _ = axis.position
    axis.set(count, count, 1e9)
    assert axis.position == count


def test_at_rest_it_may_go_unlooked_at_for_ever() -> None:
    axis = ExtendedPosition(Counter(24), -5, 0.0)
    assert axis.update(-5, 1e12, 0.0) == -5
    assert Counter(24).service_period_s(0) == math.inf
    assert Counter(24).service_period_s(1000.0) == pytest.approx(((1 << 23) - 1) / 4000)


@pytest.mark.sheet("AN-001", "2.1")
@given(counters, st.data())
def test_moves_are_made_in_pieces_and_end_at_the_target(counter: Counter, data: st.DataObject) -> None:
    """A chip that goes the shorter way to X_TARGET, looked at whenever it likes, ends at the 64-bit target."""
    true = data.draw(st.integers(-20 * counter.modulus, 20 * counter.modulus))
    target = true + data.draw(st.integers(-20 * counter.modulus, 20 * counter.modulus))
    looks = pieces(counter, target, true)
    for look in range(2 * looks + 1):
        register = next_target(counter, target, true)
        way = counter.way(register, counter.shows(true))
        assert abs(way) <= counter.piece
        assert abs(target - true) <= counter.piece or abs(way) == counter.piece
        assert (way >= 0) == (target >= true)
        # Half of each piece before the next look, all of it towards the end.
        true += way if look >= looks else -(-way // 2)
    for _ in range(2 * looks + 1):
        true += counter.way(next_target(counter, target, true), counter.shows(true))
    assert true == target
    assert pieces(counter, target, true) == 0


@pytest.mark.sheet("AN-001", "2.1")
@given(counters, st.data())
def test_a_snapshot_belongs_to_where_the_axis_was_then(counter: Counter, data: st.DataObject) -> None:
    """Also where the counter wrapped between the snapshot and the look."""
    then = data.draw(st.integers(-(1 << 45), 1 << 45))
    now = then + data.draw(st.integers(-(counter.half - 1), counter.half - 1))
    axis = ExtendedPosition(counter, counter.shows(now), 0.0, now)
    assert axis.latched(counter.shows(then)) == then


@pytest.mark.sheet("AN-001", "2.1")
@given(counters, st.integers(-(1 << 45), 1 << 45), st.integers(-(1 << 34), 1 << 34))
def test_the_position_compare_is_off_while_it_would_come_early(counter: Counter, actual: int, ahead: int) -> None:
    armed = compare_count(counter, actual + ahead, actual)
    assert (armed is None) == (abs(ahead) > counter.piece)
    if armed is not None:
        # Nowhere on the way there does the counter show it before.
        assert counter.way(armed, counter.shows(actual)) == ahead


def test_what_cannot_be_is_refused() -> None:
    axis = ExtendedPosition(Counter(24), 0, 5.0)
    with pytest.raises(ValueError, match="does not show 8388608"):
        axis.update(1 << 23, 6.0, 1.0)
    with pytest.raises(ValueError, match="time went back by 1 s"):
        axis.update(0, 4.0, 1.0)
    with pytest.raises(ValueError, match="the counter shows 1, not 0"):
        axis.set((1 << 24) + 1, 0, 5.0)
    with pytest.raises(ValueError, match="microsteps, not"):
        ExtendedPosition(Counter(32), 0, 0.0, LIMIT)
    with pytest.raises(ValueError, match="microsteps, not"):
        next_target(Counter(32), LIMIT, 0)
    with pytest.raises(ValueError, match=r"2\.\.63 bits"):
        Counter(1)
    end = ExtendedPosition(Counter(32), -1, 0.0, LIMIT - 1)
    with pytest.raises(ValueError, match="microsteps, not"):
        end.update(0, 1.0, 10.0)
    assert end.position == LIMIT - 1
