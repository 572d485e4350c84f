"""Driver and load: thresholds in TSTEP and in velocity units, StallGuard2, CoolStep, StealthChop, currents, standstill.

With VCOOLTHRS and VHIGH the dual chips look at bits 22..8 of the velocity only. With VHIGH 0, its reset, nothing is
between the two, and neither CoolStep nor a stop by StallGuard2 acts (the data sheets' inequality, taken at its word).
"""

from __future__ import annotations

import pytest

from app.emulators.tmc5xxx import MODELS, Tmc5xxxModel
from tests.emulators.tmc5xxx.rig import (
    CHOPPER_ON,
    DUAL,
    FORWARD,
    ONE_TURN_A_SECOND,
    PLACES,
    SINGLE,
    TURN,
    Bench,
    moving,
)

SG_STOP = 1 << 10
VMAX = 2 * ONE_TURN_A_SECOND


def turning(model: Tmc5xxxModel, axis: int = 0, **registers: int) -> Bench:
    bench = moving(model, axis, rigid=False)
    bench.put(axis, RAMPMODE=FORWARD, **registers)
    bench.wait(1)
    return bench


def load_value(bench: Bench, axis: int = 0) -> float:
    total = 0
    for _ in range(40):
        bench.wait(0.01)
        total += bench.field("DRV_STATUS", "SG_RESULT", axis)
    return total / 40


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_the_load_value_falls_with_the_load_on_its_own_axis(model: Tmc5xxxModel, axis: int) -> None:
    bench = turning(model, axis)
    free = load_value(bench, axis)
    bench.stage(axis, load_torque_nm=0.1)
    bench.wait(0.2)
    assert free > 250
    assert load_value(bench, axis) < free - 60


@pytest.mark.parametrize("model", SINGLE)
@pytest.mark.parametrize("in_range", [False, True])
def test_stallguard_stops_below_tcoolthrs(model: Tmc5xxxModel, in_range: bool) -> None:
    tstep = 2**24 // VMAX
    bench = turning(model, SW_MODE=SG_STOP, TCOOLTHRS=tstep + (2 if in_range else -2))
    assert bench.read("TSTEP") == tstep
    bench.stage(blocked=True)
    bench.wait(0.3)
    assert (bench.read("VACTUAL") == 0) == in_range
    assert ("event_stop_sg" in bench.flags()) == in_range


@pytest.mark.parametrize("model", DUAL)
@pytest.mark.parametrize(
    ("cool", "high", "stops"),
    [
        (VMAX - 256, VMAX + 256, True),
        (VMAX, VMAX, True),
        (VMAX | 0xFF, VMAX & ~0xFF, True),
        (VMAX + 256, VMAX + 512, False),
        (VMAX - 512, VMAX - 256, False),
        (0, 0, False),
    ],
)
def test_stallguard_stops_between_vcoolthrs_and_vhigh(model: Tmc5xxxModel, cool: int, high: int, stops: bool) -> None:
    for axis in (0, 1):
        bench = turning(model, axis, SW_MODE=SG_STOP, VCOOLTHRS=cool, VHIGH=high)
        bench.stage(axis, blocked=True)
        bench.wait(0.3)
        assert (bench.read("VACTUAL", axis) == 0) == stops
        assert ("event_stop_sg" in bench.flags(axis)) == stops


@pytest.mark.parametrize("model", MODELS)
def test_a_stop_by_stallguard_holds_until_its_flag_is_cleared(model: Tmc5xxxModel) -> None:
    window = {"TCOOLTHRS": 0xFFFFF} if model in SINGLE else {"VCOOLTHRS": VMAX - 256, "VHIGH": 0x7FFFFF}
    bench = turning(model, SW_MODE=SG_STOP, **window)
    bench.stage(blocked=True)
    bench.wait(0.5)
    assert bench.read("VACTUAL") == 0
    bench.stage(blocked=False)
    bench.wait(0.5)
    assert bench.read("VACTUAL") == 0
    bench.clear()
    bench.wait(0.1)
    assert bench.read("VACTUAL") > 0


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_coolstep_saves_current_in_its_range_only(model: Tmc5xxxModel, axis: int) -> None:
    inside = {"TCOOLTHRS": 0xFFFFF} if model in SINGLE else {"VCOOLTHRS": 256, "VHIGH": 0x7FFFFF}
    outside = {"TCOOLTHRS": 1} if model in SINGLE else {"VCOOLTHRS": 0x7FFF00, "VHIGH": 0x7FFFFF}
    # semin 2: below 64 more current, semax 0: from 96 on less
    cool = 2 | 3 << 13
    bench = turning(model, axis, COOLCONF=cool, **inside)
    bench.wait(1)
    assert bench.field("DRV_STATUS", "CS_ACTUAL", axis) == (16 + 1) // 2 - 1
    bench.put(axis, **outside)
    bench.wait(0.2)
    assert bench.field("DRV_STATUS", "CS_ACTUAL", axis) == 16


