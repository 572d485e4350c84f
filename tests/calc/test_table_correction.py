"""Tables of a TMC428 that make up for a motor's angle error."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from app.calc.microsteps.angle_correction import TooUneven, motor_of, predicted, rms
from app.calc.microsteps.angle_error import Harmonic
from app.calc.microsteps.metrics import metrics
from app.calc.microsteps.table import checked_values, design_table
from app.calc.microsteps.table_correction import TABLE_GRID, TableCorrection, field_of_table, table_for


def corrected(*parts: tuple[int, float, float]) -> TableCorrection:
    return table_for(motor_of(Harmonic(order, sine, cosine, 0.0) for order, sine, cosine in parts))


@pytest.mark.sheet("DS-TMC428", "12.3")
@pytest.mark.parametrize("four_deg", [-4.0, -1.5, 1.5, 4.0])
def test_an_error_once_a_full_step_is_taken_away_by_shape_and_more_so_entry_by_entry(four_deg: float) -> None:
    found = corrected((4, four_deg, 0.0))
    assert found.sine_deg == pytest.approx(abs(four_deg) / np.sqrt(2), abs=0.15)
    assert found.shaped_deg < 0.6 * found.sine_deg
    assert found.values_deg < min(found.sine_deg / 5, 0.1)
    assert found.beyond_deg < 0.01
    # The rhomb gives the rotor less angle near a full step, the box more: the sign of sigma is that of the error.
    assert found.sigma * four_deg < 0
    assert checked_values(found.values) == found.values
    assert found.shaped == design_table(found.sigma, found.offset).values


def test_its_vectors_keep_their_length() -> None:
    ripple = metrics(corrected((4, 4.0, 0.0), (8, 0.5, 0.0)).values).vector_length_ripple
    assert ripple is not None
    assert ripple < 0.1


def test_what_is_between_the_phases_stays_and_is_told() -> None:
    found = corrected((2, 1.5, -1.0), (4, 2.0, 0.0))
    assert found.beyond_deg == pytest.approx(np.hypot(1.5, 1.0) / np.sqrt(2), abs=0.05)
    assert found.values_deg == pytest.approx(found.beyond_deg, abs=0.02)


def test_each_pair_of_entries_is_the_best_that_there_is() -> None:
    """No entry a count up or down, alone or with its partner, comes nearer to the wanted angle at the same length."""
    motor = motor_of([Harmonic(4, 3.0, 0.0, 0.0)])
    found = table_for(motor)
    for place in range(1, 32):
        for up, over in itertools.product((-1, 0, 1), repeat=2):
            other = list(found.values)
            other[place] = min(max(other[place] + up, 0), 63)
            other[64 - place] = min(max(other[64 - place] + over, 0), 63)
            longer = [np.hypot(each[place], each[64 - place]) / 63 - 1 for each in (found.values, other)]
            if abs(longer[1]) <= abs(longer[0]):
                left = np.degrees(rms(predicted(motor, field_of_table(other), TABLE_GRID)))
                assert left >= found.values_deg - 0.02


def test_a_motor_that_no_table_makes_up_for_is_refused() -> None:
    with pytest.raises(TooUneven):
        corrected((16, 10.0, 0.0))
