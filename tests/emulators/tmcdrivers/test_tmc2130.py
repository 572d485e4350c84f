"""An emulated TMC2130: SPI, steps from outside, and what its registers do to the motor."""

from __future__ import annotations

import math

import pytest

from app.emulators.tmcdrivers import DriverModel
from app.errors import OutOfRange
from app.links import datagram40
from tests.emulators.tmcdrivers.bench import Bench

CHOPPER = 0x0001_01D5
"""toff 5, hstrt 5, hend 3, tbl 2: what the maker's host code begins with."""


def ready(mres: int = 0, gconf: int = 0, irun: int = 16, **options: object) -> Bench:
    made = Bench("tmc2130", **options)
    made.write("GCONF", gconf)
    made.write("IHOLD_IRUN", irun << 8 | 8)
    made.write("CHOPCONF", CHOPPER | mres << 24)
    return made


def test_it_answers_the_datagram_before_and_shows_its_status() -> None:
    bench = Bench("tmc2130")
    bench.chip.exchange(datagram40.read(0x04), 0.0)
    reply = datagram40.Reply.decode(bench.chip.exchange(datagram40.write(0x6C, CHOPPER), 0.0))
    assert (reply.data >> 24, reply.status & 1) == (0x11, 1)
    assert datagram40.Reply.decode(bench.chip.exchange(datagram40.read(0x6C), 0.0)).data == CHOPPER
    assert bench.chip.uart(b"\x05\x00\x00\x48") == b"", "it has none"
    assert bench.chip.state().uart is None


def test_reading_gstat_clears_it() -> None:
    bench = Bench("tmc2130")
    assert [bench.read("GSTAT") for _ in range(2)] == [1, 0]
    bench.patch(power_cycle=True)
    assert bench.read("GSTAT") == 1


@pytest.mark.parametrize(("mres", "way"), [(0, 1), (4, -1), (8, 1)])
def test_steps_turn_the_motor_in_its_microsteps(mres: int, way: int) -> None:
    bench = ready(mres, motor="rigid")
    bench.step(way * 50 * (256 >> mres))
    bench.wait(2.0)
    assert bench.turned_fullsteps == pytest.approx(way * 100, abs=1.5)
    assert bench.clock_hz / bench.read("TSTEP") / 256 == pytest.approx(50, rel=0.01)
    assert bench.fields("IOIN")["REFR_DIR"] == (way < 0)
    assert not bench.fields("DRV_STATUS")["stst"]
    bench.step(0)
    bench.wait(0.2)
    assert (bench.read("TSTEP"), bench.fields("DRV_STATUS")["stst"]) == (0xFFFFF, 1)


def test_shaft_turns_it_round_and_a_power_cycle_leaves_the_steps_coming() -> None:
    bench = ready(gconf=0x10, motor="rigid")
    bench.step(12_800)
    bench.wait(1.0)
    assert bench.turned_fullsteps == pytest.approx(-50, abs=1)
    bench.patch(power_cycle=True)
    before = bench.turned_fullsteps
    bench.wait(1.0)
    assert bench.turned_fullsteps == pytest.approx(before + 50, abs=2.1), (
        "from where the nearest place 0 of the table is"
    )


def test_no_more_steps_than_half_of_its_clock() -> None:
    bench = Bench("tmc2130")
    with pytest.raises(OutOfRange, match="half of the chip's clock"):
        bench.step(6.6e6)


@pytest.mark.parametrize(("vsense", "full_v"), [(0, 0.32), (1, 0.18)])
def test_current_at_rest_is_that_of_its_resistors(vsense: int, full_v: float) -> None:
    """110 mOhm and 20 mOhm of the chip, IHOLD 8."""
    bench = ready()
    bench.write("CHOPCONF", CHOPPER | vsense << 17)
    bench.wait(1.0)
    assert bench.peak_a == pytest.approx(full_v / 0.13 * 9 / 32, rel=0.03)


