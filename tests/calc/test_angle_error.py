"""The angle error of a motor, found in samples that were made of a known one, and tables that make up for it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from app.calc.microsteps.angle_correction import (
    GRID,
    TooUneven,
    corrected,
    field_of,
    motor_error,
    predicted,
    quarter_part,
    rms,
)
from app.calc.microsteps.angle_error import AngleError, ElectricalAngle, Way, angle_error
from app.calc.microsteps.mslut import POWER_ON, decode, encode, refusals
from app.calc.microsteps.mslut_waves import Formula, Term, wanted_wave

TURN, PERIOD = 51_200.0, 1024.0
COUNT = 1.28
"""Of an encoder with 10,000 lines [microsteps]."""
FloatArray = NDArray[np.float64]


class Motor:
    """Its rotor less field over the field's angle, friction [deg electrical]; an encoder with its errors."""

    def __init__(self, parts: dict[int, tuple[float, float]], friction: float = 1.5, eccentric: float = 0.3) -> None:
        self.parts, self.friction, self.eccentric = parts, friction, eccentric

    def off(self, field: FloatArray) -> FloatArray:
        """[rad]."""
        total = np.zeros_like(field)
        for order, (sine, cosine) in self.parts.items():
            total += np.radians(sine * np.sin(order * field) + cosine * np.cos(order * field))
        return total

    def turned(self, electrical: ElectricalAngle, field: FloatArray, seed: int, samples: int = 3000) -> list[Way]:
        """Sampled there and back over a turn, with a table of these field angles."""
        rng = np.random.default_rng(seed)
        ways = []
        for forward in (True, False):
            position = np.floor(np.sort(rng.uniform(0, TURN, samples)))[:: 1 if forward else -1]
            commanded = electrical.at(position)
            turned = commanded + np.interp(commanded, GRID, field - GRID, period=2 * math.pi)
            error_deg = np.degrees(turned + self.off(turned) - commanded)
            # A lag is against the way of the shaft, whichever way the field goes for it.
            lag = self.friction * electrical.sign * (-1 if forward else 1)
            error = electrical.sign * (error_deg + lag) * electrical.period / 360
            error += self.eccentric * TURN / 360 * np.sin(2 * math.pi * position / TURN + 1)
            ways.append(Way(position, np.floor((position + error) / COUNT) * COUNT, forward))
        return ways


SINE = decode(POWER_ON)


def electrical(angle: float = 0.3, sign: int = 1) -> ElectricalAngle:
    return ElectricalAngle(100.0, angle, PERIOD, sign)


def measured(motor: Motor, at: ElectricalAngle, seed: int = 1, samples: int = 3000) -> AngleError:
    return angle_error(motor.turned(at, field_of(SINE), seed, samples), at, TURN)


def held_part(error_deg: FloatArray) -> float:
    """Root mean square of what a table of a quarter wave can hold [deg]."""
    return rms(quarter_part(error_deg))


@pytest.mark.parametrize("seed", range(12))
def test_what_samples_were_made_of_is_found(seed: int) -> None:
    rng = np.random.default_rng(seed)
    two, four, sign = tuple(rng.uniform(-4, 4, 2)), rng.uniform(-4, 4), (1, -1)[seed % 2]
    motor = Motor({2: two, 4: (four, 0.0)}, friction=2.0, eccentric=0.4)
    found = measured(motor, electrical(rng.uniform(-3, 3), sign), seed)
    second, fourth = found.harmonic(2), found.harmonic(4)
    assert (second.sine, second.cosine) == pytest.approx(two, abs=0.02)
    # The power-on table is itself off by 0.07 degrees once a full step.
    assert fourth.sine == pytest.approx(four, abs=0.1)
    assert abs(found.friction) == pytest.approx(2.0, abs=0.01)
    assert found.shaft[0].amplitude == pytest.approx(0.4, abs=5e-4)
    assert found.shaft[1].amplitude < 5e-4
    assert found.periods == 100


def test_intervals_hold_the_truth_as_often_as_they_say() -> None:
    motor, held = Motor({1: (0.2, -0.1), 2: (1.0, 0.5)}), 0
    ideal = GRID
    for seed in range(25):
        at = electrical()
        found = angle_error(motor.turned(at, ideal, seed, 1200), at, TURN)
        for order, (sine, cosine) in motor.parts.items():
            each = found.harmonic(order)
            held += abs(each.sine - sine) <= each.half
            held += abs(each.cosine - cosine) <= each.half
    assert held >= 0.9 * 100


def test_samples_that_were_torn_apart_change_nothing() -> None:
    at, motor = electrical(), Motor({2: (1.0, 0.5)})
    ways = motor.turned(at, GRID, 1)
    clean = angle_error(ways, at, TURN)
    for way in ways:
        way.encoder[::97] += 300.0
    spoilt = angle_error(ways, at, TURN)
    assert spoilt.rms == pytest.approx(clean.rms, abs=0.01)
    assert spoilt.harmonic(2).half < 1.5 * clean.harmonic(2).half