@pytest.mark.parametrize("model", SINGLE)
def test_stealthchop_of_chips_with_one_axis(model: Tmc5xxxModel) -> None:
    bench = turning(model)
    assert load_value(bench) > 0
    bench.put(VMAX=0)
    bench.wait(1)
    bench.write("GCONF", bench.raw("GCONF") | 1 << 2)
    bench.wait(0.3)  # at rest it finds its amplitude: in motion it would have none at first
    bench.put(VMAX=VMAX)
    bench.wait(1)
    assert (bench.field("DRV_STATUS", "SG_RESULT") == 0) == (model != "tmc5240"), "that has StallGuard4"
    assert bench.read("PWM_SCALE") if model == "tmc5130" else bench.field("PWM_SCALE", "PWM_SCALE_SUM") > 0
    if model != "tmc5130":
        assert bench.field("DRV_STATUS", "stealth") == 1
    bench.put(TPWMTHRS=2**24 // VMAX + 5)
    bench.wait(0.3)
    assert load_value(bench) > 0, "above the speed of TPWMTHRS it is SpreadCycle"


@pytest.mark.parametrize("axis", [0, 1])
def test_stealthchop_of_a_tmc5072(axis: int) -> None:
    """It works below VCOOLTHRS where PWM_AMPL is not 0 (a reading: the chip has no bit that enables it)."""
    bench = turning("tmc5072", axis, VCOOLTHRS=VMAX + 256)
    assert bench.field("DRV_STATUS", "SG_RESULT", axis) > 0
    assert bench.read("PWM_STATUS", axis) == 0
    bench.put(axis, PWMCONF=0x401C8)
    bench.wait(0.2)
    assert bench.field("DRV_STATUS", "SG_RESULT", axis) == 0
    assert bench.read("PWM_STATUS", axis) > 0
    bench.put(axis, VCOOLTHRS=VMAX - 256)
    bench.wait(0.3)
    assert load_value(bench, axis) > 0
    assert bench.read("PWM_STATUS", axis) == 0


@pytest.mark.parametrize(("model", "axis"), [place for place in PLACES if place[0] not in ("tmc5160", "tmc5240")])
def test_vsense_takes_the_current_down(model: Tmc5xxxModel, axis: int) -> None:
    bench = moving(model, axis, rigid=False)
    full = bench.state().axes[axis].truth.current_b_a
    share = 0.18 / 0.325 if model == "tmc5130" else 0.18 / 0.32
    bench.put(axis, CHOPCONF=CHOPPER_ON | 1 << 17)
    bench.wait(0.1)
    assert bench.state().axes[axis].truth.current_b_a == pytest.approx(full * share, rel=1e-3)


def test_the_global_scaler_takes_that_of_a_tmc5160_down() -> None:
    bench = moving("tmc5160", rigid=False)
    full = bench.state().axes[0].truth.current_b_a
    bench.write("GLOBAL_SCALER", 128)
    bench.wait(0.1)
    assert bench.state().axes[0].truth.current_b_a == pytest.approx(full / 2, rel=1e-3)
    bench.patch(power_cycle=True)
    bench.put(CHOPCONF=CHOPPER_ON, IHOLD_IRUN=0x1010)
    bench.wait(0.1)
    assert bench.state().axes[0].truth.current_b_a == pytest.approx(full, rel=1e-3)


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_drv_enn_switches_the_bridges_off(model: Tmc5xxxModel, axis: int) -> None:
    bench = moving(model, axis, rigid=False)
    assert bench.state().axes[axis].truth.bridges == "regulated"
    bench.patch(pins={"drv_enn": True})
    bench.wait(0.1)
    truth = bench.state().axes[axis].truth
    assert (truth.bridges, truth.current_b_a) == ("open", 0.0)
    bench.patch(power_cycle=True)
    bench.put(axis, CHOPCONF=CHOPPER_ON, IHOLD_IRUN=0x1010)
    bench.wait(0.1)
    assert bench.state().axes[axis].truth.bridges == "open"
    bench.patch(pins={"drv_enn": False})
    bench.wait(0.1)
    assert bench.state().axes[axis].truth.bridges == "regulated"


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_standstill_takes_2_to_the_20_clocks(model: Tmc5xxxModel, axis: int) -> None:
    bench = moving(model, axis)
    bench.put(axis, XTARGET=100)
    bench.wait(0.01)
    while bench.read("VACTUAL", axis):
        bench.wait(1e-4)
    bench.wait(0.065)
    assert bench.field("DRV_STATUS", "stst", axis) == 0
    bench.wait(0.001)
    assert bench.field("DRV_STATUS", "stst", axis) == 1


@pytest.mark.parametrize(
    ("model", "delay", "delays"),
    [("tmc5160", 10, 10), ("tmc5130", 10, 9), ("tmc5130", 1, 0), ("tmc5072", None, 0), ("tmc5031", None, 0)],
)
def test_how_long_the_run_current_stays_at_standstill(model: Tmc5xxxModel, delay: int | None, delays: int) -> None:
    """TPOWERDOWN counts 2^18 clocks (16.4 ms) from standstill on; the dual chips have no such delay."""
    bench = moving(model)
    bench.put(IHOLD_IRUN=4 | 16 << 8)
    if delay is not None:
        bench.put(TPOWERDOWN=delay)
    bench.put(XTARGET=100)
    bench.wait(0.01)
    while not bench.field("DRV_STATUS", "stst"):
        bench.wait(1e-4)
    bench.wait(delays * 2**18 / 16e6 - 0.001 if delays else 0.0)
    if delays:
        assert bench.field("DRV_STATUS", "CS_ACTUAL") == 16
    bench.wait(0.002)
    assert bench.field("DRV_STATUS", "CS_ACTUAL") == 4


def test_faststandstill_of_a_tmc5160_takes_2_to_the_18() -> None:
    """GCONF bit 1; in a TMC5130 that bit is internal_Rsense."""
    for model, stands in (("tmc5160", 1), ("tmc5130", 0)):
        bench = moving(model)  # type: ignore[arg-type]
        bench.write("GCONF", 1 << 1)
        bench.put(XTARGET=100)
        bench.wait(0.01)
        while bench.read("VACTUAL"):
            bench.wait(1e-4)
        bench.wait(0.017)
        assert bench.field("DRV_STATUS", "stst") == stands


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_an_unplugged_motor_and_a_hot_driver(model: Tmc5xxxModel, axis: int) -> None:
    bench = turning(model, axis)
    bench.stage(axis, motor={"connected": False})
    assert (bench.field("DRV_STATUS", "ola", axis), bench.field("DRV_STATUS", "olb", axis)) == (1, 1)
    bench.stage(axis, motor={"connected": True, "temperature_c": 130})
    assert (bench.field("DRV_STATUS", "otpw", axis), bench.field("DRV_STATUS", "ot", axis)) == (1, 0)
    bench.stage(axis, motor={"temperature_c": 151})
    assert bench.field("DRV_STATUS", "ot", axis) == 1
    assert bench.state().axes[axis].truth.bridges == "open"


@pytest.mark.parametrize(("model", "axis"), [place for place in PLACES if place[0] != "tmc5031"])
def test_coarser_microsteps_move_the_field_further(model: Tmc5xxxModel, axis: int) -> None:
    bench = moving(model, axis)
    bench.put(axis, CHOPCONF=CHOPPER_ON | 4 << 24, XTARGET=1600)
    bench.wait(2)
    assert bench.read("MSCNT", axis) == (1600 * 16 + 8) % 1024
    assert bench.state().axes[axis].truth.rotor_fullsteps == pytest.approx(100 + 8 / 256)


def test_a_tmc5031_always_has_256_microsteps() -> None:
    bench = moving("tmc5031")
    bench.put(CHOPCONF=CHOPPER_ON | 4 << 24, XTARGET=1600)
    bench.wait(2)
    assert bench.read("MSCNT") == 1600 % 1024


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_the_microstep_counter_and_the_table_behind_it(model: Tmc5xxxModel, axis: int) -> None:
    """NOTES-MSLUT: the default table begins at 0 with 247 a quarter further."""
    bench = moving(model, axis)
    assert bench.read("MSCNT", axis) == 0
    assert bench.field("MSCURACT", "CUR_B", axis) == 0
    assert bench.field("MSCURACT", "CUR_A", axis) == 247
    bench.put(axis, XTARGET=256)
    bench.wait(1)
    assert bench.read("MSCNT", axis) == 256
    assert (bench.field("MSCURACT", "CUR_B", axis), bench.field("MSCURACT", "CUR_A", axis)) == (247, -1)
    assert TURN % 1024 == 0
