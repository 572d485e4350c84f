"""Many S-ramps at once are what each of them is alone, in any shape."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from app.calc.ramps.sramp import SRamp, position_plan
from app.calc.ramps.sramp_many import PHASES, plan_many
from tests.calc.sramp_strategies import distances, ramps, states


@settings(max_examples=50)
@given(data=st.data())
def test_general_moves_are_those_of_position_plan(data: st.DataObject) -> None:
    p = data.draw(ramps())
    moves = [data.draw(distances(p)) for _ in range(4)]
    v, a = data.draw(states(p)) if data.draw(st.booleans()) else (0.0, 0.0)
    plans = plan_many(
        moves,
        vmax=p.vmax,
        amax=p.amax,
        dmax=p.dmax,
        bow1=p.bow1,
        bow2=p.bow2,
        bow3=p.bow3,
        bow4=p.bow4,
        vstart=p.vstart,
        vstop=p.vstop,
        astart=p.astart,
        use_astart_and_vstart=p.use_astart_and_vstart,
        v_actual=v,
        a_actual=a,
    )
    for i, distance in enumerate(moves):
        plan = position_plan(p, distance, v, a)
        assert plans.duration_s[i] == pytest.approx(plan.duration_s, rel=1e-12)
        assert plans.peak_velocity_pps[i] == plan.limits[0].peak
        for phase, time_s in zip(PHASES, plans.phase_s[i], strict=True):
            mine = sum(piece.end_s - piece.start_s for piece in plan.pieces if piece.name == phase)
            assert time_s == pytest.approx(mine, rel=1e-9, abs=1e-12 * plan.duration_s)


def test_shapes_broadcast_and_rates_default_to_the_rising_slope() -> None:
    bows = np.array([1e5, 1e6, 1e7])
    plans = plan_many([[100.0], [20_000.0]], vmax=50_000, amax=200_000, bow1=bows)
    assert plans.duration_s.shape == (2, 3)
    assert plans.phase_s.shape == (2, 3, 7)
    alone = position_plan(SRamp(50_000, 200_000, 200_000, 1e6, 1e6, 1e6, 1e6), 20_000)
    assert plans.duration_s[1, 1] == alone.duration_s
    assert np.all(np.diff(plans.duration_s, axis=1) < 0)  # steeper bows are faster
    assert plan_many(5.0, vmax=1, amax=1, bow1=1).duration_s.shape == ()
    assert plan_many([], vmax=1, amax=1, bow1=1).duration_s.shape == (0,)


@pytest.mark.parametrize("bad", [0.0, -1.0, float("nan"), float("inf")])
def test_bad_parameters_are_named(bad: float) -> None:
    good: dict[str, ArrayLike] = {"vmax": 1.0, "amax": 1.0, "bow1": 1.0}
    for name in ("vmax", "amax", "dmax", "bow1", "bow2", "bow3", "bow4"):
        with pytest.raises(ValueError, match=f"{name} is finite and above 0"):
            plan_many(1.0, **(good | {name: [1.0, bad]}))


def test_other_bad_input_is_named() -> None:
    with pytest.raises(ValueError, match="vstop is finite and not below 0, got -1"):
        plan_many(1.0, vmax=1, amax=1, bow1=1, vstop=-1)
    with pytest.raises(ValueError, match="distance"):
        plan_many([1.0, 2.0**32], vmax=1, amax=1, bow1=1)
    with pytest.raises(ValueError, match="distance"):
        plan_many(float("nan"), vmax=1, amax=1, bow1=1)
    with pytest.raises(ValueError, match="a_actual is finite"):
        plan_many(1.0, vmax=1, amax=1, bow1=1, a_actual=float("nan"))
    with pytest.raises(ValueError, match="broadcast"):
        plan_many([1.0, 2.0], vmax=[1, 2, 3], amax=1, bow1=1)
