"""A TMC4361 with a TMC2130 behind: 40-bit cover datagrams set it up, steps or XDIRECT's currents move its motor."""

from __future__ import annotations

import pytest

from app.emulators.tmc4361 import Tmc4361Options
from app.registers.catalog import MODELS
from tests.emulators.tmc4361.rig import TRAPEZOID_VELOCITY, Ramp, Rig
from tests.emulators.tmc4361.test_driver_behind import TIMES, amplitude, change, move, state

TABLE = MODELS["tmc2130"].table
TO_CURRENTS, TO_STEPS = 12, 13
DIRECT_MODE, CHOPPER = 1 << 16, 0x101D5
"""toff 5, hstrt 5, hend 3, tbl 2, 256 microsteps."""
FULL_A = 2.1


def cover(rig: Rig, name: str, word: int | None = None) -> int:
    """Write a register of the driver, or ask for one; the answer, which is that to the datagram before."""
    address = TABLE.get(name, 0).address
    rig.write("COVER_HIGH", address | (0 if word is None else 0x80))
    rig.write("COVER_LOW", word or 0)
    rig.now_s += 100e-6
    return rig.read("COVER_DRV_HIGH") << 32 | rig.read("COVER_DRV_LOW")


def read(rig: Rig, name: str) -> int:
    cover(rig, name)
    return cover(rig, name) & 0xFFFF_FFFF


def rig(form: int = TO_STEPS, *, on: bool = True, more: int = 0, irun: int = 31, ihold: int = 31, **o: object) -> Rig:
    """A chip with its driver set up; the motor is at rest."""
    made = Rig(Tmc4361Options.model_validate({"driver": "tmc2130", **o}))
    made.write("SPI_OUT_CONF", form | TIMES | more)
    if on:
        cover(made, "GCONF", DIRECT_MODE if form == TO_CURRENTS else 0)
        cover(made, "TPOWERDOWN", 1)
        cover(made, "IHOLD_IRUN", irun << 8 | ihold)
        cover(made, "CHOPCONF", CHOPPER)
        made.now_s += 0.3
    return made


def flags(rig: Rig) -> list[str]:
    behind = state(rig).driver
    assert behind is not None
    return behind.flags


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
    assert (behind.kind, behind.follows) == ("tmc2130", "steps" if form == TO_STEPS else "currents")
    assert read(made, "CHOPCONF") == CHOPPER
    assert state(made).driver_words["IHOLD_IRUN"] == 0x1F1F


def test_a_driver_that_nobody_set_up_leaves_the_motor_free() -> None:
    made = rig(on=False)
    begin = state(made).truth.rotor_fullsteps
    move(made, 51_200)
    assert state(made).truth.rotor_fullsteps == pytest.approx(begin, abs=1.0)


def test_steps_move_it_with_its_run_current_and_rest_lowers_it() -> None:
    made = rig(irun=31, ihold=15)
    assert amplitude(made) == pytest.approx(FULL_A / 2, rel=0.03)
    made.ramp(Ramp(vmax=25_600.0, amax=400_000.0), TRAPEZOID_VELOCITY)
    made.write("VMAX", 25_600 * 256)
    made.now_s += 0.5
    assert amplitude(made) == pytest.approx(FULL_A, rel=0.05)


def test_currents_are_scaled_by_ihold_alone() -> None:
    made = rig(TO_CURRENTS, irun=31, ihold=15)
    made.ramp(Ramp(vmax=25_600.0, amax=400_000.0), TRAPEZOID_VELOCITY)
    made.write("VMAX", 25_600 * 256)
    made.now_s += 0.5
    assert amplitude(made) == pytest.approx(FULL_A / 2, rel=0.05)
    cover(made, "GCONF", 0)
    made.now_s += 0.1
    assert amplitude(made) == pytest.approx(FULL_A, rel=0.05), "steps come to it as well, and IRUN is theirs"


def test_xdirect_shows_what_the_chip_sent() -> None:
    made = rig(TO_CURRENTS)
    move(made, 12_800 + 37)
    assert read(made, "XDIRECT") == made.read("CURRENTA_B_SPI")


