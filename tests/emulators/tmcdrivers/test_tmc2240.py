"""An emulated TMC2240: both buses, ranges of current, StallGuard4 and the ADC."""

from __future__ import annotations

import pytest

from app.links import datagram40
from app.links.datagram_uart import UartForm
from tests.emulators.tmcdrivers.bench import Bench

CHOPPER = 0x1041_0153


def ready(gconf: int = 0x8, irun: int = 31, **options: object) -> Bench:
    made = Bench("tmc2240", **options)
    made.write("GCONF", gconf)
    made.write("IHOLD_IRUN", irun << 8 | 8)
    made.write("CHOPCONF", CHOPPER)
    return made


def test_both_buses_reach_the_same_registers() -> None:
    bench = Bench("tmc2240", node=1)
    bench.chip.exchange(datagram40.write(0x0B, 200), 0.0)
    form = UartForm(1)
    assert form.data_of(0x0B, bench.chip.uart(form.read(0x0B), 0.0)) == 200
    bench.chip.uart(form.write(0x03, 6), 0.0)
    assert bench.chip.uart(form.read(0x0B), 0.0) == b"", "it is at node 7 now: NODECONF and the levels of its pins"
    assert UartForm(7).data_of(0x04, bench.chip.uart(UartForm(7).read(0x04), 0.0)) >> 24 == 0x40


def test_resets_that_can_be_read_are_those_of_the_table() -> None:
    bench = Bench("tmc2240")
    for row in bench.table:
        if row.access.readable and row.access.writable and row.reset is not None:
            assert bench.read(row.name) == row.reset, row.name


@pytest.mark.parametrize(("current_range", "full_a"), [(0, 11.75 / 12), (1, 2.0), (2, 3.0)])
@pytest.mark.parametrize("scaler", [0, 128])
def test_current_at_rest_by_range_and_scaler(current_range: int, full_a: float, scaler: int) -> None:
    """KLIPPER: 12 kOhm at IREF, IHOLD 8."""
    bench = ready()
    bench.write("DRV_CONF", current_range)
    bench.write("GLOBAL_SCALER", scaler)
    bench.wait(1.5)
    assert bench.peak_a == pytest.approx(full_a * (scaler or 256) / 256 * 9 / 32, rel=0.03)


def test_load_is_measured_by_stallguard2_in_spreadcycle_and_by_stallguard4_in_stealthchop() -> None:
    """DRV_STATUS shows the one that works."""
    for gconf, shown in ((0x8, "SG_RESULT"), (0xC, "SG4")):
        bench = ready(gconf)
        bench.write("DRV_CONF", 2)
        bench.write("TCOOLTHRS", 0xFFFFF)
        bench.step(51_200)
        bench.wait(2.0)

        def loads(bench: Bench = bench) -> dict[str, int]:
            return {"SG_RESULT": bench.fields("DRV_STATUS")["SG_RESULT"], "SG4": bench.read("SG4_RESULT")}

        free = loads()
        bench.patch(load_torque_nm=0.2)
        bench.wait(1.0)
        assert 0 < loads()[shown] < free[shown], shown
        assert loads()["SG4"] == (loads()["SG_RESULT"] if shown == "SG4" else 0)


def test_the_adc_measures_supply_and_temperature_and_a_register_says_when_it_warns() -> None:
    """KLIPPER: 9.732 mV a step; 2038 is 0 degC, 7.7 steps a degree."""
    bench = ready()
    bench.patch(supply_v=24.0, motor={"temperature_c": 60.0})
    bench.wait(0.01)
    assert bench.fields("ADC_VSUPPLY_AIN")["ADC_VSUPPLY"] * 9.732e-3 == pytest.approx(24, abs=0.01)
    assert (bench.read("ADC_TEMP") - 2038) / 7.7 == pytest.approx(60, abs=0.1)
    assert not bench.fields("DRV_STATUS")["otpw"]
    bench.write("OTW_OV_VTH", round(2038 + 7.7 * 50) << 16 | 0xF25)
    assert bench.fields("DRV_STATUS")["otpw"]


def test_flags_of_reset_and_of_a_supply_that_is_too_low() -> None:
    bench = ready()
    assert bench.fields("GSTAT") == {"reset": 1, "drv_err": 0, "uv_cp": 0, "register_reset": 1, "vm_uvlo": 0}
    bench.write("GSTAT", 0x1F)
    bench.patch(supply_v=4.0)
    bench.wait(0.01)
    assert bench.fields("GSTAT")["vm_uvlo"]
    bench.patch(supply_v=24.0)
    assert bench.fields("GSTAT")["vm_uvlo"], "it is kept"
    bench.write("GSTAT", 0x1F)
    assert bench.read("GSTAT") == 0


def test_stealthchop_tells_its_amplitude_with_two_bits_more() -> None:
    bench = ready(0xC)
    bench.step(25_600)
    bench.wait(1.0)
    assert bench.fields("PWM_SCALE")["PWM_SCALE_SUM"] % 4 == 0
    assert bench.fields("PWM_SCALE")["PWM_SCALE_SUM"] > 0
    assert bench.fields("DRV_STATUS")["stealth"]
