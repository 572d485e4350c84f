"""The emulated TMC5240 in what its sisters have not: ADC, currents by range, StallGuard4, virtual stops, eight points.

Expected values are reckoned here from what docs/sources.md names: KLIPPER for the ADC's steps and the current ranges,
FIELDS-TMC5240 for the rest. The drive's ramp of eight points has an oracle of its own in tests/emulators/drive.
"""

from __future__ import annotations

from itertools import pairwise

import pytest

from app.clock import VirtualClock
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxModel
from tests.emulators.tmc5xxx.rig import BACKWARD, CLOCK_HZ, FORWARD, ONE_TURN_A_SECOND, Bench, moving

MODEL: Tmc5xxxModel = "tmc5240"
VMAX = 2 * ONE_TURN_A_SECOND
STEALTH = 1 << 2
SG_STOP, LEFT, RIGHT, BY_ENCODER = 1 << 10, 1 << 12, 1 << 13, 1 << 14


# --- ADC ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("supply_v", [8.0, 12.0, 24.0, 36.0])
def test_the_adc_tells_the_supply(supply_v: float) -> None:
    bench = Bench(MODEL, supply_v=supply_v)
    assert bench.field("ADC_VSUPPLY_AIN", "ADC_VSUPPLY") * 9.732e-3 == pytest.approx(supply_v, abs=9.732e-3)
    bench.patch(supply_v=supply_v + 2)
    assert bench.field("ADC_VSUPPLY_AIN", "ADC_VSUPPLY") * 9.732e-3 == pytest.approx(supply_v + 2, abs=9.732e-3)
    assert bench.field("ADC_VSUPPLY_AIN", "ADC_AIN") == 0, "nothing is connected to it"


def test_the_adc_tells_a_supply_that_sags() -> None:
    bench = moving(MODEL, rigid=False, current=31, supply_v=24.0, supply_resistance_ohm=10.0)
    truth = bench.state().axes[0].truth.supply_v
    assert 10.0 < truth < 23.6
    assert bench.field("ADC_VSUPPLY_AIN", "ADC_VSUPPLY") * 9.732e-3 == pytest.approx(truth, abs=9.732e-3)


@pytest.mark.parametrize("celsius", [-20.0, 0.0, 25.0, 85.0])
def test_the_adc_tells_the_temperature(celsius: float) -> None:
    bench = Bench(MODEL)
    bench.stage(motor={"temperature_c": celsius})
    assert (bench.read("ADC_TEMP") - 2038) / 7.7 == pytest.approx(celsius, abs=1 / 7.7)


def test_the_warning_of_temperature_is_where_the_register_says() -> None:
    bench = Bench(MODEL)
    bench.write("OTW_OV_VTH", round(2038 + 7.7 * 60) << 16)
    seen = {}
    for celsius in (59, 61, 130):
        bench.stage(motor={"temperature_c": celsius})
        seen[celsius] = bench.field("DRV_STATUS", "otpw")
    assert seen == {59: 0, 61: 1, 130: 1}
    bench.write("OTW_OV_VTH", round(2038 + 7.7 * 140) << 16)
    assert bench.field("DRV_STATUS", "otpw") == 0, "130 degrees are below the new one"


# --- the chip -----------------------------------------------------------------------------------


def test_its_clock_is_its_own_unless_the_bench_gives_another() -> None:
    own = EmulatedTmc5xxx(MODEL, VirtualClock())
    assert own.options.clock_hz == 12.5e6
    bench = Bench(MODEL)
    row = bench.table.get("IOIN")
    assert row.unpack(own.read(row.address, 0.0))["EXT_CLK"] == 0
    assert (bench.field("IOIN", "EXT_CLK"), bench.field("IOIN", "VERSION")) == (1, 0x40)


def test_gstat_tells_of_a_reset_and_of_a_low_supply() -> None:
    bench = Bench(MODEL)
    assert (bench.field("GSTAT", "reset"), bench.field("GSTAT", "register_reset")) == (1, 1)
    bench.write("GSTAT", 0x1F)
    assert bench.raw("GSTAT") == 0
    bench.patch(supply_v=5.0)
    assert bench.field("GSTAT", "vm_uvlo") == 0, "4.5 V are enough for it"
    bench.patch(supply_v=4.0)
    bench.patch(supply_v=24.0)
    assert bench.field("GSTAT", "vm_uvlo") == 1, "it stays until it is cleared"
    bench.write("GSTAT", 1 << 4)
    assert bench.field("GSTAT", "vm_uvlo") == 0


# --- currents -----------------------------------------------------------------------------------


