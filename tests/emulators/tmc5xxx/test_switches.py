"""SW_MODE in full, on every axis: stops hard and soft, polarity, swapping, latches at either edge.

That a polarity bit of 1 means low active is inferred (NOTES-TMC5XXX 5).
"""

from __future__ import annotations

import itertools

import pytest

from app.emulators.tmc5xxx import MODELS, Tmc5xxxModel
from tests.emulators.tmc5xxx.rig import BACKWARD, FORWARD, PLACES, RAMP, TURN, WITH_ENCODER, Bench, moving

STOP_L, STOP_R, POL_L, POL_R, SWAP = (1 << bit for bit in range(5))
LATCH_L_ON, LATCH_L_OFF, LATCH_R_ON, LATCH_R_OFF, LATCH_ENCODER, SG_STOP, SOFT = (1 << bit for bit in range(5, 12))


@pytest.mark.parametrize(("model", "axis"), PLACES)
@pytest.mark.parametrize("right", [False, True])
def test_a_switch_stops_the_motor_on_its_side_at_once(model: Tmc5xxxModel, axis: int, right: bool) -> None:
    stage = {"left_at_fullsteps": -100.0, "right_at_fullsteps": 100.0}
    bench = moving(model, axis, stage=stage | {"home_from_fullsteps": 0.0, "home_to_fullsteps": 0.0})
    bench.put(axis, SW_MODE=STOP_L | STOP_R, RAMPMODE=FORWARD if right else BACKWARD)
    bench.wait(2)
    assert bench.read("VACTUAL", axis) == 0
    way = 1 if right else -1
    # seen in the tick after the one that came there
    assert 25_600 <= bench.read("XACTUAL", axis) * way <= 25_600 + 10
    side = "r" if right else "l"
    assert {f"status_stop_{side}", f"event_stop_{side}"} <= bench.flags(axis)
    bench.put(axis, RAMPMODE=BACKWARD if right else FORWARD)
    bench.wait(0.2)
    assert bench.read("VACTUAL", axis) * way < 0, "the other way is free"
    assert f"event_stop_{side}" not in bench.flags(axis)


@pytest.mark.parametrize("model", MODELS)
def test_hold_mode_ends_the_event_of_a_stop(model: Tmc5xxxModel) -> None:
    bench = moving(model)
    bench.put(SW_MODE=STOP_R, RAMPMODE=FORWARD)
    bench.stage(switches={"right": True})
    bench.wait(0.1)
    assert "event_stop_r" in bench.flags()
    bench.put(RAMPMODE=3)
    bench.wait(0.01)
    assert "event_stop_r" not in bench.flags()


@pytest.mark.parametrize("model", MODELS)
def test_a_soft_stop_brakes(model: Tmc5xxxModel) -> None:
    bench = moving(model)
    bench.put(RAMPMODE=FORWARD)
    bench.wait(1)
    bench.put(SW_MODE=STOP_R | SOFT)
    bench.stage(switches={"right": True})
    assert bench.read("VACTUAL") > 0
    start = bench.read("XACTUAL")
    bench.wait(2)
    braking = bench.read("XACTUAL") - start
    v, d = RAMP["VMAX"] * 16e6 / 2**24, RAMP["DMAX"] * 16e6**2 / 2**41
    assert bench.read("VACTUAL") == 0
    assert braking == pytest.approx(v * v / (2 * d), rel=0.03)


@pytest.mark.parametrize("model", MODELS)
def test_what_the_ramp_generator_sees_of_two_levels(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    for left, right, polarity, swap in itertools.product((False, True), (False, True), range(4), (0, 1)):
        bench.put(SW_MODE=polarity << 2 | swap << 4)
        bench.stage(switches={"left": left, "right": right})
        seen = [left ^ bool(polarity & 1), right ^ bool(polarity & 2)]
        if swap:
            seen.reverse()
        flags = bench.flags()
        assert ["status_stop_l" in flags, "status_stop_r" in flags] == seen


@pytest.mark.parametrize(("model", "axis"), PLACES)
@pytest.mark.parametrize("right", [False, True])
@pytest.mark.parametrize("inactive", [False, True])
def test_xlatch_takes_the_position_at_the_chosen_edge(
    model: Tmc5xxxModel, axis: int, right: bool, inactive: bool
) -> None:
    bench = moving(model, axis)
    bench.put(axis, RAMPMODE=FORWARD, SW_MODE=1 << 5 + 2 * right + inactive)
    side, flag = ("right", "status_latch_r") if right else ("left", "status_latch_l")
    bench.wait(0.5)
    bench.stage(axis, switches={side: True})
    first = bench.read("XACTUAL", axis)
    assert (flag in bench.flags(axis)) == (not inactive)
    bench.clear(axis)
    bench.wait(0.5)
    bench.stage(axis, switches={side: False})
    second = bench.read("XACTUAL", axis)
    assert (flag in bench.flags(axis)) == inactive
    # the change is seen in the next tick, and looked at a millisecond later
    assert 0 < (second if inactive else first) - bench.read("XLATCH", axis) <= 110


@pytest.mark.parametrize("model", WITH_ENCODER)
def test_the_encoder_is_latched_with_it_if_wanted(model: Tmc5xxxModel) -> None:
    for wanted in (False, True):
        bench = moving(model, encoder={"lines": 12_800})
        bench.put(ENC_CONST=1 << 16, SW_MODE=LATCH_L_ON | LATCH_ENCODER * wanted, XTARGET=TURN)
        bench.wait(2)
        bench.stage(switches={"left": True})
        assert bench.read("XLATCH") == TURN
        assert bench.read("ENC_LATCH") == (TURN if wanted else 0)


@pytest.mark.parametrize("model", MODELS)
def test_a_stop_waits_tzerowait_before_the_way_back(model: Tmc5xxxModel) -> None:
    bench = moving(model)
    bench.put(TZEROWAIT=31_250, SW_MODE=STOP_R, RAMPMODE=FORWARD)
    bench.wait(0.5)
    bench.stage(switches={"right": True})
    bench.put(RAMPMODE=BACKWARD)
    bench.wait(0.9)
    assert bench.read("VACTUAL") == 0
    bench.wait(0.2)
    assert bench.read("VACTUAL") < 0
