"""Units of the SixPoint ramp generator: formulas, the module manual's ranges, round trips, vectors against scalars."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.units.tmc5xxx import (
    ACCELERATION_MAX,
    VELOCITY_MAX,
    acceleration_pps2,
    acceleration_unit_pps2,
    acceleration_units,
    velocity_pps,
    velocity_unit_pps,
    velocity_units,
)

velocities = st.integers(-VELOCITY_MAX, VELOCITY_MAX)
accelerations = st.integers(-ACCELERATION_MAX, ACCELERATION_MAX)
clocks = st.floats(4e6, 20e6)


@pytest.mark.sheet("FM-PD42-1241", "7.4")
def test_the_formulas_at_16_mhz() -> None:
    assert velocity_unit_pps() == 16e6 / 2 / 2**23
    assert acceleration_unit_pps2() == 16e6**2 / (512 * 256) / 2**24
    # The ranges that the sister module's manual prints are these, rounded.
    assert round(acceleration_pps2(ACCELERATION_MAX)) == 7_629_278
    assert int(velocity_pps((1 << 18) - 1)) == 249_999
    assert round(velocity_pps((1 << 20) - 1)) == 999_999


@pytest.mark.sheet("FM-PD42-1241", "6.1")
def test_one_turn_a_second() -> None:
    # 200 full steps of 256 microsteps.
    assert velocity_units(51_200) == 53_687
    assert acceleration_units(51_200) == 440


@given(units=velocities, clock_hz=clocks)
def test_velocities_there_and_back(units: int, clock_hz: float) -> None:
    assert velocity_units(velocity_pps(units, clock_hz), clock_hz) == units


@given(units=accelerations, clock_hz=clocks)
def test_accelerations_there_and_back(units: int, clock_hz: float) -> None:
    assert acceleration_units(acceleration_pps2(units, clock_hz), clock_hz) == units


@given(pps=st.floats(-7.9e6, 7.9e6))
def test_the_nearest_unit_is_never_more_than_half_a_unit_away(pps: float) -> None:
    assert abs(velocity_pps(velocity_units(pps)) - pps) <= velocity_unit_pps() / 2 * (1 + 1e-9)
    assert velocity_units(-pps) == -velocity_units(pps)


@given(values=st.lists(st.floats(-7e6, 7e6), min_size=1, max_size=5))
def test_arrays_are_scalars_side_by_side(values: list[float]) -> None:
    assert np.asarray(velocity_units(values)).tolist() == [velocity_units(value) for value in values]
    assert np.asarray(acceleration_units(values)).tolist() == [acceleration_units(value) for value in values]
    assert np.asarray(velocity_pps([1, 2])).tolist() == [velocity_pps(1), velocity_pps(2)]


@pytest.mark.parametrize("units", [VELOCITY_MAX + 1, -VELOCITY_MAX - 1, float("nan")])
def test_velocities_beyond_the_register(units: float) -> None:
    with pytest.raises(ValueError, match="velocity"):
        velocity_pps(units)
    with pytest.raises(ValueError, match="velocity"):
        velocity_units(units * velocity_unit_pps())


def test_what_else_cannot_be() -> None:
    with pytest.raises(ValueError, match="acceleration"):
        acceleration_units(7_629_400)
    with pytest.raises(ValueError, match="clock_hz"):
        velocity_unit_pps(0)