@pytest.mark.parametrize(("current_range", "ohm_a"), [(0, 11_750), (1, 24_000), (2, 36_000), (3, 36_000)])
@pytest.mark.parametrize(("scaler", "scale"), [(0, 31), (128, 15), (64, 7)])
def test_the_current_goes_by_range_scaler_and_scale(current_range: int, ohm_a: int, scaler: int, scale: int) -> None:
    """The peak, with 12 kOhm at IREF; phase B begins at its greatest, 247 or 248 of 248."""
    bench = moving(MODEL, rigid=False, current=scale)
    bench.put(DRV_CONF=current_range, GLOBAL_SCALER=scaler)
    bench.wait(0.1)
    peak_a = ohm_a / 12_000 * (scaler or 256) / 256 * (scale + 1) / 32
    assert bench.state().axes[0].truth.current_b_a == pytest.approx(peak_a, rel=0.005)


def test_the_run_current_comes_step_by_step() -> None:
    """IRUNDELAY: 512 clocks for each step, times what it says."""
    bench = moving(MODEL)
    bench.put(IHOLD_IRUN=4 | 20 << 8 | 15 << 24, TPOWERDOWN=0)
    bench.wait(0.2)
    assert bench.field("DRV_STATUS", "CS_ACTUAL") == 4
    bench.put(XTARGET=1_000_000)
    reached_s: dict[int, float] = {}
    while 20 not in reached_s:
        bench.wait(1e-5)
        reached_s.setdefault(bench.field("DRV_STATUS", "CS_ACTUAL"), bench.now_s)
        assert bench.read("XACTUAL") < 20_000
    assert list(reached_s) == list(range(4, 21))
    assert reached_s[20] - reached_s[5] == pytest.approx(15 * 15 * 512 / CLOCK_HZ, abs=5e-5)


# --- StallGuard4 --------------------------------------------------------------------------------


def turning_quietly(**registers: int) -> Bench:
    """With StealthChop, at full speed."""
    bench = moving(MODEL, rigid=False)
    bench.write("GCONF", bench.raw("GCONF") | STEALTH)
    bench.put(RAMPMODE=FORWARD, **registers)
    bench.wait(1)
    assert bench.field("DRV_STATUS", "stealth") == 1
    return bench


def mean_load_value(bench: Bench) -> float:
    total = 0
    for _ in range(20):
        bench.wait(0.01)
        total += bench.read("SG4_RESULT")
    return total / 20


def test_stallguard4_falls_with_the_load() -> None:
    bench = turning_quietly()
    free = mean_load_value(bench)
    bench.stage(load_torque_nm=0.05)
    bench.wait(0.2)
    loaded = mean_load_value(bench)
    assert free - 30 > loaded > 0
    assert bench.read("SG4_RESULT") == bench.field("DRV_STATUS", "SG_RESULT"), "with StealthChop DRV_STATUS shows it"
    bench.write("GCONF", bench.raw("GCONF") & ~STEALTH)
    bench.wait(0.1)
    assert bench.read("SG4_RESULT") == 0


