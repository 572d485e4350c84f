"""Steps, thresholds and delays of the TMC5xxx in clocks, there and back over whole ranges."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from app.calc.units import tmc5xxx_times as times
from app.calc.units.tmc5xxx import VELOCITY_MAX, velocity_pps, velocity_unit_pps

clocks = st.floats(4e6, 18e6)
resolutions = st.sampled_from(times.RESOLUTIONS)


@pytest.mark.sheet("FM-PD42-1241", "6.1")
def test_steps_of_one_turn_a_second() -> None:
    """200 full steps of 256 microsteps at 16 MHz."""
    assert times.tstep(51_200) == 312
    assert times.tstep(200, microsteps=1) == 312


def test_at_standstill_and_slower_than_it_can_count_the_step_time_is_the_longest() -> None:
    assert times.tstep(0) == times.TSTEP_MAX
    assert times.tstep(1) == times.TSTEP_MAX
    assert times.tstep(-51_200) == 312


@given(units=st.integers(17, VELOCITY_MAX), clock_hz=clocks)
def test_a_step_takes_2_to_the_24_over_the_velocity(units: int, clock_hz: float) -> None:
    """DS-TMC5160 12.1: TSTEP = 2^24 / V at 256 microsteps, whatever the clock is."""
    assert abs(times.tstep(velocity_pps(units, clock_hz), 256, clock_hz) - (1 << 24) / units) <= 1


@given(values=st.lists(st.floats(-7e6, 7e6), min_size=1, max_size=5))
def test_arrays_are_scalars_side_by_side(values: list[float]) -> None:
    assert np.asarray(times.tstep(values)).tolist() == [times.tstep(value) for value in values]


@given(raw=st.integers(1, times.TSTEP_MAX), microsteps=resolutions, clock_hz=clocks, small=st.booleans())
def test_a_threshold_switches_at_its_velocity_and_a_little_above(
    raw: int, microsteps: int, clock_hz: float, small: bool
) -> None:
    """DS-TMC5160, TSTEP: the second number compared with is 15/16 (31/32) of it less 1."""
    found = times.threshold(raw, microsteps, clock_hz, small)
    assert found.falling_pps * raw * 256 / microsteps == pytest.approx(clock_hz)
    assert found.rising_pps > found.falling_pps
    part = 31 / 32 if small else 15 / 16
    if raw * part > 1.001:
        assert clock_hz / (found.rising_pps * 256 / microsteps) == pytest.approx(raw * part - 1)
    else:
        assert math.isinf(found.rising_pps), "no motor is so fast"
    near = found.falling_pps * (1 - 1e-9)
    assert times.tstep(near, microsteps, clock_hz) in (raw, raw + 1, times.TSTEP_MAX)


def test_a_threshold_of_0_is_never_reached() -> None:
    assert times.threshold(0).falling_pps == math.inf
    with pytest.raises(ValueError, match="TSTEP is 0 to 1048575"):
        times.threshold(1 << 20)


@given(pps=st.floats(0, 1), clock_hz=clocks)
def test_thresholds_in_velocity_do_not_look_at_eight_bits(pps: float, clock_hz: float) -> None:
    """DS-TMC5072 6.2.2: bits 22..8 are compared."""
    highest = VELOCITY_MAX * velocity_unit_pps(clock_hz)
    raw = times.velocity_threshold(pps * highest, clock_hz)
    assert raw % 256 == 0
    assert 0 <= raw <= VELOCITY_MAX
    assert abs(raw - pps * VELOCITY_MAX) <= 256
    with pytest.raises(ValueError, match="threshold is 0 to"):
        times.velocity_threshold(highest * 1.001, clock_hz)


def test_the_longest_pause() -> None:
    """DS-TMC5160, TZEROWAIT: about 0 to 2 seconds."""
    assert times.zero_wait_s(times.WAIT_MAX) == pytest.approx(2.097, abs=1e-3)
    assert times.zero_wait_s(1, 12e6) == 512 / 12e6


@given(raw=st.integers(0, 255), clock_hz=clocks, first_free=st.booleans())
def test_power_down_delays_there_and_back(raw: int, clock_hz: float, first_free: bool) -> None:
    assume(not (first_free and raw == 1))
    assert times.power_down(times.power_down_s(raw, clock_hz, first_free), clock_hz, first_free) == raw


def test_a_tmc5130_counts_power_down_from_a_single_clock() -> None:
    """DS-TMC5130 6.2: 0 none, 1 the least, else one less times 2^18."""
    assert times.power_down_s(0, 16e6, first_free=True) == 0
    assert times.power_down_s(1, 16e6, first_free=True) == 1 / 16e6
    assert times.power_down_s(2, 16e6, first_free=True) == times.power_down_s(1) == 0.016384
    assert times.power_down_s(255) == pytest.approx(4.18, abs=0.01)
    with pytest.raises(ValueError, match="TPOWERDOWN"):
        times.power_down(5.0)


def test_from_run_to_hold_current() -> None:
    """The sheets' example: IRUN 31, IHOLD 16, IHOLDDELAY 4 take roughly a second at 16 MHz."""
    assert times.hold_delay_s(4, 15) == pytest.approx(0.983, abs=1e-3)
    assert times.hold_delay(1.0, 15) == 4
    assert times.hold_delay(1.0, 0) == 0
    with pytest.raises(ValueError, match="IHOLDDELAY is 0 to"):
        times.hold_delay(10.0, 15)
    with pytest.raises(ValueError, match="0 to 31 steps"):
        times.hold_delay_s(1, 32)


def test_what_cannot_be() -> None:
    with pytest.raises(ValueError, match="microsteps"):
        times.tstep(1000, microsteps=3)
    with pytest.raises(ValueError, match="finite"):
        times.tstep(float("inf"))
    with pytest.raises(ValueError, match="TZEROWAIT is 0 to 65535"):
        times.zero_wait_s(65_536)
    with pytest.raises(ValueError, match="IHOLDDELAY is 0 to 15"):
        times.hold_delay_s(16, 1)
    with pytest.raises(ValueError, match="clock_hz"):
        times.zero_wait_s(1, 0)
