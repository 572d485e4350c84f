"""Current and chopper times of a driver with one current scale, against the maker's formula worked out by hand."""

from __future__ import annotations

import pytest

from app.calc.tmcdrivers.scale_current import blank_s, highest_chopper_hz, nearest, off_s, setting

MODEL, OHM = "tmc2660", 0.1


@pytest.mark.parametrize(
    ("scale", "vsense", "rms_a"),
    [(31, 0, 2.1920), (31, 1, 1.1667), (15, 0, 1.0960), (0, 1, 0.0365)],
)
def test_current_of_a_scale(scale: int, vsense: int, rms_a: float) -> None:
    """310 and 165 mV of peak at the resistor, of which the scale takes (CS + 1) / 32."""
    assert setting(MODEL, OHM, scale, vsense).rms_a == pytest.approx(rms_a, abs=1e-4)


def test_the_nearest_scale_is_that_of_the_finer_range_where_it_gets_there() -> None:
    best, other = nearest(MODEL, OHM, 1.0)
    assert (best.scale, best.vsense) == (26, 1)
    assert abs(best.rms_a - 1.0) <= abs(other.rms_a - 1.0)
    assert nearest(MODEL, OHM, 1.8)[0].vsense == 0
    assert nearest(MODEL, OHM, 50.0)[0] == setting(MODEL, OHM, 31, 0)
    assert nearest(MODEL, OHM, 0.001)[0] == setting(MODEL, OHM, 0, 1)


def test_times_of_the_chopper() -> None:
    assert off_s(15e6, 5) == 184 / 15e6
    assert blank_s(15e6, 2) == 36 / 15e6
    assert highest_chopper_hz(15e6, 5, 2) == pytest.approx(15e6 / 440)
