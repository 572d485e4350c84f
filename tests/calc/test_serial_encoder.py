"""Serial encoders at a TMC4361: against the emulated chip, which reads them bit by bit."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.tmc4361.serial_encoder import Frame, Requests, timing


@pytest.mark.sheet("DS-TMC4361", "14.3")
@given(
    st.integers(1, 24),
    st.integers(0, 16),
    st.integers(0, 3),
    st.booleans(),
    st.booleans(),
    st.integers(0, 1 << 40),
)
def test_what_is_sent_is_read(single: int, multi: int, status: int, gray: bool, last: bool, place: int) -> None:
    frame = Frame(single, multi, status, gray, last)
    turns, angle, flags = place >> 24 & (1 << multi) - 1, place & (1 << single) - 1, place & (1 << status) - 1
    bits = frame.bits(turns, angle, flags)
    assert len(bits) == frame.length == len(frame.names)
    assert frame.place(bits) == (turns, angle, flags)


@pytest.mark.sheet("DS-TMC4361", "14.3")
def test_bits_of_one_answer_by_hand() -> None:
    # 3 turns of 2 bits, angle 5 of 4 bits: 11 0101; in Gray code 10 1111 (each bit with the one above it)
    assert Frame(4, 2).bits(3, 5) == (1, 1, 0, 1, 0, 1)
    assert Frame(4, 2, gray=True).bits(3, 5) == (1, 0, 1, 1, 1, 1)
    assert Frame(4, 0, 2).names == ("S1", "S0", "A3", "A2", "A1", "A0")
    assert Frame(4, 0, 2, status_last=True).names == ("A3", "A2", "A1", "A0", "S1", "S0")
    assert Frame(4, 0, 2).bits(0, 9, 1) == (0, 1, 1, 0, 0, 1)


@pytest.mark.sheet("DS-TMC4361", "14.3")
def test_gray_code_changes_one_bit_from_count_to_count() -> None:
    frame = Frame(6, 2, gray=True)
    answers = [frame.bits(place >> 6, place & 63) for place in range(256)]
    for before, after in pairwise(answers):
        assert sum(a != b for a, b in zip(before, after, strict=True)) == 1


def test_clocks_come_to_times() -> None:
    found = timing(Frame(13, 12), Requests("ssi", 16e6, 160, 160, period=0), 8192)
    assert found.bit_hz == 50e3
    assert found.answer_s == pytest.approx(25 / 50e3)
    assert found.pause_s == pytest.approx(21e-6)
    assert found.turns == 4096
    assert found.speed_rpm is None
    assert any("SER_PTIME" in said for said in found.warnings)
    twice = timing(Frame(13, 12), Requests("ssi", 16e6, 160, 160, repeat_wait=240, period=0x7FFF, twice=True), 8192)
    assert twice.answer_s == pytest.approx(2 * 25 / 50e3 + 15e-6)
    assert twice.period_s == pytest.approx(0x7FFF / 16e6)


def test_turns_that_are_not_sent_limit_the_speed_to_half_a_turn_an_answer() -> None:
    found = timing(Frame(12), Requests("spi", 16e6, 8, 8, period=16_000), 4096)
    assert found.speed_rpm == pytest.approx(0.5 / 1e-3 * 60)
    limited = timing(Frame(12), Requests("spi", 16e6, 8, 8, period=16_000, variation=64), 4096)
    assert limited.speed_rpm == pytest.approx(64 / 2048 / 1e-3 * 60)


@pytest.mark.parametrize(
    ("frame", "requests", "counts", "words"),
    [
        (Frame(13), Requests("ssi", 16e6, 160, 160, period=50_000), 4096, "ENC_IN_RES is 4096"),
        (Frame(13), Requests("ssi", 16e6, 160, 160, period=50_000), 0, "no count moves"),
        (Frame(13), Requests("ssi", 16e6, 2, 2, period=50_000), 8192, "2 MHz"),
        (Frame(13), Requests("ssi", 16e6, 160, 160, repeat_wait=400, period=50_000, twice=True), 8192, "19 us"),
        (Frame(13), Requests("ssi", 16e6, 160, 160, delay=400, period=50_000), 8192, "longer than a bit"),
        (Frame(13, gray=True), Requests("spi", 16e6, 8, 8, period=50_000), 8192, "for SSI"),
    ],
)
def test_what_does_not_work_is_said(frame: Frame, requests: Requests, counts: int, words: str) -> None:
    assert any(words in said for said in timing(frame, requests, counts).warnings)


def test_bad_settings_are_refused() -> None:
    with pytest.raises(ValueError, match="single_bits"):
        Frame(0)
    with pytest.raises(ValueError, match="SER_CLK_IN_HIGH"):
        Requests("ssi", 16e6, 0, 10)
    with pytest.raises(ValueError, match="5 bits"):
        Frame(5).place((1, 0))
