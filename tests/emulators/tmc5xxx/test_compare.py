"""Position compare: the output while XACTUAL is X_COMPARE, and how often it came upon it."""

from __future__ import annotations

import pytest

from app.emulators.tmc5xxx import MODELS, Tmc5xxxModel
from tests.emulators.tmc5xxx.rig import BACKWARD, DUAL, FORWARD, TURN, Bench, moving


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("rigid", [False, True])
def test_each_time_that_the_position_is_come_upon_counts_once(model: Tmc5xxxModel, rigid: bool) -> None:
    bench = moving(model, rigid=rigid)
    bench.write("X_COMPARE", 7777)
    assert bench.state().position_compare.passed == 0
    for mode, seconds, passed in ((FORWARD, 2, 1), (BACKWARD, 4, 2), (FORWARD, 4, 3)):
        bench.put(RAMPMODE=mode)
        bench.wait(seconds)
        state = bench.state().position_compare
        assert (state.x_compare, state.passed, state.output) == (7777, passed, False)


@pytest.mark.parametrize("model", MODELS)
def test_the_output_is_high_while_it_is_there(model: Tmc5xxxModel) -> None:
    bench = moving(model)
    bench.write("X_COMPARE", -TURN)
    bench.put(XTARGET=-TURN)
    bench.wait(2)
    assert bench.state().position_compare.output
    bench.put(XTARGET=-TURN + 1)
    bench.wait(1)
    assert not bench.state().position_compare.output


@pytest.mark.parametrize("model", DUAL)
def test_the_dual_chips_show_it_only_if_they_are_to(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    assert not bench.state().position_compare.enabled
    bench.write("GCONF", 1 << 3)
    assert bench.state().position_compare.enabled


@pytest.mark.parametrize("model", MODELS)
def test_it_is_passed_once_on_the_way_round_the_range(model: Tmc5xxxModel) -> None:
    """At the highest velocity a tick is 128 microsteps long: it is not missed between two."""
    bench = moving(model)
    bench.put(XACTUAL=2**31 - 5_000_000, XTARGET=2**31 - 5_000_000)
    bench.write("X_COMPARE", -(2**31) + 1234)
    bench.put(AMAX=65_535, VMAX=(1 << 23) - 512, RAMPMODE=FORWARD)
    bench.wait(4)
    assert bench.read("VACTUAL") == (1 << 23) - 512
    assert bench.state().position_compare.passed == 1
