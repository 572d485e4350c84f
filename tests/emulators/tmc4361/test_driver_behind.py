"""A TMC4361 with a TMC26x behind: set up by cover datagrams, moved by steps or currents, its status and stalls."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from app.emulators.drive.options import MotorOptions, StageSwitches
from app.emulators.tmc4361 import Tmc4361Options, Tmc4361Patch, Tmc4361State
from tests.emulators.tmc4361.rig import HOLD_POSITION, S_POSITION, TRAPEZOID_VELOCITY, Ramp, Rig

TO_CURRENTS, TO_STEPS = 10, 11
TIMES = 4 << 20 | 4 << 24 | 4 << 28
"""SPI_OUT_CONF: 4 clocks low, 4 high, 4 of rest."""
DRVCONF_CURRENTS, DRVCONF_STEPS = 0xEF090, 0xEF010
CHOPCONF, CHOPCONF_OFF = 0x901B4, 0x901B0
SMARTEN = 0xA0000
FULL, HALF = 0xD001F, 0xD000F
MICROSTEPS_256 = 0x00000
SGT_10 = 0xD0A1F
STALL_BIT = 1 << 24


def rig(form: int = TO_STEPS, *, on: bool = True, more: int = 0, **options: object) -> Rig:
    """A chip with its driver set up; the motor is at rest."""
    made = Rig(Tmc4361Options.model_validate({"driver": "tmc2660", **options}))
    made.write("SPI_OUT_CONF", form | TIMES | more)
    if on:
        cover(made, DRVCONF_CURRENTS if form == TO_CURRENTS else DRVCONF_STEPS)
        cover(made, SMARTEN)
        cover(made, FULL)
        if form == TO_STEPS:
            cover(made, MICROSTEPS_256)
        cover(made, CHOPCONF)
        made.now_s += 0.2
    return made


def cover(rig: Rig, datagram: int) -> int:
    rig.write("COVER_LOW", datagram)
    rig.now_s += 100e-6
    return rig.read("COVER_DRV_LOW")


def state(rig: Rig) -> Tmc4361State:
    described = rig.chip.state(rig.now_s)
    assert isinstance(described, Tmc4361State)
    return described


def change(rig: Rig, patch: Mapping[str, object]) -> None:
    rig.chip.patch(Tmc4361Patch.model_validate(patch), rig.now_s)


def move(rig: Rig, target: int, ramp: Ramp | None = None, limit_s: float = 5.0) -> None:
    rig.ramp(ramp or Ramp(), S_POSITION)
    rig.write("XTARGET", target)
    end = rig.now_s + limit_s
    while rig.signed("XACTUAL") != target:
        rig.now_s += 0.01
        assert rig.now_s < end
    rig.now_s += 0.2


@pytest.mark.sheet("DS-TMC4361", "11.4")
@pytest.mark.parametrize("form", [TO_STEPS, TO_CURRENTS])
def test_the_motor_follows_by_steps_and_by_currents(form: int) -> None:
    made = rig(form)
    begin = state(made).truth.rotor_fullsteps
    move(made, 51_200)
    assert state(made).truth.rotor_fullsteps - begin == pytest.approx(200, abs=0.3)
    move(made, -12_800)
    assert state(made).truth.rotor_fullsteps - begin == pytest.approx(-50, abs=0.3)
    behind = state(made).driver
    assert behind is not None
    assert behind.follows == ("steps" if form == TO_STEPS else "currents")
    assert behind.flags == ["STST"]


def test_a_driver_that_nobody_set_up_leaves_the_motor_free() -> None:
    made = rig(on=False)
    begin = state(made).truth.rotor_fullsteps
    move(made, 51_200)
    assert state(made).truth.rotor_fullsteps == pytest.approx(begin, abs=1.0)
    behind = state(made).driver
    assert behind is not None
    assert behind.bridges == "open"


@pytest.mark.parametrize("form", [TO_STEPS, TO_CURRENTS])
def test_chopper_off_lets_a_load_turn_the_shaft(form: int) -> None:
    made = rig(form)
    change(made, {"load_torque_nm": 0.1})
    made.now_s += 0.5
    held = state(made).truth.rotor_fullsteps
    cover(made, CHOPCONF_OFF)
    made.now_s += 0.5
    assert abs(state(made).truth.rotor_fullsteps - held) > 50


def amplitude(rig: Rig) -> float:
    truth = state(rig).truth
    return float(np.hypot(truth.current_a_a, truth.current_b_a))


@pytest.mark.parametrize("form", [TO_STEPS, TO_CURRENTS])
def test_current_scale_and_vsense_set_the_current(form: int) -> None:
    made = rig(form)
    full = amplitude(made)
    assert full == pytest.approx(2.1, rel=0.02)
    cover(made, HALF)
    made.now_s += 0.1
    assert amplitude(made) == pytest.approx(full / 2, rel=0.02)
    cover(made, FULL)
    cover(made, (DRVCONF_CURRENTS if form == TO_CURRENTS else DRVCONF_STEPS) | 1 << 6)
    made.now_s += 0.1
    assert amplitude(made) == pytest.approx(full * 0.165 / 0.310, rel=0.02)


@pytest.mark.sheet("DS-TMC4361", "11.3")
def test_over_spi_the_chip_s_own_scale_multiplies_the_currents() -> None:
    made = rig(TO_CURRENTS)
    made.write("CURRENT_CONF", 2)
    made.write("SCALE_VALUES", 0xFF_FF_7F_FF)
    made.now_s += 0.1
    assert amplitude(made) == pytest.approx(1.05, rel=0.03)
    words = state(made).driver_words
    word = made.read("CURRENTA_B_SPI")
    a, b = ((word >> at & 0x1FF) - (word >> at << 1 & 0x200) for at in (0, 16))
    assert words["DRVCTRL"] == (a < 0) << 17 | abs(a) << 9 | (b < 0) << 8 | abs(b)


def test_with_steps_the_scale_goes_to_the_driver_where_it_is_transferred() -> None:
    made = rig(more=1 << 5)
    made.write("CURRENT_CONF", 2)
    made.write("SCALE_VALUES", 0xFF_FF_7F_FF)
    made.now_s += 0.1
    assert amplitude(made) == pytest.approx(2.1 * 16 / 32, rel=0.03)
    assert state(made).driver_words["SGCSCONF"] & 31 == 15
    without = rig()
    without.write("CURRENT_CONF", 2)
    without.write("SCALE_VALUES", 0xFF_FF_7F_FF)
    without.now_s += 0.1
    assert amplitude(without) == pytest.approx(2.1, rel=0.03)


def test_currents_to_a_driver_that_takes_steps_set_its_step_control() -> None:
    made = rig(TO_STEPS)
    made.write("SPI_OUT_CONF", TO_CURRENTS | TIMES)
    move(made, 12_800 + 37)
    assert state(made).driver_words["DRVCTRL"] != 0


@pytest.mark.sheet("DS-TMC4361", "11.2")
def test_cover_done_comes_when_the_datagram_is_through() -> None:
    made = rig()
    made.events()
    made.write("SPI_OUT_CONF", TO_STEPS | 15 << 20 | 15 << 24 | 1 << 12)  # covers alone are told
    made.events()
    made.write("COVER_LOW", SMARTEN)
    made.now_s += 20e-6  # of 37.5 us
    assert "COVER_DONE" not in made.events()
    made.now_s += 30e-6
    assert "COVER_DONE" in made.events()


@pytest.mark.sheet("DS-TMC4361", "17.14")
@pytest.mark.parametrize("form", [TO_STEPS, TO_CURRENTS])
def test_what_the_driver_finds_shows_in_status_and_as_an_event(form: int) -> None:
    made = rig(form)
    assert made.read("STATUS_FLAGS") >> 24 == 0x80  # it stands
    made.events()
    for patch, bit in (
        ({"motor": {"temperature_c": 125.0}}, 26),
        ({"motor": {"temperature_c": 160.0}}, 25),
        ({"motor": {"temperature_c": 40.0}}, None),
        ({"motor": {"connected": False}}, 29),
        ({"motor": {"connected": True}}, None),
        ({"motor": {"short_to_ground": "b"}}, 28),
    ):
        change(made, patch)
        made.now_s += 0.01
        status = made.read("STATUS_FLAGS") >> 24 & 0x7F
        assert status >> (bit - 24) & 1 if bit else status == 0, (patch, hex(status))
    assert "MOTOR_EV" in made.events()


def test_polling_is_as_rare_as_it_is_set_and_may_be_off() -> None:
    rare = rig(more=15 << 8)  # every 4 * 2^15 clocks: 8.2 ms
    change(rare, {"motor": {"temperature_c": 125.0}})
    seen = []
    for _ in range(100):
        rare.now_s += 0.0002
        seen.append(rare.read("STATUS_FLAGS") >> 26 & 1)
    first = seen.index(1)
    assert 0 <= first * 0.2 < 9
    change(rare, {"motor": {"temperature_c": 40.0}})
    rare.now_s += 0.0002
    late = 0
    while rare.read("STATUS_FLAGS") >> 26 & 1:
        rare.now_s += 0.0002
        late += 1
    assert late * 0.2 < 9
    never = rig(more=1 << 6)
    change(never, {"motor": {"temperature_c": 125.0}})
    never.now_s += 1.0
    assert never.read("STATUS_FLAGS") >> 26 & 1 == 0
    cover(never, SMARTEN)  # an answer is one whoever asked
    never.now_s += 0.001
    assert never.read("STATUS_FLAGS") >> 26 & 1 == 1
    assert never.read("POLLING_STATUS") >> 2 & 1 == 1


@pytest.mark.parametrize("form", [TO_STEPS, TO_CURRENTS])
def test_a_stall_stops_the_motor_at_the_end_of_its_stage(form: int) -> None:
    stage = {"left_end_fullsteps": -300.0, "left_at_fullsteps": -1000.0, "right_at_fullsteps": 1000.0}
    made = rig(form, stage=stage)
    cover(made, SGT_10)
    made.ramp(Ramp(vmax=0.0, amax=400_000.0), TRAPEZOID_VELOCITY)
    made.write("VSTALL_LIMIT", 40_000)
    made.write("REFERENCE_CONF", 1 << 26)
    made.events()
    made.write("VMAX", -51_200 * 256)
    for _ in range(300):
        made.now_s += 0.01
        if made.signed("VACTUAL") == 0 and made.signed("XACTUAL") < -20_000:
            break
    assert "STOP_ON_STALL" in made.events()
    assert state(made).truth.rotor_fullsteps == pytest.approx(-300, abs=3)
    at = made.signed("XACTUAL") / 256
    assert -316 < at < -298  # found within some full steps


def test_a_threshold_that_is_too_high_finds_no_stall() -> None:
    made = rig(stage={"left_end_fullsteps": -300.0, "left_at_fullsteps": -1000.0, "right_at_fullsteps": 1000.0})
    cover(made, 0xD3F1F)  # SGT 63
    made.ramp(Ramp(vmax=0.0, amax=400_000.0), TRAPEZOID_VELOCITY)
    made.write("VSTALL_LIMIT", 40_000)
    made.write("REFERENCE_CONF", 1 << 26)
    made.write("VMAX", -51_200 * 256)
    made.now_s += 3.0
    assert made.signed("VACTUAL") == -51_200


def test_reset_by_register_leaves_the_driver_and_a_power_cycle_does_not() -> None:
    made = rig()
    made.write("RESET_CLK_GATING", 0x525354 << 8)
    made.now_s += 0.1
    behind = state(made).driver
    assert behind is not None
    assert behind.bridges == "regulated"
    assert state(made).driver_words["CHOPCONF"] == CHOPCONF
    change(made, {"power_cycle": True})
    made.now_s += 0.1
    behind = state(made).driver
    assert behind is not None
    assert behind.bridges == "open"


@pytest.mark.parametrize("form", [TO_STEPS, TO_CURRENTS])
def test_it_makes_no_difference_in_how_many_pieces_time_goes_by(form: int) -> None:
    def run(pieces: int) -> tuple[float, float, int]:
        made = rig(form)
        made.ramp(Ramp(), S_POSITION)
        made.write("XTARGET", 40_000)
        begin = made.now_s
        for piece in range(1, pieces + 1):
            made.now_s = begin + 3.0 * piece / pieces
            made.read("STATUS_FLAGS")
        made.write("RAMPMODE", HOLD_POSITION)
        truth = state(made).truth
        return truth.rotor_fullsteps, truth.current_a_a, made.read("MSCNT")

    assert run(1) == run(7) == run(301)


def test_wired_is_what_it_is_unless_asked_otherwise() -> None:
    made = Rig(Tmc4361Options(motor=MotorOptions(), stage=StageSwitches()))
    assert state(made).driver is None
    made.write("COVER_LOW", CHOPCONF)
    made.now_s += 0.1
    assert state(made).driver_words == {"CHOPCONF": CHOPCONF}
    assert amplitude(made) == pytest.approx(2.1, rel=0.02)
    assert not made.read("STATUS_FLAGS") & STALL_BIT


@pytest.mark.parametrize("form", [TO_STEPS, TO_CURRENTS])
@pytest.mark.parametrize(("covers_only", "told"), [(0, True), (1 << 12, False)])
def test_datagrams_that_the_chip_sends_by_itself_make_a_cover_done(form: int, covers_only: int, told: bool) -> None:
    made = rig(form, more=covers_only)
    made.events()
    made.now_s += 0.01
    assert ("COVER_DONE" in made.events()) == told
    cover(made, SMARTEN)
    assert "COVER_DONE" in made.events()
