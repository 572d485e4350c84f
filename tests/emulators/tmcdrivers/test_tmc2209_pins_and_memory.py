"""An emulated TMC2209's memory that is burnt once, its pins INDEX and VREF, and CoolStep by StallGuard4."""

from __future__ import annotations

import pytest

from app.emulators.drive.otp import resets
from app.errors import WrongState
from tests.emulators.tmcdrivers.bench import Bench

FACTORY = 0x10
KEY = 0xBD << 8


def burn(bench: Bench, byte: int, bit: int, key: int = KEY) -> None:
    bench.write("OTP_PROG", key | byte << 4 | bit)


def test_bits_are_burnt_by_the_key_alone_and_stay() -> None:
    bench = Bench("tmc2209")
    burn(bench, 2, 7, 0xBC << 8)
    burn(bench, 3, 0)
    assert bench.read("OTP_READ") == FACTORY
    burn(bench, 2, 7)
    burn(bench, 1, 5)
    burnt = FACTORY | 1 << 23 | 1 << 13
    assert bench.read("OTP_READ") == burnt
    bench.write("OTP_PROG", 0)
    bench.patch(power_cycle=True)
    assert bench.read("OTP_READ") == burnt


def test_what_is_burnt_is_how_it_wakes_up_after_the_next_power_on() -> None:
    bench = Bench("tmc2209")
    burn(bench, 2, 7)
    assert not bench.fields("GCONF")["en_spreadcycle"]
    bench.patch(power_cycle=True)
    assert bench.fields("GCONF")["en_spreadcycle"]


EMPTY = {"GCONF": 0x101, "IHOLD_IRUN": 0x11F10, "CHOPCONF": 0x10000053, "PWMCONF": 0xC10D0024}


@pytest.mark.parametrize(
    ("bits", "register", "word"),
    [
        ((), "IHOLD_IRUN", 0x11F10),
        ((21,), "IHOLD_IRUN", 0x11F02),
        ((21, 22), "IHOLD_IRUN", 0x11F18),
        ((19, 20), "IHOLD_IRUN", 0x81F10),
        ((14,), "TPWMTHRS", 300),
        ((13, 14, 15), "TPWMTHRS", 4000),
        ((13, 23), "TPWMTHRS", 0),
        ((18,), "PWMCONF", 0xC10E0024),
        ((17,), "PWMCONF", 0xC20D0024),
        ((16,), "PWMCONF", 0xC1050000),
        ((16, 23), "CHOPCONF", 0x10000153),
        ((23,), "GCONF", 0x105),
    ],
)
def test_resets_by_what_is_burnt(bits: tuple[int, ...], register: str, word: int) -> None:
    assert resets(sum(1 << bit for bit in bits), EMPTY)[register] == word


def test_vref_scales_the_current_while_it_may() -> None:
    bench = Bench("tmc2209")
    bench.write("GCONF", 0x1C5)
    bench.write("IHOLD_IRUN", 31 << 8 | 31)
    bench.write("CHOPCONF", 0x1000_0053)
    currents = []
    for volts in (2.5, 1.25, 5.0):
        bench.patch(pins={"vref_v": volts})
        bench.wait(0.5)
        currents.append(bench.peak_a)
    assert currents[1] == pytest.approx(currents[0] / 2, rel=0.02)
    assert currents[2] == pytest.approx(currents[0], rel=0.01)
    bench.patch(pins={"vref_v": 0.5})
    bench.write("GCONF", 0x1C4)
    bench.wait(0.5)
    assert bench.peak_a == pytest.approx(currents[0], rel=0.01)


def test_a_chip_without_such_a_pin_takes_no_voltage() -> None:
    with pytest.raises(WrongState, match="no pin that scales"):
        Bench("tmc2240").patch(pins={"vref_v": 1.0})


def index(bench: Bench) -> bool | None:
    return bench.chip.state(bench.time_s).pins.index


@pytest.mark.parametrize("mres", [0, 4, 8])
def test_index_is_active_once_an_electrical_turn(mres: int) -> None:
    bench = Bench("tmc2209")
    bench.write("GCONF", 0x1C4)
    bench.write("CHOPCONF", 0x1000_0053 | mres << 24)
    seen = []
    width = 1 << mres
    bench.write("VACTUAL", 2000)
    for _ in range(1200):
        bench.wait(0.7e-3 * width)
        seen.append((bench.read("MSCNT"), index(bench)))
    assert all(active == (place < width) for place, active in seen)
    assert 0 < sum(bool(active) for _, active in seen) < len(seen) / 2
    assert index(Bench("tmc2130")) is None


def test_index_shows_the_steps_of_vactual_or_the_warning_where_gconf_says_so() -> None:
    bench = Bench("tmc2209")
    bench.write("GCONF", 0x1E4)
    bench.write("CHOPCONF", 0x1400_0053)
    bench.write("VACTUAL", 500)
    seen = []
    for _ in range(50):
        bench.wait(1e-3)
        seen.append((bench.read("MSCNT") // 16, index(bench)))
    assert all(active == bool(step & 1) for step, active in seen)
    assert {active for _, active in seen} == {True, False}
    bench.write("GCONF", 0x1D4)
    assert index(bench) is False
    bench.patch(motor={"temperature_c": 125.0})
    assert index(bench) is True


def test_coolstep_lowers_the_current_by_stallguard4_and_load_brings_it_back() -> None:
    bench = Bench("tmc2209")
    bench.write("GCONF", 0x1C0)
    bench.write("IHOLD_IRUN", 31 << 8 | 31)
    bench.write("CHOPCONF", 0x1000_0053)
    bench.write("TCOOLTHRS", 0xFFFFF)
    bench.write("VACTUAL", 71_583)
    bench.wait(1.5)
    assert bench.fields("DRV_STATUS")["CS_ACTUAL"] == 31
    load = bench.read("SG_RESULT")
    semin = max(load // 64, 1)
    bench.write("COOLCONF", semin | 3 << 13 | 3 << 5)
    bench.wait(1.5)
    lowered = bench.fields("DRV_STATUS")["CS_ACTUAL"]
    assert lowered < 31
    bench.patch(load_torque_nm=0.25)
    bench.wait(1.0)
    assert bench.fields("DRV_STATUS")["CS_ACTUAL"] > lowered
    bench.write("TCOOLTHRS", 0)
    bench.wait(0.5)
    assert bench.fields("DRV_STATUS")["CS_ACTUAL"] == 31, "slower than that it does nothing"
