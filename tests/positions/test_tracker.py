"""Following a counter, against exact integers: whoever looks, in whatever order, and whatever was missed."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.positions.extended import LIMIT, Counter
from app.devices.core.counter import CounterReading
from app.positions.tracker import CLOCK_TOLERANCE, SLACK_S, Tracker

SPEED_PPS = 1000.0
counters = st.sampled_from([Counter(16), Counter(24), Counter(32)])


def allowed_s(counter: Counter) -> float:
    return counter.allowed_s(SPEED_PPS * CLOCK_TOLERANCE)


def look(count: int, at_s: float, *, reset: bool | None = False) -> CounterReading:
    return CounterReading(count, at_s, reset)


@pytest.mark.sheet("AN-001", "2.1")
@given(counters, st.data())
def test_random_walks_over_many_wraps_are_exact_or_told(counter: Counter, data: st.DataObject) -> None:
    """Own looks and others', some heard of late or out of order, some too late: never wrong while trusted."""
    true = start = data.draw(st.integers(-(1 << 40), 1 << 40))
    tracker = Tracker(counter, counter.shows(true), 0.0, start)
    now_s, told = 0.0, False
    earlier: list[tuple[int, float]] = []
    for _ in range(data.draw(st.integers(1, 25))):
        elapsed_s = data.draw(st.floats(0.01, 1.5)) * allowed_s(counter)
        reach = int(SPEED_PPS * elapsed_s)
        true += data.draw(st.integers(-reach, reach))
        now_s += elapsed_s
        told = told or now_s - tracker.asked_s > allowed_s(counter)
        if earlier:
            before = earlier[data.draw(st.integers(0, len(earlier) - 1))]  # a block of samples that comes late
            tracker.seen(*before, now_s, SPEED_PPS)
        if data.draw(st.booleans()):
            tracker.seen(counter.shows(true), now_s, now_s, SPEED_PPS)
        else:
            tracker.returned(look(counter.shows(true), now_s), now_s, SPEED_PPS)
        earlier.append((counter.shows(true), now_s))
        assert tracker.trusted == (not told)
        if tracker.trusted:
            assert tracker.position == true
        assert counter.shows(tracker.extended) == counter.shows(true)


@given(counters, st.integers(-(1 << 62), 1 << 62), st.integers(-1000, 1000))
def test_whoever_says_where_it_is_is_believed(counter: Counter, position: int, way: int) -> None:
    tracker = Tracker(counter, 5, 0.0, 5)
    tracker.returned(look(6, 10 * allowed_s(counter)), 10 * allowed_s(counter), SPEED_PPS)
    assert not tracker.trusted
    tracker.set_actual(position)
    assert (tracker.trusted, tracker.position) == (True, position)
    tracker.seen(counter.shows(6 + way), 11 * allowed_s(counter), 10 * allowed_s(counter) + 2, SPEED_PPS)
    assert tracker.position == position + way
    with pytest.raises(ValueError, match="microsteps, not"):
        tracker.set_actual(LIMIT)


@given(counters, st.floats(1.01, 50))
def test_a_look_that_came_too_late_is_told_with_its_reason_and_the_way_out(counter: Counter, late: float) -> None:
    tracker = Tracker(counter, 0, 0.0, 100)
    at_s = late * allowed_s(counter)
    tracker.returned(look(7, at_s), at_s, SPEED_PPS)
    assert tracker.lost is not None
    assert "looked at too late" in tracker.lost.reason
    assert '{"actual": n}' in tracker.lost.way_out
    assert tracker.position == 107  # the shorter way: a guess, and called one
    tracker.returned(look(9, at_s + 1), at_s + 1, SPEED_PPS)
    assert (tracker.trusted, tracker.position) == (False, 109)
    tracker.confirm()
    assert (tracker.trusted, tracker.position) == (True, 109)


def test_lateness_counts_from_when_a_look_was_asked_to_when_its_answer_was_there() -> None:
    counter = Counter(16)
    tracker = Tracker(counter, 0, 0.0, 0)
    half_s = 0.6 * allowed_s(counter)
    tracker.seen(1, half_s, half_s, SPEED_PPS)
    tracker.seen(2, half_s + 1, 2 * half_s, SPEED_PPS)  # asked at once, answered long after
    assert tracker.trusted
    # Since the answer only half of what is allowed has gone by; but the counter may have been read when it was asked.
    tracker.seen(3, 2 * half_s + 1, half_s + 1 + 1.01 * allowed_s(counter), SPEED_PPS)
    assert not tracker.trusted


