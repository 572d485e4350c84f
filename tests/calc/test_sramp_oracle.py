"""S-ramps with four different bows and AMAX unlike DMAX against a simulation by small steps, from any state."""

from __future__ import annotations

from hypothesis import example, given, settings
from hypothesis import strategies as st

from app.calc.ramps.sramp import SRamp, position_plan, velocity_plan
from tests.calc import sramp_oracle
from tests.calc.sramp_strategies import decades

STEPS = 250
near_one = decades(0.5, 2.0)


@st.composite
def moderate_ramps(draw: st.DrawFn) -> SRamp:
    vmax, amax, dmax, bow1, bow2, bow3, bow4 = (draw(near_one) for _ in range(7))
    return SRamp(vmax, amax, dmax, bow1, bow2, bow3, bow4)


def agree(p: SRamp, distance: float, v: float, a: float, steps: int) -> bool:
    """Whether a simulation by so many steps takes as long as planned, within what a step is worth."""
    dt = max(position_plan(p, distance, v, a).duration_s, 1.0) / steps
    # Braking begins with a whole step, whose way decides if a motor that can just stop has to come back.
    shift = max(abs(v), p.vmax) * dt
    planned = [position_plan(p, distance + off, v, a).duration_s for off in (-shift, 0.0, shift)]
    return min(planned) - 10 * dt <= sramp_oracle.move_time(p, distance, v, a, dt) <= max(planned) + 10 * dt


@settings(max_examples=20)
@given(p=moderate_ramps(), distance=st.floats(-6, 6), v=st.floats(-2, 2), a=st.floats(-1, 1))
@example(SRamp(1.0, 1.0, 1.3956124250860895, 1.0, 0.508620315018538, 1.2840254166877414, 1.0), 2.0, 0.96875, 0.5)
def test_moves(p: SRamp, distance: float, v: float, a: float) -> None:
    # Where a coarse step happens to miss the moment to brake, the simulation comes back, which a planner need not:
    # a finer one has to agree then, within less.
    assert agree(p, distance, v, a, STEPS) or agree(p, distance, v, a, 4 * STEPS)


@settings(max_examples=30)
@given(p=moderate_ramps(), target=st.floats(-3, 3), v=st.floats(-3, 3), a=st.floats(-2, 2))
def test_changes_of_velocity(p: SRamp, target: float, v: float, a: float) -> None:
    planned = velocity_plan(p, target, v, a).duration_s
    dt = max(planned, 1.0) / STEPS
    assert abs(sramp_oracle.velocity_time(p, target, v, a, dt) - planned) <= 20 * dt
