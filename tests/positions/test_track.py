"""Following a counter, against exact integers: whoever looks, in whatever order, and whatever was missed."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.positions.extended import LIMIT, Counter
from app.devices.core.counter import CounterLook
from app.positions.tracker import CLOCK_TOLERANCE, SLACK_S, Track

SPEED_PPS = 1000.0
counters = st.sampled_from([Counter(16), Counter(24), Counter(32)])


def allowed_s(counter: Counter) -> float:
    return counter.allowed_s(SPEED_PPS * CLOCK_TOLERANCE)


def look(count: int, at_s: float, *, reset: bool | None = False) -> CounterLook:
    return CounterLook(count, at_s, reset)


@pytest.mark.sheet("AN-001", "2.1")
@given(counters, st.data())
def test_random_walks_over_many_wraps_are_exact_or_told(counter: Counter, data: st.DataObject) -> None:
    """Own looks and others', some heard of late or out of order, some too late: never wrong while trusted."""
    true = start = data.draw(st.integers(-(1 << 40), 1 << 40))
    track = Track(counter, counter.shows(true), 0.0, start)
    now_s, told = 0.0, False
    earlier: list[tuple[int, float]] = []
    for _ in range(data.draw(st.integers(1, 25))):
        elapsed_s = data.draw(st.floats(0.01, 1.5)) * allowed_s(counter)
        reach = int(SPEED_PPS * elapsed_s)
        true += data.draw(st.integers(-reach, reach))
        now_s += elapsed_s
        told = told or now_s - track.asked_s > allowed_s(counter)
        if earlier:
            before = earlier[data.draw(st.integers(0, len(earlier) - 1))]  # a block of samples that comes late
            track.seen(*before, now_s, SPEED_PPS)
        if data.draw(st.booleans()):
            track.seen(counter.shows(true), now_s, now_s, SPEED_PPS)
        else:
            track.returned(look(counter.shows(true), now_s), now_s, SPEED_PPS)
        earlier.append((counter.shows(true), now_s))
        assert track.trusted == (not told)
        if track.trusted:
            assert track.position == true
        assert counter.shows(track.followed) == counter.shows(true)


@given(counters, st.integers(-(1 << 62), 1 << 62), st.integers(-1000, 1000))
def test_whoever_says_where_it_is_is_believed(counter: Counter, position: int, way: int) -> None:
    track = Track(counter, 5, 0.0, 5)
    track.returned(look(6, 10 * allowed_s(counter)), 10 * allowed_s(counter), SPEED_PPS)
    assert not track.trusted
    track.set_actual(position)
    assert (track.trusted, track.position) == (True, position)
    track.seen(counter.shows(6 + way), 11 * allowed_s(counter), 10 * allowed_s(counter) + 2, SPEED_PPS)
    assert track.position == position + way
    with pytest.raises(ValueError, match="microsteps, not"):
        track.set_actual(LIMIT)


@given(counters, st.floats(1.01, 50))
def test_a_look_that_came_too_late_is_told_with_its_reason_and_the_way_out(counter: Counter, late: float) -> None:
    track = Track(counter, 0, 0.0, 100)
    at_s = late * allowed_s(counter)
    track.returned(look(7, at_s), at_s, SPEED_PPS)
    assert track.doubt is not None
    assert "looked at too late" in track.doubt.reason
    assert '{"actual": n}' in track.doubt.way_out
    assert track.position == 107  # the shorter way: a guess, and called one
    track.returned(look(9, at_s + 1), at_s + 1, SPEED_PPS)
    assert (track.trusted, track.position) == (False, 109)
    track.confirm()
    assert (track.trusted, track.position) == (True, 109)


def test_lateness_counts_from_when_a_look_was_asked_to_when_its_answer_was_there() -> None:
    counter = Counter(16)
    track = Track(counter, 0, 0.0, 0)
    half_s = 0.6 * allowed_s(counter)
    track.seen(1, half_s, half_s, SPEED_PPS)
    track.seen(2, half_s + 1, 2 * half_s, SPEED_PPS)  # asked at once, answered long after
    assert track.trusted
    # Since the answer only half of what is allowed has gone by; but the counter may have been read when it was asked.
    track.seen(3, 2 * half_s + 1, half_s + 1 + 1.01 * allowed_s(counter), SPEED_PPS)
    assert not track.trusted


def test_a_jump_that_no_motor_makes_is_told_and_the_place_stays() -> None:
    track = Track(Counter(32), 100_000, 0.0, 100_000)
    track.seen(0, 1.0, 1.0, SPEED_PPS)
    assert track.doubt is not None
    assert "faster than the chip can" in track.doubt.reason
    assert track.position == 100_000
    track.seen(50, 2.0, 2.0, SPEED_PPS)
    assert track.position == 100_050


@given(st.floats(0.001, 10))
def test_full_speed_is_no_jump(elapsed_s: float) -> None:
    track = Track(Counter(32), 0, 0.0, 0)
    track.seen(int(SPEED_PPS * (elapsed_s + SLACK_S)), elapsed_s, elapsed_s, SPEED_PPS)
    assert track.trusted


def test_a_reset_is_told_and_the_place_stays() -> None:
    track = Track(Counter(32), 500, 0.0, 500)
    track.returned(look(0, 1.0, reset=True), 1.0, SPEED_PPS)
    assert track.doubt is not None
    assert "the chip was reset" in track.doubt.reason
    assert (track.position, track.count) == (500, 0)
    track.returned(look(20, 2.0), 2.0, SPEED_PPS)
    assert (track.position, track.trusted) == (520, False)


@pytest.mark.parametrize(("reset", "trusted"), [(False, True), (True, False), (None, False)])
def test_after_a_lost_link_it_is_trusted_where_the_chip_can_say_that_nothing_was_missed(
    reset: bool | None, trusted: bool
) -> None:
    track = Track(Counter(32), 0, 0.0, 0)
    track.lost_sight("the link failed: a cable", "connect it")
    assert not track.trusted
    track.seen(300, 1.0, 1.0, SPEED_PPS)
    assert track.position == 0  # others' looks do not tell of resets
    track.returned(look(300, 1.0, reset=reset), 1.0, SPEED_PPS)
    assert track.trusted == trusted
    assert track.position == (0 if reset else 300)
    if reset is None:
        assert track.doubt is not None
        assert "the link failed: a cable" in track.doubt.reason


def test_who_writes_the_counter_makes_the_position_a_guess_that_keeps_the_place() -> None:
    track = Track(Counter(32), 70, 0.0, 1070)
    track.counter_written("XACTUAL")
    track.seen(0, 1.0, 1.0, SPEED_PPS)
    assert track.count == 70  # it may be from before the write
    track.returned(look(0, 1.1), 1.1, SPEED_PPS)
    assert track.doubt is not None
    assert "XACTUAL" in track.doubt.reason
    assert track.position == 1070
    track.confirm()
    track.seen(5, 2.0, 2.0, SPEED_PPS)
    assert (track.trusted, track.position) == (True, 1075)


def test_the_first_doubt_is_the_one_that_is_told() -> None:
    track = Track(Counter(32), 0, 0.0, 0)
    track.counter_written("XACTUAL")
    track.returned(look(0, 1.0, reset=True), 1.0, SPEED_PPS)
    assert track.doubt is not None
    assert "XACTUAL" in track.doubt.reason


def test_leaving_64_bits_is_told() -> None:
    track = Track(Counter(32), 0, 0.0, LIMIT - 1)
    assert track.trusted
    track.seen(1, 1.0, 1.0, SPEED_PPS)
    assert track.doubt is not None
    assert "64 bits" in track.doubt.reason