def test_a_clock_that_is_set_back_between_question_and_answer_fails_nothing() -> None:
    """As that of an emulator, which stands still where more is to be worked out than its machine can in time."""
    tracker = Tracker(Counter(24), 0, 0.0, 0)
    tracker.seen(0, 1.0, 1.001, SPEED_PPS)
    tracker.seen(5, 1.002, 0.994, SPEED_PPS)
    assert (tracker.position, tracker.trusted) == (5, True)


def test_a_jump_that_no_motor_makes_is_told_and_the_place_stays() -> None:
    tracker = Tracker(Counter(32), 100_000, 0.0, 100_000)
    tracker.seen(0, 1.0, 1.0, SPEED_PPS)
    assert tracker.lost is not None
    assert "faster than the chip can" in tracker.lost.reason
    assert tracker.position == 100_000
    tracker.seen(50, 2.0, 2.0, SPEED_PPS)
    assert tracker.position == 100_050


@given(st.floats(0.001, 10))
def test_full_speed_is_no_jump(elapsed_s: float) -> None:
    tracker = Tracker(Counter(32), 0, 0.0, 0)
    tracker.seen(int(SPEED_PPS * (elapsed_s + SLACK_S)), elapsed_s, elapsed_s, SPEED_PPS)
    assert tracker.trusted


def test_a_reset_is_told_and_the_place_stays() -> None:
    tracker = Tracker(Counter(32), 500, 0.0, 500)
    tracker.returned(look(0, 1.0, reset=True), 1.0, SPEED_PPS)
    assert tracker.lost is not None
    assert "the chip was reset" in tracker.lost.reason
    assert (tracker.position, tracker.count) == (500, 0)
    tracker.returned(look(20, 2.0), 2.0, SPEED_PPS)
    assert (tracker.position, tracker.trusted) == (520, False)


@pytest.mark.parametrize(("reset", "trusted"), [(False, True), (True, False), (None, False)])
def test_after_a_lost_link_it_is_trusted_where_the_chip_can_say_that_nothing_was_missed(
    reset: bool | None, trusted: bool
) -> None:
    tracker = Tracker(Counter(32), 0, 0.0, 0)
    tracker.lost_sight("the link failed: a cable", "connect it")
    assert not tracker.trusted
    tracker.seen(300, 1.0, 1.0, SPEED_PPS)
    assert tracker.position == 0  # others' looks do not tell of resets
    tracker.returned(look(300, 1.0, reset=reset), 1.0, SPEED_PPS)
    assert tracker.trusted == trusted
    assert tracker.position == (0 if reset else 300)
    if reset is None:
        assert tracker.lost is not None
        assert "the link failed: a cable" in tracker.lost.reason


def test_who_writes_the_counter_makes_the_position_a_guess_that_keeps_the_place() -> None:
    tracker = Tracker(Counter(32), 70, 0.0, 1070)
    tracker.counter_written("XACTUAL")
    tracker.seen(0, 1.0, 1.0, SPEED_PPS)
    assert tracker.count == 70  # it may be from before the write
    tracker.returned(look(0, 1.1), 1.1, SPEED_PPS)
    assert tracker.lost is not None
    assert "XACTUAL" in tracker.lost.reason
    assert tracker.position == 1070
    tracker.confirm()
    tracker.seen(5, 2.0, 2.0, SPEED_PPS)
    assert (tracker.trusted, tracker.position) == (True, 1075)


def test_the_first_loss_is_the_one_that_is_told() -> None:
    tracker = Tracker(Counter(32), 0, 0.0, 0)
    tracker.counter_written("XACTUAL")
    tracker.returned(look(0, 1.0, reset=True), 1.0, SPEED_PPS)
    assert tracker.lost is not None
    assert "XACTUAL" in tracker.lost.reason


def test_leaving_64_bits_is_told() -> None:
    tracker = Tracker(Counter(32), 0, 0.0, LIMIT - 1)
    assert tracker.trusted
    tracker.seen(1, 1.0, 1.0, SPEED_PPS)
    assert tracker.lost is not None
    assert "64 bits" in tracker.lost.reason