def test_stallguard4_is_filtered_over_four_values() -> None:
    bench = turning_quietly(SG4_THRS=1 << 8)
    for _ in range(10):
        bench.wait(0.013)
        latest = bench.raw("SG4_IND")
        four = [latest >> shift & 0xFF for shift in (0, 8, 16, 24)]
        assert all(four)
        assert bench.read("SG4_RESULT") == 2 * (sum(four) // 4)
    bench.write("SG4_THRS", 0)
    bench.wait(0.05)
    assert bench.raw("SG4_IND") < 0x100
    assert bench.read("SG4_RESULT") == 2 * bench.raw("SG4_IND")


@pytest.mark.parametrize(("above", "stalls"), [(20, True), (-20, False)])
def test_a_stall_is_at_twice_the_threshold(above: int, stalls: bool) -> None:
    bench = turning_quietly(TCOOLTHRS=0xFFFFF)
    threshold = round(mean_load_value(bench) / 2) + above
    bench.write("SG4_THRS", threshold)
    bench.wait(0.05)
    assert bench.field("DRV_STATUS", "StallGuard") == stalls
    bench.write("SW_MODE", SG_STOP)
    bench.wait(0.3)
    assert (bench.read("VACTUAL") == 0) == stalls
    assert ("event_stop_sg" in bench.flags()) == stalls


# --- virtual stops ------------------------------------------------------------------------------


def test_virtual_stops_end_motion_at_their_positions() -> None:
    bench = moving(MODEL)
    bench.put(VIRTUAL_STOP_L=-5000, VIRTUAL_STOP_R=7000, RAMPMODE=FORWARD)
    bench.wait(2)
    assert bench.read("XACTUAL") > 100_000, "neither is switched on"
    bench.put(RAMPMODE=BACKWARD, SW_MODE=LEFT | RIGHT)
    bench.wait(4)
    assert (bench.read("XACTUAL"), bench.read("VACTUAL")) == (-5000, 0)
    assert {"status_virtual_stop_l", "event_stop_l"} <= bench.flags()
    bench.put(RAMPMODE=FORWARD)
    bench.wait(2)
    assert (bench.read("XACTUAL"), bench.read("VACTUAL")) == (7000, 0)
    flags = bench.flags()
    assert {"status_virtual_stop_r", "event_stop_r"} <= flags
    assert "status_virtual_stop_l" not in flags
    bench.put(SW_MODE=LEFT)
    bench.wait(1)
    assert bench.read("XACTUAL") > 7000


def test_virtual_stops_by_the_encoder() -> None:
    """40,000 counts a turn, and a constant that makes a quarter of a count's place of each: X_ENC counts 10,000."""
    bench = moving(MODEL, rigid=False)
    bench.put(ENC_CONST=1 << 14, X_ENC=0, VIRTUAL_STOP_R=2000, SW_MODE=RIGHT | BY_ENCODER, RAMPMODE=FORWARD)
    bench.wait(2)
    assert bench.read("VACTUAL") == 0
    assert bench.read("X_ENC") == pytest.approx(2000, abs=20)
    assert bench.read("XACTUAL") == pytest.approx(51_200 / 5, abs=100)


# --- ramp and compare ---------------------------------------------------------------------------

EIGHT = {"V1": 20_000, "A1": 6000, "A2": 3000, "V2": 60_000, "AMAX": 1000, "DMAX": 1500, "D2": 4000, "D1": 8000}
TO_WAY = 2**24
"""Velocity units to microsteps: v * fCLK / 2^24 (DS-TMC5160 12.1)."""


def test_a_ramp_of_eight_points_takes_as_long_as_its_legs() -> None:
    """Each leg lasts (v1 - v0) / a; what is left of the way goes by at VMAX, with TVMAX in it."""
    bench = moving(MODEL)
    distance, tvmax = 200_000, 100
    corners = [0, EIGHT["V1"], EIGHT["V2"], VMAX]
    time_s = way = 0.0
    for names in (("A1", "A2", "AMAX"), ("D1", "D2", "DMAX")):
        for (low, high), name in zip(pairwise(corners), names, strict=True):
            leg_s = (high - low) / 2**24 / (EIGHT[name] / 2**41) / CLOCK_HZ
            time_s += leg_s
            way += leg_s * (high + low) / 2 * CLOCK_HZ / TO_WAY
    assert way < distance
    time_s += (distance - way) / (VMAX * CLOCK_HZ / TO_WAY)
    bench.put(**EIGHT, TVMAX=tvmax, VSTOP=10, XTARGET=distance)
    bench.wait(time_s - 0.01)
    assert 0 < bench.read("XACTUAL") < distance
    bench.wait(0.02)
    assert (bench.read("XACTUAL"), bench.read("VACTUAL")) == (distance, 0)


def test_aactual_shows_which_leg_it_is_on() -> None:
    bench = moving(MODEL)
    bench.put(**EIGHT, XTARGET=200_000)
    seen = []
    while "position_reached" not in bench.flags():
        bench.wait(1e-3)
        seen.append((bench.read("AACTUAL"), bench.read("VACTUAL")))
    corners = (0, EIGHT["V1"], EIGHT["V2"], VMAX)
    for names, sign in ((("A1", "A2", "AMAX"), 1), (("D1", "D2", "DMAX"), -1)):
        for (low, high), name in zip(pairwise(corners), names, strict=True):
            # while it brakes the last tick may be a little off: it looks for the target
            within = 0.02 * EIGHT[name] if sign < 0 else 0
            speeds = [speed for now, speed in seen if abs(now - sign * EIGHT[name]) <= within]
            assert len(speeds) > 5, name
            assert low <= min(speeds) <= max(speeds) <= high, name


def test_the_compare_output_repeats() -> None:
    bench = moving(MODEL)
    bench.put(X_COMPARE=1000, X_COMPARE_REPEAT=700)
    high = []
    for position in (300, 999, 1000, 1001, 1700, 2400):
        bench.write("XACTUAL", position)
        if bench.state().position_compare.output:
            high.append(position)
    assert high == [300, 1000, 1700, 2400]
    bench.put(X_COMPARE_REPEAT=1)
    assert not bench.state().position_compare.output, "less than 2: only once"
