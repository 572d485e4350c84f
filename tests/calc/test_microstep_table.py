"""Tables from the formulas of DS-TMC428 chapter 12 and the shapes of 12.3."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.microsteps.shapes import box, circle, f_sigma, quarter_positions, rhomb
from app.calc.microsteps.table import METHODS, Method, checked_values, design_table

# The list printed in chapter 12 with its two lost 63s put back (the formula and Table 12-2 have them).
PRINTED_TABLE = (
    [0, 2, 3, 5, 6, 8, 9, 11, 12, 14, 16, 17, 19, 20, 22, 23, 24, 26, 27, 29, 30, 32, 33, 34, 36, 37, 38, 39, 41]
    + [42, 43, 44, 45, 46, 47, 48, 49, 50, 51, 52, 53, 54, 55, 56, 56, 57, 58, 59, 59, 60, 60, 61, 61, 62, 62, 62]
    + [63] * 8
)
PHI = [math.pi / 2 * i / 64 for i in range(64)]

sigmas = st.floats(-1, 1)
methods = st.sampled_from(METHODS)


def as_printed(phi: float, sigma: float) -> float:
    """f_sigma as 12.3 writes it, in radians, with the lost pi in the slope of the box."""
    f_circle = math.sin(phi)
    if sigma > 0:
        f_box = 4 / (math.pi * math.sqrt(2)) * phi if phi < math.pi / 4 else 1 / math.sqrt(2)
        return f_circle + sigma * (f_box - f_circle)
    if sigma < 0:
        return f_circle + sigma * (f_circle - 2 / math.pi * phi)
    return f_circle


@pytest.mark.sheet("DS-TMC428", "12")
def test_the_first_formula_gives_the_printed_table() -> None:
    assert list(design_table().values) == PRINTED_TABLE


@pytest.mark.sheet("DS-TMC428", "12")
def test_five_values_of_the_first_formula_would_be_64() -> None:
    raw = [int(0.5 + 64 * math.sin(phi)) for phi in PHI]
    assert raw.count(64) == 5
    assert list(design_table().values) == [min(value, 63) for value in raw]


@pytest.mark.sheet("DS-TMC428", "12")
def test_the_second_formula() -> None:
    assert list(design_table(method="63").values) == [int(63 * math.sin(phi)) for phi in PHI]


@pytest.mark.sheet("DS-TMC428", "12")
@pytest.mark.parametrize("offset", range(64))
def test_the_third_formula(offset: int) -> None:
    expected = [int(offset + (63 - offset) * math.sin(phi)) for phi in PHI]
    assert list(design_table(offset=offset, method="offset").values) == expected


@pytest.mark.sheet("DS-TMC428", "12.3")
@pytest.mark.parametrize("sigma", [-1.0, -0.5, -0.2, 0.0, 0.2, 0.5, 1.0])
def test_shapes_are_those_of_the_sheet(sigma: float) -> None:
    expected = [as_printed(phi, sigma) for phi in PHI]
    np.testing.assert_allclose(f_sigma(quarter_positions(), sigma), expected, atol=1e-14)


@pytest.mark.sheet("DS-TMC428", "12.3")
def test_plus_one_is_the_box_zero_the_circle_minus_one_the_rhomb() -> None:
    t = np.linspace(0, 1, 1001)
    np.testing.assert_allclose(f_sigma(t, 1), box(t), atol=1e-15)
    np.testing.assert_array_equal(f_sigma(t, 0), circle(t))
    np.testing.assert_allclose(f_sigma(t, -1), rhomb(t), atol=1e-15)


@pytest.mark.sheet("DS-TMC428", "12.3")
def test_current_vectors_draw_box_circle_and_rhomb() -> None:
    t = np.linspace(0, 1, 257)
    half_side = 1 / math.sqrt(2)
    np.testing.assert_allclose(np.maximum(box(t), box(1 - t)), half_side)  # on the sides of a square
    np.testing.assert_allclose(np.hypot(circle(t), circle(1 - t)), 1)
    np.testing.assert_allclose(rhomb(t) + rhomb(1 - t), 1)


@pytest.mark.sheet("DS-TMC428", "12.3")
@given(sigma=sigmas, t=st.floats(0, 1))
def test_between_the_shapes_is_their_mixture(sigma: float, t: float) -> None:
    other = float(box(t)) if sigma > 0 else float(rhomb(t))
    mixture = (1 - abs(sigma)) * float(circle(t)) + abs(sigma) * other
    assert float(f_sigma(t, sigma)) == pytest.approx(mixture, abs=1e-14)


def test_the_rhomb_table_is_exact() -> None:
    # 63 * i / 64 and its like fall on whole numbers, where a last-digit error would show.
    assert list(design_table(-1).values) == list(range(64))
    assert list(design_table(-1, amplitude=32, method="63").values) == [i // 2 for i in range(64)]


def test_a_box_reaches_its_amplitude_only_at_full_scale() -> None:
    assert max(design_table(1).values) == int(0.5 + 64 / math.sqrt(2))
    assert max(design_table(1, full_scale=True).values) == 63
    assert max(design_table(0.3, amplitude=40, full_scale=True).values) == 40


@given(
    sigma=sigmas,
    method=methods,
    amplitude=st.floats(0, 63),
    share=st.floats(0, 1),
    full_scale=st.booleans(),
)
def test_every_design_is_monotone_and_within_its_amplitude(
    sigma: float, method: Method, amplitude: float, share: float, full_scale: bool
) -> None:
    offset = amplitude * share
    design = design_table(sigma, offset, amplitude, method, full_scale=full_scale)
    values = np.array(design.values)
    assert checked_values(design.values) == design.values
    assert (np.diff(values) >= 0).all()
    assert (np.diff(design.ideal) >= -1e-12).all()
    assert values.max() <= amplitude
    assert values[0] in (math.floor(offset), math.floor(offset + 0.5))
    # int() loses up to 1, the first formula up to 1/2; its gain of A + 1 gives back up to 1 at the clamp
    assert (np.abs(values - np.array(design.ideal)) <= (2.0 if method == "half_rounded_64" else 1.0)).all()


@given(sigma=sigmas, offset=st.floats(0, 63))
def test_an_offset_makes_the_second_formula_the_third(sigma: float, offset: float) -> None:
    second, third = (design_table(sigma, offset, method=method) for method in ("63", "offset"))
    assert second.values == third.values
    assert any("offset" in text for text in second.warnings) == (offset > 0)


@pytest.mark.sheet("DS-TMC428", "12.3")
@pytest.mark.parametrize(("sigma", "warned"), [(-0.51, True), (-0.5, False), (0.0, False), (0.5, False), (0.51, True)])
def test_beyond_the_sheets_range_of_sigma_is_a_warning(sigma: float, warned: bool) -> None:
    assert any("-0.5..0.5" in text for text in design_table(sigma).warnings) == warned


def test_no_current_is_a_warning() -> None:
    design = design_table(amplitude=0)
    assert set(design.values) == {0}
    assert any("without current" in text for text in design.warnings)


@pytest.mark.parametrize("sigma", [-1.001, 1.001, math.nan, math.inf, -math.inf])
def test_sigma_out_of_range_is_refused(sigma: float) -> None:
    with pytest.raises(ValueError, match=r"sigma is .*allowed is -1\.\.1"):
        design_table(sigma)


@pytest.mark.parametrize("amplitude", [-1, 63.5, math.nan, math.inf])
def test_amplitude_out_of_range_is_refused(amplitude: float) -> None:
    with pytest.raises(ValueError, match=r"amplitude is .*allowed is 0\.\.63"):
        design_table(amplitude=amplitude)


@pytest.mark.parametrize(("offset", "amplitude"), [(-0.1, 63), (63.1, 63), (41, 40), (math.nan, 63)])
def test_offset_out_of_range_is_refused(offset: float, amplitude: float) -> None:
    with pytest.raises(ValueError, match=rf"offset is .*allowed is 0\.\.{amplitude}"):
        design_table(offset=offset, amplitude=amplitude)


def test_an_unknown_method_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ValueError, match="half_rounded_64, 63, offset"):
        design_table(method="64")  # type: ignore[arg-type]


@pytest.mark.parametrize("t", [-0.01, 1.01, math.nan])
def test_shapes_end_with_the_quarter(t: float) -> None:
    with pytest.raises(ValueError, match=r"0\.\.1"):
        f_sigma(t, 0)
