"""Motors of a batch: figures drawn from a seed around those of a named motor."""

from __future__ import annotations

import pytest

from app.clock import VirtualClock
from app.emulators.build import build_emulator, options_of
from app.emulators.drive import Drive, DriveOptions, MotorOptions
from app.emulators.drive.batch import ADDED, LOAD_ADDED, LOAD_SHARES, SHARES, motor_of_batch
from app.emulators.drive.documents import motor_state

NAMED = MotorOptions(resistance_ohm=1.6, inductance_h=3e-3, holding_torque_nm=0.59, rated_current_a=2.0)
SEEDS = range(300)


def test_the_same_seed_is_the_same_motor_and_another_one_another() -> None:
    assert motor_of_batch(NAMED, 7) == motor_of_batch(NAMED, 7)
    assert len({motor_of_batch(NAMED, seed).resistance_ohm for seed in SEEDS}) == len(SEEDS)


def test_every_figure_spreads_over_its_tolerance_and_no_further() -> None:
    drawn = [motor_of_batch(NAMED, seed) for seed in SEEDS]
    for motors, named, shares in (
        (drawn, NAMED, SHARES),
        ([one.load_value for one in drawn], NAMED.load_value, LOAD_SHARES),
    ):
        for name, (low, high) in shares.items():
            ratios = [getattr(one, name) / getattr(named, name) for one in motors]
            assert low <= min(ratios) < low + 0.1 * (high - low), name
            assert high - 0.1 * (high - low) < max(ratios) <= high, name
    for name, most in ADDED.items():
        values = [getattr(one, name) for one in drawn]
        assert -most <= min(values) < -0.9 * most, name
        assert 0.9 * most < max(values) <= most, name
    for name, most in LOAD_ADDED.items():
        values = [getattr(one.load_value, name) for one in drawn]
        assert 0.0 <= min(values) < 0.1 * most < 0.9 * most < max(values) <= most, name


def test_figures_are_drawn_apart_and_what_is_no_tolerance_stays() -> None:
    """A torque that is named otherwise leaves the resistance that was drawn."""
    other = NAMED.model_copy(update={"holding_torque_nm": 0.3})
    assert motor_of_batch(other, 5).resistance_ohm == motor_of_batch(NAMED, 5).resistance_ohm
    assert (motor_of_batch(NAMED, 5).rated_current_a, motor_of_batch(NAMED, 5).rotor_teeth) == (2.0, 50)


def test_no_drawn_figure_leaves_the_range_of_its_option() -> None:
    edge = MotorOptions(phase_unbalance=0.19, quadrature_error_deg=-9.9, resistance_ohm=200.0)
    for seed in SEEDS:
        MotorOptions.model_validate(motor_of_batch(edge, seed).model_dump())


def test_a_drive_has_the_drawn_motor_once_and_tells_it() -> None:
    asked = MotorOptions(**{**NAMED.model_dump(), "batch_seed": 11})
    wanted = motor_of_batch(NAMED, 11)
    drive = Drive(DriveOptions(motor=asked))
    assert drive.options.motor == wanted
    again = DriveOptions(**{**dict(drive.options), "supply_v": 30.0})
    assert again.motor == wanted, "drawn once, not around what was drawn"
    told = motor_state(drive.plant, drive.options.motor)
    assert told.figures["resistance_ohm"] == wanted.resistance_ohm
    assert told.figures["load_value.noise"] == wanted.load_value.noise
    assert told.holding_torque_nm == wanted.holding_torque_nm
    assert DriveOptions(motor=NAMED).motor == NAMED


@pytest.mark.parametrize("model", ["tmc5160", "tmc2209", "pd42-1241", "tmc4361"])
def test_every_motor_that_can_be_asked_for_may_be_one_of_a_batch(model: str) -> None:
    emulator = build_emulator(model, VirtualClock(), options_of(model).model_validate({"motor": {"batch_seed": 3}}))
    told = str(emulator.state())
    assert repr(motor_of_batch(MotorOptions(), 3).resistance_ohm) in told