def test_what_is_no_measurement_is_refused() -> None:
    at, motor = electrical(), Motor({})
    there, back = motor.turned(at, GRID, 1)
    with pytest.raises(ValueError, match="both ways"):
        angle_error([there, there], at, TURN)
    with pytest.raises(ValueError, match="samples"):
        angle_error([Way(way.position[:20], way.encoder[:20], way.forward) for way in (there, back)], at, TURN)
    short = [
        Way(way.position[near], way.encoder[near], way.forward)
        for way in (there, back)
        for near in [way.position < 3000]
    ]
    with pytest.raises(ValueError, match="6 electrical periods"):
        angle_error(short, at, TURN)


@pytest.mark.parametrize("seed", range(6))
def test_a_table_takes_away_what_it_can_hold_and_tells_what_it_cannot(seed: int) -> None:
    rng = np.random.default_rng(seed)
    two, four, eight = rng.uniform(-4, 4), rng.uniform(-4, 4), rng.uniform(-0.5, 0.5)
    motor = Motor({2: (two, two / 2), 4: (four, 0.0), 8: (eight, 0.0)})
    found = corrected(measured(motor, electrical()), SINE)
    assert not list(refusals(found.wave))
    assert decode(encode(found.wave.values, found.wave.mirror)) == found.wave
    assert set(found.wave.values) <= set(range(256))
    field = field_of(found.wave)
    left = np.degrees(field + motor.off(field) - GRID)
    # What is expected is what comes; of what the table can hold nothing counts any more.
    assert rms(left - left.mean()) == pytest.approx(rms(found.after), abs=0.05)
    assert held_part(found.after) < 0.03
    # Beyond the table is all that is not symmetric, most of it from between the phases.
    assert rms(found.beyond) == pytest.approx(abs(two) * math.sqrt(1.25 / 2), abs=0.15)


def test_to_correct_again_changes_nothing_that_counts() -> None:
    """The second time the table is no sine any more: its own angle is taken off before the motor's is judged."""
    motor, at = Motor({2: (1.0, 0.0), 4: (3.5, 0.0)}), electrical()
    first = corrected(measured(motor, at), SINE)
    again = angle_error(motor.turned(at, field_of(first.wave), 2), at, TURN)
    assert again.rms == pytest.approx(rms(first.after), abs=0.05)
    second = corrected(again, first.wave)
    assert rms(np.degrees(field_of(second.wave) - field_of(first.wave))) < 0.1


def test_nothing_to_hold_leaves_the_sine() -> None:
    found = corrected(measured(Motor({2: (2.0, -1.0)}), electrical()), SINE)
    assert rms(found.after) == pytest.approx(rms(found.before), abs=0.02)
    # Both are the nearest to a sine, of one amplitude or nearly so: entries differ by a count.
    assert rms(np.degrees(field_of(found.wave) - field_of(SINE))) < 0.2


def test_the_part_of_a_quarter_wave_is_what_such_a_table_shows() -> None:
    """Of any shape; and a table's own angle is all of that part."""
    rng = np.random.default_rng(4)
    anything = rng.normal(size=1024)
    part = quarter_part(anything)
    assert quarter_part(part) == pytest.approx(part)
    wave = wanted_wave(Formula(corrections=(Term(4, 3.0, 0.0), Term(8, -1.0, 0.0)))).wave
    own = field_of(wave) - GRID
    assert quarter_part(own) == pytest.approx(own, abs=1e-12)
    for order, shape in ((1, np.sin), (2, np.sin), (2, np.cos), (4, np.cos), (6, np.sin)):
        assert rms(quarter_part(shape(order * GRID))) < 1e-12


def test_a_rotor_that_would_turn_back_is_refused() -> None:
    violent = Motor({16: (5.0, 0.0)})
    with pytest.raises(TooUneven):
        corrected(measured(violent, electrical(), samples=8000), SINE)


def test_the_motors_own_error_does_not_depend_on_the_table_that_showed_it() -> None:
    motor, at = Motor({2: (1.0, -0.5), 4: (2.0, 0.0)}), electrical()
    other = wanted_wave(Formula(corrections=(Term(4, 3.0, 0.0),))).wave
    for wave in (SINE, other):
        found = angle_error(motor.turned(at, field_of(wave), 3, 6000), at, TURN)
        seen = motor_error(found, field_of(wave))
        assert np.degrees(seen.values) == pytest.approx(np.degrees(motor.off(GRID)), abs=0.12)
        told = np.degrees(predicted(seen, field_of(SINE)))
        assert rms(told) == pytest.approx(rms(np.degrees(motor.off(GRID))), abs=0.05)
