"""An emulated TMC4361 in time: slices change nothing, standing still costs nothing, moves end exactly."""

from __future__ import annotations

import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.clock import VirtualClock
from app.emulators.build import build_emulator, options_of, warm_up
from app.emulators.tmc4361 import EmulatedTmc4361, Tmc4361Options
from app.errors import OutOfRange
from tests.emulators.tmc4361.moves import ending
from tests.emulators.tmc4361.rig import MODES, Ramp, Rig

_ACTIONS = st.lists(
    st.tuples(
        st.floats(0.0, 0.05),
        st.sampled_from(("XTARGET", "VMAX", "RAMPMODE", "DMAX", "XACTUAL", "switch", "pulses", "block")),
        st.integers(-8000, 8000),
    ),
    max_size=6,
)


def act(rig: Rig, what: str, value: int) -> None:
    match what:
        case "switch":
            rig.patch(switches={"right": bool(value & 1), "home": bool(value & 2)})
        case "pulses":
            rig.patch(step_dir={"pulses": value, "rate_hz": 3000.0})
        case "block":
            rig.patch(blocked=bool(value & 1), load_torque_nm=value / 1e5)
        case "RAMPMODE":
            rig.write(what, MODES[value % len(MODES)])
        case "VMAX":
            rig.write(what, value << 8)
        case "DMAX":
            rig.write(what, abs(value) * 100)
        case _:
            rig.write(what, value)


def everything(rig: Rig) -> tuple[bytes, ...]:
    chip = rig.chip._chip
    rig.state()
    idle = np.array(chip.s)
    return chip.r.tobytes(), idle.tobytes(), chip.f.tobytes(), chip.feedback.fb.tobytes()


@settings(max_examples=30, deadline=None)
@given(_ACTIONS, st.integers(0, 2**32), st.sampled_from(MODES))
def test_it_makes_no_difference_in_how_many_slices_time_passes(
    actions: list[tuple[float, str, int]], seed: int, mode: int
) -> None:
    slicer = random.Random(seed)
    whole, sliced = Rig(), Rig()
    for rig in (whole, sliced):
        rig.write("REFERENCE_CONF", 0b1010 | 1 << 13)
        rig.write("ENC_IN_RES", 40_000)
        rig.ramp(Ramp(vmax=30_000.0, dstop=50_000.0), mode)
    for seconds, what, value in (*actions, (0.05, "XTARGET", 77)):
        end_s = whole.now_s + seconds
        whole.now_s = end_s
        while sliced.now_s < end_s:
            sliced.now_s = min(end_s, sliced.now_s + slicer.choice((1e-6, 1e-4, 3e-3, 0.02)))
            sliced.state()
        act(whole, what, value)
        act(sliced, what, value)
        assert everything(whole) == everything(sliced)


@pytest.mark.sheet("DS-TMC4361", "8.2")
@pytest.mark.parametrize("seed", range(25))
def test_moves_changed_on_the_fly_end_on_their_target(seed: int) -> None:
    found = ending(random.Random(seed))
    assert found.exact, found


def test_a_chip_that_stands_costs_nothing_and_wakes_as_it_was() -> None:
    """Ticks that are passed over change no cell but time."""
    rig = Rig()
    rig.wait(10.0)
    rig.state()
    chip = rig.chip._chip
    before = everything(rig)
    rig.wait(1e6)  # 2.5e11 ticks: nobody could wait for them
    after = everything(rig)
    assert (before[0], before[2], before[3]) == (after[0], after[2], after[3])
    assert chip.s[0] == int((rig.now_s * 16e6) // 64)


def test_it_is_built_by_name_with_options_of_its_own() -> None:
    assert options_of("tmc4361") is Tmc4361Options
    chip = build_emulator("tmc4361", VirtualClock(), Tmc4361Options(clock_hz=8e6))
    assert isinstance(chip, EmulatedTmc4361)
    assert chip.state().clock_hz == 8e6
    with pytest.raises(TypeError, match="no options of a tmc428"):
        build_emulator("tmc428", VirtualClock(), Tmc4361Options())
    warm_up()


def test_catching_up_goes_in_slices() -> None:
    clock = VirtualClock()
    chip = EmulatedTmc4361(clock)
    clock.set(2.5)
    assert not chip.caught_up()
    assert [chip.catch_up(1.0) for _ in range(3)] == [False, False, True]
    assert chip.caught_up()


def test_time_scale_runs_the_chip_faster() -> None:
    clock = VirtualClock()
    chip = EmulatedTmc4361(clock, Tmc4361Options(time_scale=2.0))
    clock.set(3.0)
    assert chip.state().chip_time_s == 6.0


def test_another_oscillator_makes_everything_faster() -> None:
    slow, fast = Rig(Tmc4361Options(clock_hz=16e6)), Rig(Tmc4361Options(clock_hz=32e6))
    for rig in (slow, fast):
        rig.ramp(Ramp(), 0)  # CLK_FREQ says 16 MHz to both
        rig.wait(0.1)
    assert slow.position == pytest.approx(5000, abs=1)
    assert fast.position == pytest.approx(10_000, abs=1)


def test_the_stage_is_changed_and_refuses_switches_that_cross() -> None:
    rig = Rig()
    state = rig.patch(stage={"left_at_fullsteps": -10.0, "position_fullsteps": -12.0})
    assert state.stage.left_at_fullsteps == -10.0
    assert state.switches.left.active
    assert state.stage.position_fullsteps == pytest.approx(-12.0, abs=0.5)
    with pytest.raises(OutOfRange):
        rig.patch(stage={"right_at_fullsteps": -20.0})
    with pytest.raises(OutOfRange):
        rig.patch(stage={"home_from_fullsteps": 5.0})