@pytest.mark.parametrize("written", [1, 4])
def test_powerdown_waits_one_delay_less_than_written(written: int) -> None:
    """As a TMC5130 (DS-TMC5130 p. 34)."""
    bench = ready(irun=31, motor="rigid")
    bench.write("TPOWERDOWN", written)
    bench.step(1000)
    bench.wait(0.5)
    bench.step(0)
    still_s = 2**20 / bench.clock_hz
    delay_s = (written - 1) * 2**18 / bench.clock_hz
    bench.wait(still_s + delay_s - 0.005)
    assert bench.fields("DRV_STATUS")["CS_ACTUAL"] == 31
    bench.wait(0.02)
    assert bench.fields("DRV_STATUS")["CS_ACTUAL"] < 31


def test_load_lowers_stallguard2_and_diag_shows_a_stall_that_gconf_has_it_show() -> None:
    bench = ready(irun=31)
    bench.write("TCOOLTHRS", 0xFFFFF)
    bench.step(51_200)
    bench.wait(1.0)
    free = bench.fields("DRV_STATUS")["SG_RESULT"]
    bench.patch(load_torque_nm=0.2)
    bench.wait(1.0)
    loaded = bench.fields("DRV_STATUS")["SG_RESULT"]
    assert 0 < loaded < free
    bench.write("COOLCONF", (-64 & 0x7F) << 16)  # the most sensitive
    bench.wait(0.1)
    assert bench.fields("DRV_STATUS")["StallGuard"]
    assert not bench.chip.state(bench.time_s).pins.diag, "GCONF has neither pin show it"
    for bit in (7, 8):
        bench.write("GCONF", 1 << bit)
        assert bench.chip.state(bench.time_s).pins.diag


def test_stealthchop_by_gconf_and_threshold() -> None:
    bench = ready(gconf=0x4)
    bench.write("PWMCONF", 0x000504C8)
    bench.step(25_600)
    bench.wait(0.5)
    assert bench.read("PWM_SCALE") > 0
    bench.write("TPWMTHRS", bench.read("TSTEP") + 10)
    bench.wait(0.01)
    assert bench.read("PWM_SCALE") == 0


@pytest.mark.parametrize(("celsius", "flags"), [(100, set()), (121, {"otpw"}), (151, {"ot", "otpw"})])
def test_temperatures(celsius: float, flags: set[str]) -> None:
    bench = ready()
    bench.patch(motor={"temperature_c": float(celsius)})
    bench.wait(0.01)
    told = bench.fields("DRV_STATUS")
    assert {name for name in ("ot", "otpw") if told[name]} == flags
    assert bench.fields("GSTAT")["drv_err"] == ("ot" in flags)


def test_the_microstep_table_is_what_was_written() -> None:
    """A table of zeros alone, with segments that stand for 0 and 1: nothing but the start value."""
    bench = ready(motor="rigid")
    for n in range(8):
        bench.write(f"MSLUT[{n}]", 0)
    bench.write("MSLUTSEL", 0xFFFF_FF55)
    bench.write("MSLUTSTART", 100 << 16 | 7)
    bench.wait(0.01)
    assert bench.fields("MSCURACT")["CUR_A"] in (7, -7)


@pytest.mark.parametrize("model", ["tmc2130", "tmc2240"])
def test_direct_mode_takes_both_coil_currents_scaled_by_ihold_and_looks_at_no_steps(model: DriverModel) -> None:
    bench = Bench(model)
    bench.write("CHOPCONF", CHOPPER)
    bench.write("IHOLD_IRUN", 31 << 8 | 15)
    bench.write("GCONF", 1 << 16)
    direct = "XDIRECT" if model == "tmc2130" else "DIRECT_MODE"
    bench.write(direct, 248)
    bench.wait(0.3)
    full_a = 2 * bench.peak_a
    begin = bench.turned_fullsteps
    for place in range(1, 201):
        a, b = round(248 * math.cos(place * math.pi / 50)), round(248 * math.sin(place * math.pi / 50))
        bench.write(direct, a & 0x1FF | (b & 0x1FF) << 16)
        bench.wait(0.01)
    assert abs(bench.turned_fullsteps - begin) == pytest.approx(8, abs=0.1), "two turns of the wave"
    bench.step(12_800)
    before = bench.turned_fullsteps
    bench.wait(0.2)
    assert bench.turned_fullsteps == pytest.approx(before, abs=0.1)
    bench.write("GCONF", 0)
    bench.wait(1.0)
    assert abs(bench.turned_fullsteps - before) > 20
    assert bench.peak_a == pytest.approx(full_a, rel=0.05), "IRUN, once it moves by steps"
