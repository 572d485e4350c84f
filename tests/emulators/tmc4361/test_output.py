"""Step output, filters, freeze, clocks, stall stop and cover datagrams of an emulated TMC4361."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.emulators.tmc4361.rig import (
    HOLD_POSITION,
    HOLD_VELOCITY,
    S_VELOCITY,
    TICK_S,
    TRAPEZOID_POSITION,
    TRAPEZOID_VELOCITY,
    Ramp,
    Rig,
)

BASE = Ramp(vmax=20_000.0)


@pytest.mark.sheet("DS-TMC4361", "1.4")
@pytest.mark.sheet("DS-TMC4361", "8.1")
@pytest.mark.parametrize(
    ("add", "toggle", "fastest"), [(0, False, 8e6), (3, False, 2e6), (6, False, 16e6 / 14), (3, True, 4e6)]
)
def test_pulses_merge_where_they_are_too_long_for_the_rate(add: int, toggle: bool, fastest: float) -> None:
    for share, merges in ((0.97, False), (1.1, True)):
        if share * fastest > 8.3e6:
            continue
        rig = Rig()
        rig.write("GENERAL_CONF", 0x6020 | toggle << 4)
        rig.write("STP_LENGTH_ADD___DIR_SETUP_TIME", add)
        rig.ramp(Ramp(vmax=share * fastest), HOLD_VELOCITY)
        rig.wait(0.1)
        output = rig.state().step_output
        assert (output.steps_merged > 0) is merges
        assert output.steps_sent == pytest.approx(min(share, 1.0) * fastest * 0.1, rel=1e-3)
        assert output.steps_sent + output.steps_merged == pytest.approx(rig.position, abs=1)


@pytest.mark.sheet("DS-TMC4361", "8.1")
def test_no_step_leaves_in_the_setup_time_of_the_direction() -> None:
    rig = Rig()
    rig.write("STP_LENGTH_ADD___DIR_SETUP_TIME", 16_000 << 16)  # 1 ms
    rig.ramp(BASE, HOLD_POSITION)
    rig.write("XTARGET", -1000)
    rig.wait(1e-3 - TICK_S)
    output = rig.state().step_output
    assert output.steps_sent == 0
    assert output.steps_held == rig.position < -15
    assert rig.state().pins.direction  # pol_dir_out: high for the negative direction
    rig.wait(0.1)
    output = rig.state().step_output
    assert (output.steps_sent, output.steps_held, output.steps_merged, output.direction_changes) == (1000, 0, 0, 1)
    assert output.microsteps_256 == -1000


@pytest.mark.sheet("DS-TMC4361", "8.1")
def test_polarities_of_the_step_and_direction_outputs() -> None:
    rig = Rig()
    assert not rig.state().pins.step
    assert not rig.state().pins.direction
    rig.write("GENERAL_CONF", 0x6000 | 1 << 3)
    assert rig.state().pins.step
    assert rig.state().pins.direction


@pytest.mark.sheet("DS-TMC4361", "8.1")
def test_with_toggle_step_an_odd_number_of_steps_leaves_the_level_changed() -> None:
    rig = Rig()
    rig.write("GENERAL_CONF", 0x6020 | 1 << 4)
    rig.ramp(BASE, HOLD_POSITION)
    rig.write("XTARGET", 3)
    rig.wait(0.1)
    assert rig.state().pins.step
    rig.write("XTARGET", 4)
    rig.wait(0.1)
    assert not rig.state().pins.step


@pytest.mark.sheet("DS-TMC4361", "17.11")
@pytest.mark.parametrize(("resolution", "microsteps"), [(0, 1), (4, 16), (8, 256)])
def test_a_step_is_what_mstep_per_fs_says(resolution: int, microsteps: int) -> None:
    rig = Rig()
    rig.write("STEP_CONF", 0xFB0C80 | resolution)
    rig.ramp(Ramp(vmax=500.0), HOLD_POSITION)
    rig.write("XTARGET", 30)
    rig.wait(1.0)
    assert rig.state().step_output.microsteps_256 == 30 * microsteps
    assert rig.read("MSCNT") == 30 * microsteps % 1024


# --- filters ---------------------------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "6")
@pytest.mark.sheet("DS-TMC4361", "6.1.1")
@pytest.mark.sheet("DS-TMC4361", "17.4")
@pytest.mark.sheet("DS-TMC4361", "6.1")
@pytest.mark.parametrize(("rate", "length", "delay_clocks"), [(0, 0, 0), (7, 7, 7 * 128), (7, 0, 0), (3, 7, 7 * 8)])
def test_a_switch_passes_its_filter_before_it_stops(rate: int, length: int, delay_clocks: int) -> None:
    rig = Rig()
    rig.write("INPUT_FILT_CONF", rate << 8 | length << 12)
    rig.write("REFERENCE_CONF", 0b1010)  # STOPR, high active
    rig.ramp(BASE, HOLD_VELOCITY)
    rig.wait(0.1)
    rig.patch(switches={"right": True})
    rig.wait(max(delay_clocks / 16e6 - TICK_S, 0))
    if delay_clocks > 128:
        assert rig.signed("VACTUAL") == 20_000
    rig.wait((1 << rate) / 16e6 + 3 * TICK_S)
    assert rig.signed("VACTUAL") == 0


@pytest.mark.sheet("DS-TMC4361", "6.1.2")
def test_a_glitch_shorter_than_the_filter_is_not_seen() -> None:
    rig = Rig()
    rig.write("INPUT_FILT_CONF", 7 << 8 | 7 << 12)  # 56 to 64 us
    rig.write("REFERENCE_CONF", 0b1010)
    rig.ramp(BASE, HOLD_VELOCITY)
    for _ in range(20):
        rig.patch(switches={"right": True})
        rig.wait(50e-6)
        rig.patch(switches={"right": False})
        rig.wait(13e-6)
    assert rig.signed("VACTUAL") == 20_000
    assert "STOPR_EVENT" not in rig.events()


# --- freeze ----------------------------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "12")
@pytest.mark.sheet("DS-TMC4361", "12.1")
@pytest.mark.sheet("DS-TMC4361", "1.3.7")
@pytest.mark.parametrize(("dfreeze", "seconds"), [(0, 0.0), (537, 0.02)])
def test_nfreeze_stops_and_only_a_reset_ends_it(dfreeze: int, seconds: float) -> None:
    rig = Rig()
    rig.write("FREEZE", dfreeze)
    rig.ramp(BASE, S_VELOCITY)
    rig.wait(0.5)
    rig.patch(pins={"freeze": False})
    rig.wait(seconds / 2 + 2 * TICK_S)
    assert rig.signed("VACTUAL") == pytest.approx(10_000 if dfreeze else 0, abs=100)  # 1 Mpps^2
    rig.patch(pins={"freeze": "auto"})
    rig.wait(0.1)
    assert "FROZEN" in rig.events()
    assert rig.signed("VACTUAL") == 0
    rig.write("VMAX", 1000 << 8)
    rig.write("RAMPMODE", HOLD_VELOCITY)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == 0
    assert rig.state().ramp.frozen
    rig.write("RESET_CLK_GATING", 0x52535400)
    rig.ramp(BASE, HOLD_VELOCITY)
    assert rig.signed("VACTUAL") == 20_000


def test_nfreeze_needs_three_clocks() -> None:
    rig = Rig()
    rig.patch(pins={"freeze": False})
    rig.wait(1e-7)  # less than two
    rig.patch(pins={"freeze": "auto"})
    rig.wait(0.1)
    assert "FROZEN" not in rig.events()


@pytest.mark.sheet("DS-TMC4361", "17.17")
def test_freeze_is_written_once_and_at_rest() -> None:
    rig = Rig()
    rig.ramp(BASE, HOLD_VELOCITY)
    rig.write("FREEZE", 5)
    assert rig.read("FREEZE") == 0
    rig.write("VMAX", 0)
    rig.wait(0.1)
    rig.write("FREEZE", 6)
    rig.write("FREEZE", 7)
    assert rig.read("FREEZE") == 6


# --- clocks, stall, cover --------------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "16.1")
@pytest.mark.sheet("DS-TMC4361", "17.18")
def test_clocks_are_gated_on_request_and_a_datagram_wakes_them() -> None:
    rig = Rig()
    rig.write("GENERAL_CONF", 0x6020 | 1 << 17)
    rig.write("CLK_GATING_DELAY", 16_000)
    rig.write("RESET_CLK_GATING", 7)
    rig.wait(5e-4)
    assert not rig.state().ramp.clocks_gated
    rig.wait(1e-3)
    assert rig.state().ramp.clocks_gated
    rig.patch(switches={"left": True})
    rig.wait(0.1)
    assert rig.state().ramp.clocks_gated
    assert rig.read("RESET_CLK_GATING") & 7 == 0
    assert not rig.state().ramp.clocks_gated
    rig.ramp(BASE, TRAPEZOID_POSITION)
    rig.write("XTARGET", 100)
    rig.wait(1.0)
    assert rig.position == 100


@pytest.mark.sheet("DS-TMC4361", "16.1")
def test_start_wakes_gated_clocks() -> None:
    rig = Rig()
    rig.write("GENERAL_CONF", 0x6020 | 1 << 17)
    rig.write("RESET_CLK_GATING", 7)
    rig.wait(1e-3)
    assert rig.state().ramp.clocks_gated
    rig.patch(pins={"start": False})
    rig.wait(1e-3)
    assert not rig.state().ramp.clocks_gated


def test_standby_comes_after_its_delay_and_goes_with_motion() -> None:
    rig = Rig()
    rig.write("GENERAL_CONF", 0x20)  # STDBY_CLK tells standby, low active
    rig.write("STDBY_DELAY", 160_000)  # 10 ms
    rig.ramp(BASE, HOLD_POSITION)
    rig.write("XTARGET", 200)
    rig.wait(0.015)
    assert not rig.state().ramp.standby
    rig.wait(0.01)
    assert rig.state().ramp.standby
    rig.write("XTARGET", 0)
    assert not rig.state().ramp.standby


def test_a_stall_stops_and_holds_until_driving_on_is_allowed() -> None:
    rig = Rig()
    rig.write("VSTALL_LIMIT", 1000)
    rig.write("REFERENCE_CONF", 1 << 26)
    rig.ramp(replace(BASE, vmax=50_000.0), TRAPEZOID_VELOCITY)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == 50_000
    rig.patch(blocked=True)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == 0
    assert "STOP_ON_STALL" in rig.events()
    rig.patch(blocked=False)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == 0
    rig.write("REFERENCE_CONF", 1 << 26 | 1 << 27)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == 50_000


def test_below_vstall_limit_a_stall_stops_nothing() -> None:
    rig = Rig()
    rig.write("VSTALL_LIMIT", 100_000)
    rig.write("REFERENCE_CONF", 1 << 26)
    rig.ramp(replace(BASE, vmax=50_000.0), TRAPEZOID_VELOCITY)
    rig.patch(blocked=True)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == 50_000


@pytest.mark.sheet("DS-TMC4361", "11.4")
def test_cover_datagrams_reach_the_driver_and_its_answer_comes_back() -> None:
    rig = Rig()
    rig.write("SPI_OUT_CONF", 8 << 20 | 8 << 24 | 10)  # 16 clocks a bit, TMC26x
    rig.events()
    rig.write("COVER_LOW", 0xD001F)  # SGCSCONF
    assert "COVER_DONE" not in rig.events()
    rig.wait(20 * 16 / 16e6 + 2 * TICK_S)
    assert "COVER_DONE" in rig.events()
    assert rig.state().driver_words == {"SGCSCONF": 0xD001F}
    rig.ramp(Ramp(vmax=500.0), HOLD_POSITION)
    rig.write("XTARGET", 300)
    rig.wait(1.0)
    rig.write("COVER_LOW", 0xE0000)  # DRVCONF: answers show the microstep
    assert rig.read("COVER_DRV_LOW") >> 10 == 300


@pytest.mark.sheet("DS-TMC4361", "7.2")
def test_motor_events_are_those_of_the_selected_driver_flags() -> None:
    rig = Rig()
    rig.write("STEP_CONF", 0x0C80 | 1 << (16 + 5))  # OLA alone
    rig.wait(0.1)
    rig.events()
    rig.patch(motor={"temperature_c": 130.0})
    rig.wait(0.1)
    assert rig.flag(26)
    assert "MOTOR_EV" not in rig.events()
    rig.patch(motor={"connected": False})
    rig.wait(0.1)
    assert rig.flag(29)
    assert "MOTOR_EV" in rig.events()
