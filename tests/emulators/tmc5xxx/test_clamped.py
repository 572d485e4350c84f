"""StallGuard2 of a clamped shaft, which gives no back-EMF, and of a free one."""

from __future__ import annotations

import pytest

from app.emulators.tmc5xxx import MODELS, Tmc5xxxModel
from tests.emulators.tmc5xxx.rig import FORWARD, ONE_TURN_A_SECOND, PLACES, SINGLE, moving
from tests.emulators.tmc5xxx.test_driver import SG_STOP, load_value


def window_of(model: Tmc5xxxModel) -> dict[str, int]:
    """Thresholds between which StallGuard2 acts, at any moderate velocity."""
    return {"TCOOLTHRS": 0xFFFFF} if model in SINGLE else {"VCOOLTHRS": 256, "VHIGH": 0x7FFFFF}


@pytest.mark.parametrize("sgt", [6, 7, 8, 9])
@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_a_clamped_shaft_gives_no_back_emf_and_stalls(model: Tmc5xxxModel, axis: int, sgt: int) -> None:
    """The maker's demo motors stall at such thresholds; IRUN 13."""
    for velocity in (20_000, ONE_TURN_A_SECOND, 4 * ONE_TURN_A_SECOND):
        bench = moving(model, axis, rigid=False, current=13)
        bench.put(axis, COOLCONF=sgt << 16, VMAX=velocity, **window_of(model))
        bench.stage(axis, blocked=True)
        bench.put(axis, RAMPMODE=FORWARD)
        bench.wait(1)
        assert bench.read("VACTUAL", axis) == velocity
        for _ in range(20):
            bench.wait(0.02)
            assert bench.field("DRV_STATUS", "SG_RESULT", axis) == 0
            assert bench.field("DRV_STATUS", "StallGuard", axis) == 1
        bench.put(axis, SW_MODE=SG_STOP)
        bench.wait(0.1)
        assert bench.read("VACTUAL", axis) == 0
        assert "event_stop_sg" in bench.flags(axis)


@pytest.mark.parametrize("sgt", [0, 6, 9])
@pytest.mark.parametrize("model", MODELS)
def test_a_free_motor_does_not_stall_at_moderate_speed(model: Tmc5xxxModel, sgt: int) -> None:
    for velocity in (20_000, ONE_TURN_A_SECOND, 4 * ONE_TURN_A_SECOND):
        bench = moving(model, rigid=False, current=13)
        bench.put(COOLCONF=sgt << 16, VMAX=velocity, RAMPMODE=FORWARD, **window_of(model))
        bench.wait(1)
        bench.put(SW_MODE=SG_STOP)
        for _ in range(20):
            bench.wait(0.02)
            assert bench.field("DRV_STATUS", "SG_RESULT") > 150
        assert bench.read("VACTUAL") == velocity


@pytest.mark.parametrize("model", MODELS)
def test_a_threshold_that_is_far_too_high_misses_a_clamped_shaft(model: Tmc5xxxModel) -> None:
    bench = moving(model, rigid=False, current=13)
    bench.put(COOLCONF=40 << 16, RAMPMODE=FORWARD, **window_of(model))
    bench.stage(blocked=True)
    bench.wait(1)
    assert load_value(bench) > 100
