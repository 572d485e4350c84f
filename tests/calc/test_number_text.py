"""How messages write numbers."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.number_text import plain


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (2e6, "2000000"),
        (12345678, "12345678"),
        (-1234567.89, "-1234568"),
        (0.1 + 0.2, "0.3"),
        (61.03515625, "61.0352"),
        (0.0, "0"),
        (1.5e-9, "1.5e-09"),
        (math.inf, "inf"),
    ],
)
def test_as_somebody_would_type_it(value: float, text: str) -> None:
    assert plain(value) == text


@given(st.floats(-1e14, 1e14).filter(lambda value: abs(value) > 1e-5))
def test_no_exponent_and_six_digits(value: float) -> None:
    text = plain(value)
    assert "e" not in text
    assert float(text) == pytest.approx(value, rel=5.1e-6)


@given(st.integers(-(10**14), 10**14))
def test_every_digit_of_a_whole_number(value: int) -> None:
    assert plain(value) == str(value)
