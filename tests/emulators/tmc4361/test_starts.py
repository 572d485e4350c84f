"""Starts, pipelines, shadow registers and the step input of an emulated TMC4361."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.emulators.tmc4361.rig import HOLD_POSITION, HOLD_VELOCITY, S_POSITION, TICK_S, TRAPEZOID_POSITION, Ramp, Rig

BASE = Ramp(vmax=20_000.0)
XTARGET_WAITS, VMAX_WAITS, RAMPMODE_WAITS, GEAR_WAITS, SHADOW = (1 << n for n in range(5))
BY_PIN, BY_TARGET, BY_VELOCITY, BY_COMPARE, PIN_HIGH, AT_ONCE, BUSY = (1 << n for n in range(5, 12))


def pulse(rig: Rig) -> None:
    """A start pulse of 100 us at START."""
    rig.patch(pins={"start": True})
    rig.wait(1e-4)
    rig.patch(pins={"start": "auto"})
    rig.wait(1e-4)


@pytest.mark.sheet("DS-TMC4361", "10.1")
@pytest.mark.sheet("DS-TMC4361", "17.3")
def test_a_gated_target_waits_for_the_start() -> None:
    rig = Rig()
    rig.ramp(BASE, TRAPEZOID_POSITION)
    rig.write("START_CONF", XTARGET_WAITS | BY_PIN | PIN_HIGH)
    rig.write("XTARGET", 1000)
    assert rig.signed("XTARGET") == 1000
    rig.wait(1.0)
    assert rig.position == 0
    pulse(rig)
    rig.wait(1.0)
    assert rig.position == 1000
    assert rig.state().ramp.starts == 1


@pytest.mark.sheet("DS-TMC4361", "10.1")
@pytest.mark.parametrize(("bit", "register"), [(VMAX_WAITS, "VMAX"), (RAMPMODE_WAITS, "RAMPMODE")])
def test_other_registers_can_wait_too(bit: int, register: str) -> None:
    rig = Rig()
    rig.ramp(BASE, HOLD_VELOCITY)
    rig.wait(0.1)
    rig.write("START_CONF", bit | BY_PIN | PIN_HIGH)
    rig.write(register, {"VMAX": 1000 << 8, "RAMPMODE": HOLD_POSITION}[register])
    assert rig.signed("VACTUAL") == 20_000
    pulse(rig)
    assert rig.signed("VACTUAL") == {"VMAX": 1000, "RAMPMODE": -20_000}[register]


def test_what_no_longer_waits_counts_at_once() -> None:
    rig = Rig()
    rig.ramp(BASE, TRAPEZOID_POSITION)
    rig.write("START_CONF", XTARGET_WAITS | BY_PIN)
    rig.write("XTARGET", 1000)
    rig.write("START_CONF", 0)
    rig.wait(1.0)
    assert rig.position == 1000


@pytest.mark.sheet("DS-TMC4361", "10.1")
@pytest.mark.sheet("DS-TMC4361", "17.15")
@pytest.mark.parametrize(("conf", "delayed"), [(0, True), (AT_ONCE, False)])
def test_start_delay_counts_from_the_trigger_unless_the_pin_starts_at_once(conf: int, delayed: bool) -> None:
    rig = Rig()
    rig.ramp(BASE, HOLD_POSITION)
    rig.write("START_DELAY", 16_000)  # 1 ms
    rig.write("START_CONF", XTARGET_WAITS | BY_PIN | PIN_HIGH | conf)
    rig.write("XTARGET", 1000)
    rig.patch(pins={"start": True})
    rig.wait(1e-3 - 2 * TICK_S)
    assert (rig.signed("VACTUAL") == 0) is delayed
    rig.wait(4 * TICK_S)
    assert rig.signed("VACTUAL") == 20_000


@pytest.mark.sheet("DS-TMC4361", "6.1")
@pytest.mark.sheet("DS-TMC4361", "10.1")
def test_the_start_pin_has_a_polarity_and_a_filter() -> None:
    rig = Rig()
    rig.write("INPUT_FILT_CONF", 7 << 16 | 7 << 20)  # 64 us at least
    rig.write("START_CONF", SHADOW | BY_PIN)  # low active
    rig.wait(1e-3)
    rig.patch(pins={"start": False})
    rig.wait(5e-5)
    rig.patch(pins={"start": "auto"})
    rig.wait(1e-3)
    assert rig.state().ramp.starts == 0  # a glitch
    rig.patch(pins={"start": False})
    rig.wait(8e-5)
    assert rig.state().ramp.starts == 1


@pytest.mark.sheet("DS-TMC4361", "10.1")
def test_events_start_and_the_pin_shows_it() -> None:
    rig = Rig()
    rig.ramp(BASE, TRAPEZOID_POSITION)
    rig.write("START_OUT_ADD", 15_999)
    rig.write("START_CONF", XTARGET_WAITS | BY_TARGET)
    rig.write("XTARGET", 1000)
    rig.write("START_CONF", 0)
    rig.write("START_CONF", XTARGET_WAITS | BY_TARGET)
    rig.write("XTARGET", -500)  # waits till 1000 is reached
    while rig.position < 1000:
        rig.wait(1e-3)
    assert rig.state().pins.start_out
    rig.wait(2e-3)
    assert not rig.state().pins.start_out
    rig.wait(1.0)
    assert rig.position == -500


@pytest.mark.sheet("DS-TMC4361", "10.1")
def test_busy_chips_hold_the_start_back() -> None:
    rig = Rig()
    rig.ramp(BASE, TRAPEZOID_POSITION)
    rig.write("XACTUAL", 77)
    rig.write("XTARGET", 77)
    rig.write("START_CONF", XTARGET_WAITS | BY_COMPARE | BUSY | PIN_HIGH)
    rig.write("XTARGET", 1000)
    rig.patch(pins={"start": False})
    rig.write("POS_COMP", 77)
    rig.wait(0.5)
    assert rig.position == 77
    rig.patch(pins={"start": True})
    rig.wait(1.0)
    assert rig.position == 1000


# --- pipeline --------------------------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "10.2")
def test_the_pipeline_feeds_targets_one_a_start() -> None:
    rig = Rig()
    rig.ramp(replace(BASE, amax=1e6, dmax=1e6), TRAPEZOID_POSITION)
    targets = [300, -200, 100, 400, 50, 60, 70, 80]
    for n, target in enumerate(targets):
        rig.write(f"X_PIPE{n}", target)
    rig.write("START_CONF", XTARGET_WAITS | BY_PIN | PIN_HIGH | 1 << 12)
    for target in targets:
        pulse(rig)
        rig.wait(0.2)
        assert rig.position == target
    assert rig.signed("X_PIPE0") == 80  # the last stage keeps what it has


@pytest.mark.sheet("DS-TMC4361", "10.2")
def test_a_ring_rewrites_the_old_target() -> None:
    rig = Rig()
    rig.ramp(replace(BASE, amax=1e6, dmax=1e6), TRAPEZOID_POSITION)
    rig.write("XTARGET", 10)
    rig.wait(0.2)
    for n, target in enumerate((20, 30)):
        rig.write(f"X_PIPE{n}", target)
    rig.write("START_CONF", XTARGET_WAITS | BY_PIN | PIN_HIGH | 1 << 12 | 1 << (24 + 1))  # back into X_PIPE1
    seen = []
    for _ in range(6):
        pulse(rig)
        rig.wait(0.2)
        seen.append(rig.position)
    assert seen == [20, 30, 10, 20, 30, 10]


@pytest.mark.sheet("DS-TMC4361", "10.2")
def test_enabled_targets_share_the_stages() -> None:
    rig = Rig()
    for n in range(8):
        rig.write(f"X_PIPE{n}", 100 + n)
    rig.write("X_PIPE6", 0x6021)
    rig.write("START_CONF", BY_PIN | PIN_HIGH | 15 << 12 | SHADOW)
    pulse(rig)
    found = [rig.read(name) for name in ("XTARGET", "POS_COMP", "GEAR_RATIO", "GENERAL_CONF")]
    assert found == [100, 102, 104, 0x6021]
    assert [rig.read(f"X_PIPE{n}") for n in (0, 2, 4)] == [101, 103, 105]


@pytest.mark.sheet("DS-TMC4361", "10.2")
@pytest.mark.parametrize("way", [80, 83, 97, 100])
def test_a_start_by_the_target_begins_from_rest_however_the_last_tick_falls(way: int) -> None:
    """The last step of some ways fell a tick before the end of the ramp: TZEROWAIT was passed over then."""
    rig = Rig()
    rig.ramp(Ramp(20_000.0, 1e6, 1e6, 1e7, 1e7, 1e7, 1e7), S_POSITION)
    rig.write("TZEROWAIT", 160_000)  # 10 ms
    for n in range(8):
        rig.write(f"X_PIPE{n}", 2 * way)
    rig.write("START_CONF", BY_TARGET | 1 << 12)
    rig.write("XTARGET", way)
    for _ in range(1000):
        if rig.position == way:
            break
        rig.wait(1e-3)
    rig.wait(5e-3)
    assert (rig.position, rig.signed("VACTUAL")) == (way, 0)
    rig.wait(0.5)
    assert rig.position == 2 * way


# --- shadow registers ------------------------------------------------------------------------------------------------

_SETS = {
    0: "VMAX AMAX DMAX ASTART DFINAL VBREAK VSTART VSTOP BOW1 BOW2 BOW3 BOW4 RAMPMODE",
    1: "VMAX AMAX DMAX BOW1 BOW2 BOW3 BOW4",
    2: "VMAX AMAX DMAX ASTART DFINAL VBREAK VSTART",
    3: "VMAX AMAX DMAX ASTART DFINAL VBREAK VSTOP",
}


@pytest.mark.sheet("DS-TMC4361", "17.21")
@pytest.mark.parametrize("cyclic", [False, True])
@pytest.mark.parametrize("option", _SETS)
def test_shadow_registers_replace_those_of_the_ramp(option: int, cyclic: bool) -> None:
    rig = Rig()
    names = _SETS[option].split()
    for n, name in enumerate(names):
        rig.write(name, 1 + n % 2)
    for n in range(14):
        rig.write(f"SH_REG{n}", 4 + n % 2 if option == 0 and n == 12 else 100 + n)
    rig.write("START_CONF", SHADOW | BY_PIN | PIN_HIGH | option << 16 | cyclic << 18)
    pulse(rig)
    first = [4 if option == 0 and n == 12 else 100 + n for n in range(len(names))]
    assert [rig.read(name) for name in names] == first
    pulse(rig)
    second = [rig.read(name) for name in names]
    if option == 0:
        assert second == ([1 + n % 2 for n in range(13)] if cyclic else first)
    else:
        assert second == [107 + n for n in range(7)]
        pulse(rig)
        assert [rig.read(name) for name in names] == ([1 + n % 2 for n in range(7)] if cyclic else second)


def test_shadow_miss_cnt_skips_starts() -> None:
    rig = Rig()
    rig.write("SH_REG0", 777)
    rig.write("START_CONF", SHADOW | BY_PIN | PIN_HIGH | 2 << 20)
    for expected in (0, 0, 777):
        pulse(rig)
        assert rig.read("VMAX") == expected


# --- step input ------------------------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "17.1")
@pytest.mark.parametrize(("mode", "factor"), [(1, 1), (2, 1), (3, 2)])
@pytest.mark.parametrize("ratio", [1.0, 2.5, -0.25])
def test_external_steps_are_geared(mode: int, factor: int, ratio: float) -> None:
    rig = Rig()
    rig.write("GENERAL_CONF", 0x6020 | mode << 6)
    rig.write("GEAR_RATIO", round(ratio * 2**24))
    rig.patch(step_dir={"pulses": 1000, "rate_hz": 5000.0})
    rig.wait(0.1)
    assert rig.signed("VACTUAL") == pytest.approx(5000 * ratio * factor, rel=1e-3)
    rig.wait(0.2)
    assert rig.position == 1000 * ratio * factor
    assert rig.state().step_output.microsteps_256 == rig.position
    assert rig.signed("VACTUAL") == 0


def test_without_a_step_input_mode_external_steps_are_nothing() -> None:
    rig = Rig()
    rig.patch(step_dir={"pulses": 1000, "rate_hz": 5000.0})
    rig.wait(1.0)
    assert rig.position == 0


def test_indirect_control_moves_the_target_and_the_ramp_follows() -> None:
    rig = Rig()
    rig.write("GENERAL_CONF", 0x6020 | 1 << 6 | 1 << 9)
    rig.ramp(replace(BASE, vmax=2000.0), S_POSITION)
    rig.patch(step_dir={"pulses": 1000, "rate_hz": 10_000.0})
    rig.wait(0.1)
    assert 0 < rig.position < 300
    rig.wait_for_rest()
    assert rig.position == 1000
    assert rig.flag(0)


@pytest.mark.parametrize(("bit", "speed"), [(1 << 26, 500), (0, 0)])
def test_leaving_direct_control(bit: int, speed: int) -> None:
    """automatic_direct_sdin_switch_off: the ramp begins with VSTART, else from rest; a choice."""
    rig = Rig()
    rig.ramp(replace(BASE, vstart=500.0, amax=1.0, dmax=1.0), 1)
    rig.write("GENERAL_CONF", 0x6020 | 1 << 6 | bit)
    rig.patch(step_dir={"pulses": 100_000, "rate_hz": 5000.0})
    rig.wait(0.5)
    rig.write("VSTART", 500 << 8)
    rig.write("VMAX", 0)
    rig.write("GENERAL_CONF", 0x6020 | bit)
    rig.wait(1e-3)
    assert rig.signed("VACTUAL") == pytest.approx(speed, abs=1)