def test_vsense_lowers_the_full_scale() -> None:
    made = rig()
    cover(made, "CHOPCONF", CHOPPER | 1 << 17)
    made.now_s += 0.1
    assert amplitude(made) == pytest.approx(FULL_A * 0.18 / 0.32, rel=0.03)


def test_with_steps_the_scale_goes_to_both_currents_where_it_is_transferred() -> None:
    made = rig(more=1 << 5)
    made.write("CURRENT_CONF", 2)
    made.write("SCALE_VALUES", 0xFF_FF_7F_FF)
    made.now_s += 0.1
    assert amplitude(made) == pytest.approx(FULL_A / 2, rel=0.03)
    assert state(made).driver_words["IHOLD_IRUN"] == 0x0F0F


@pytest.mark.sheet("DS-TMC4361", "17.14")
@pytest.mark.parametrize("form", [TO_STEPS, TO_CURRENTS])
def test_what_the_driver_finds_shows_in_status_polling_and_its_own_register(form: int) -> None:
    made = rig(form)
    for patch, name, bit in (
        ({"motor": {"temperature_c": 125.0}}, "OTPW", 26),
        ({"motor": {"temperature_c": 160.0}}, "OT", 25),
        ({"motor": {"temperature_c": 40.0}}, None, None),
        ({"motor": {"short_to_ground": "b"}}, "S2GB", 28),
    ):
        change(made, patch)
        made.now_s += 0.01
        status = made.read("STATUS_FLAGS") >> 24 & 0x7F
        assert status >> (bit - 24) & 1 if bit else status == 0, (patch, hex(status))
        assert read(made, "DRV_STATUS") >> 24 & 0x7F == made.read("POLLING_STATUS") >> 24 & 0x7F == status
        assert name is None or name in flags(made)


@pytest.mark.parametrize("form", [TO_STEPS, TO_CURRENTS])
def test_a_stall_stops_the_motor_at_the_end_of_its_stage(form: int) -> None:
    stage = {"left_end_fullsteps": -300.0, "left_at_fullsteps": -1000.0, "right_at_fullsteps": 1000.0}
    made = rig(form, stage=stage)
    cover(made, "COOLCONF", 10 << 16)
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


@pytest.mark.parametrize("form", [TO_STEPS, TO_CURRENTS])
def test_it_makes_no_difference_in_how_many_pieces_time_goes_by(form: int) -> None:
    def run(pieces: int) -> tuple[float, float, int]:
        made = rig(form)
        made.ramp(Ramp(), 0b110)
        made.write("XTARGET", 40_000)
        begin = made.now_s
        for piece in range(1, pieces + 1):
            made.now_s = begin + 1.5 * piece / pieces
            made.read("STATUS_FLAGS")
        truth = state(made).truth
        return truth.rotor_fullsteps, truth.current_a_a, made.read("MSCNT")

    assert run(1) == run(7) == run(151)


def test_a_datagram_of_another_length_fetches_the_beginning_or_passes_through() -> None:
    made = rig()
    held = read(made, "CHOPCONF")
    made.write("SPI_OUT_CONF", TO_STEPS | TIMES | 20 << 13)
    made.write("COVER_LOW", 0xEC << 12)
    made.now_s += 100e-6
    assert made.read("COVER_DRV_LOW") == ((1 << 3 | 1) << 32 | held) >> 20, "it stands, and was reset"
    made.write("SPI_OUT_CONF", TO_STEPS | TIMES | 40 << 13)
    assert read(made, "CHOPCONF") == held


def test_a_power_cycle_switches_it_off_and_a_reset_by_register_does_not() -> None:
    made = rig()
    made.write("RESET_CLK_GATING", 0x525354 << 8)
    made.now_s += 0.1
    assert state(made).driver_words["CHOPCONF"] == CHOPPER
    change(made, {"power_cycle": True})
    made.now_s += 0.1
    behind = state(made).driver
    assert behind is not None
    assert behind.bridges == "open"
