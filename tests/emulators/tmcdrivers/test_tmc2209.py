"""An emulated TMC2209 by its UART: what its registers do to the motor, and what the motor does to its registers."""

from __future__ import annotations

import pytest

from app.clock import VirtualClock
from app.emulators.drive.documents import ChipFaultsChange, MotorChange
from app.emulators.tmcdrivers import EmulatedDriver, TmcDriverOptions, TmcDriverPatch
from app.emulators.tmcdrivers.options import DriverPinsChange
from app.errors import WrongState
from app.links.datagram_uart import UartForm
from app.registers.catalog import MODELS

TABLE = MODELS["tmc2209"].table
CLOCK_HZ = 12e6
VERSION, ONE_TURN_A_S = 0x21, 71_583
"""VACTUAL of 51200 microsteps a second: 51200 2^24 / 12 MHz (DS-TMC2209 5.2)."""


class Bench:
    """One driver, asked over its wire."""

    def __init__(self, **options: object) -> None:
        self.chip = EmulatedDriver("tmc2209", VirtualClock(), TmcDriverOptions.model_validate(options))
        self.form = UartForm(self.chip.options.node)
        self.time_s = 0.0

    def read(self, name: str) -> int:
        row = TABLE.get(name, 0)
        return self.form.data_of(row.address, self.chip.uart(self.form.read(row.address), self.time_s))

    def fields(self, name: str) -> dict[str, int]:
        return TABLE.get(name, 0).unpack(self.read(name))

    def write(self, name: str, word: int) -> None:
        row = TABLE.get(name, 0)
        assert self.chip.uart(self.form.write(row.address, word & 0xFFFF_FFFF), self.time_s) == b""

    def ready(self, mres: int = 0, *, spread: bool = False, irun: int = 16) -> None:
        """Microsteps by the register, and currents."""
        self.write("GCONF", 0x1C0 | spread << 2)
        self.write("IHOLD_IRUN", irun << 8 | 8)
        self.write("CHOPCONF", 0x1000_0053 | mres << 24)

    def wait(self, seconds: float) -> None:
        self.time_s += seconds

    def patch(self, **change: object) -> None:
        self.chip.patch(TmcDriverPatch.model_validate(change), self.time_s)

    @property
    def turned_fullsteps(self) -> float:
        return self.chip.ground_truth(0, self.time_s).shaft_fullsteps


def test_it_says_who_it_is_and_that_it_was_reset() -> None:
    bench = Bench(node=2)
    pins = bench.fields("IOIN")
    assert (pins["VERSION"], pins["MS1"], pins["MS2"], pins["ENN"]) == (VERSION, 0, 1, 0)
    assert bench.read("GSTAT") == 1
    bench.write("GSTAT", 1)
    assert bench.read("GSTAT") == 0
    bench.patch(power_cycle=True)
    assert (bench.read("GSTAT"), bench.read("GCONF"), bench.read("IFCNT")) == (1, 0x101, 0)


def test_resets_that_can_be_read_are_those_of_the_table() -> None:
    bench = Bench()
    for row in TABLE:
        if row.access.readable and row.access.writable and row.reset is not None:
            assert bench.read(row.name) == row.reset, row.name


@pytest.mark.parametrize("node", [0, 3])
def test_only_its_node_with_a_right_crc_is_obeyed_and_counted(node: int) -> None:
    bench = Bench(node=node)
    right = bench.form.write(0x22, 1000)
    for wrong in (right[:-1] + bytes((right[-1] ^ 1,)), UartForm((node + 1) % 4).write(0x22, 1000), right[:-1]):
        assert bench.chip.uart(wrong, 0.0) == b""
        assert bench.read("IFCNT") == 0
    bench.chip.uart(right, 0.0)
    assert bench.read("IFCNT") == 1


@pytest.mark.parametrize(("mres", "way"), [(0, 1), (0, -1), (4, 1), (8, -1)])
def test_vactual_turns_the_motor_in_its_microsteps(mres: int, way: int) -> None:
    """A full step a second is VACTUAL 256 >> mres microsteps: the shaft has gone that far, and TSTEP says how fast."""
    bench = Bench(motor="rigid")
    bench.ready(mres)
    fullsteps_s = 50
    bench.write("VACTUAL", way * round(fullsteps_s * (256 >> mres) * 2**24 / CLOCK_HZ))
    bench.wait(2.0)
    assert bench.turned_fullsteps == pytest.approx(way * 2 * fullsteps_s, abs=1.5)
    assert CLOCK_HZ / bench.read("TSTEP") / 256 == pytest.approx(fullsteps_s, rel=0.01)
    assert not bench.fields("DRV_STATUS")["stst"]
    bench.write("VACTUAL", 0)
    bench.wait(0.2)
    assert (bench.read("TSTEP"), bench.fields("DRV_STATUS")["stst"]) == (0xFFFFF, 1)


def test_without_mstep_reg_select_the_pins_set_the_microsteps() -> None:
    """DS-TMC2209 3.2: 8, 32, 64 and 16 by MS1 and MS2."""
    for node, microsteps in enumerate((8, 32, 64, 16)):
        bench = Bench(node=node, motor="rigid")
        bench.write("VACTUAL", round(10 * microsteps * 2**24 / CLOCK_HZ))
        bench.wait(2.0)
        assert bench.turned_fullsteps == pytest.approx(20, abs=1.1), microsteps


def test_shaft_turns_it_round() -> None:
    bench = Bench(motor="rigid")
    bench.ready()
    bench.write("GCONF", 0x1C8)
    bench.write("VACTUAL", ONE_TURN_A_S)
    bench.wait(0.5)
    assert bench.turned_fullsteps == pytest.approx(-100, abs=1)


def test_currents_fall_to_the_hold_current_and_vsense_makes_them_smaller() -> None:
    bench = Bench()
    bench.ready(irun=31, spread=True)
    bench.write("VACTUAL", ONE_TURN_A_S // 4)
    bench.wait(0.5)
    bench.write("VACTUAL", 0)
    bench.wait(2.0)
    assert bench.fields("DRV_STATUS")["CS_ACTUAL"] == 8
    truth = bench.chip.state(bench.time_s).truth
    strong = (truth.current_a_a**2 + truth.current_b_a**2) ** 0.5
    assert strong == pytest.approx(2.5 * 9 / 32, rel=0.03)
    bench.write("CHOPCONF", 0x1002_0053)
    bench.wait(0.1)
    truth = bench.chip.state(bench.time_s).truth
    assert (truth.current_a_a**2 + truth.current_b_a**2) ** 0.5 == pytest.approx(strong * 0.18 / 0.325, rel=0.03)


def test_load_lowers_stallguard4_and_diag_shows_a_stall_within_tcoolthrs() -> None:
    bench = Bench()
    bench.ready(irun=31)
    bench.write("VACTUAL", ONE_TURN_A_S)
    bench.wait(2.0)
    free = bench.read("SG_RESULT")
    assert free > 0
    bench.patch(load_torque_nm=0.2)
    bench.wait(1.0)
    loaded = bench.read("SG_RESULT")
    assert loaded < free
    bench.write("SGTHRS", min(loaded, 255))
    bench.wait(0.1)
    assert not bench.fields("IOIN")["DIAG"], "TCOOLTHRS is 0: nothing is within it"
    bench.write("TCOOLTHRS", 0xFFFFF)
    assert bench.fields("IOIN")["DIAG"]
    bench.write("SGTHRS", 0)
    bench.wait(0.1)
    assert not bench.fields("IOIN")["DIAG"]


def test_spreadcycle_and_the_threshold_switch_the_chopper() -> None:
    bench = Bench()
    bench.ready()
    bench.write("VACTUAL", ONE_TURN_A_S // 2)
    bench.wait(0.2)
    assert bench.fields("DRV_STATUS")["stealth"]
    bench.write("TPWMTHRS", bench.read("TSTEP") + 10)
    bench.wait(0.01)
    assert not bench.fields("DRV_STATUS")["stealth"]
    bench.write("TPWMTHRS", 0)
    bench.write("GCONF", 0x1C4)
    bench.wait(0.01)
    assert not bench.fields("DRV_STATUS")["stealth"]


@pytest.mark.parametrize(
    ("celsius", "flags"),
    [(100, set()), (121, {"otpw", "t120"}), (151, {"ot", "otpw", "t120", "t143", "t150"})],
)
def test_temperatures(celsius: float, flags: set[str]) -> None:
    bench = Bench()
    bench.ready()
    bench.patch(motor={"temperature_c": float(celsius)})
    bench.wait(0.01)
    told = {name for name, value in bench.fields("DRV_STATUS").items() if value and name not in ("CS_ACTUAL", "stst")}
    assert told - {"stealth"} == flags
    assert bench.fields("IOIN")["DIAG"] == ("ot" in flags)


def test_a_short_shuts_it_down_and_an_open_load_is_told() -> None:
    bench = Bench()
    bench.ready()
    bench.patch(motor=MotorChange(short_to_ground="b"))
    bench.wait(0.01)
    assert (bench.fields("DRV_STATUS")["s2gb"], bench.fields("GSTAT")["drv_err"]) == (1, 1)
    bench.patch(motor=MotorChange(short_to_ground="none", connected=False))
    bench.wait(0.01)
    assert (bench.fields("DRV_STATUS")["ola"], bench.fields("DRV_STATUS")["olb"]) == (1, 1)


def test_enn_switches_the_bridges_off() -> None:
    bench = Bench()
    bench.ready()
    bench.patch(pins=DriverPinsChange(enn=True))
    bench.wait(0.1)
    assert bench.fields("IOIN")["ENN"]
    assert bench.chip.state(bench.time_s).truth.bridges == "open"


def test_faults_of_the_link() -> None:
    bench = Bench()
    bench.patch(faults=ChipFaultsChange(silence=True))
    with pytest.raises(TimeoutError):
        bench.read("GCONF")
    bench.patch(faults=ChipFaultsChange(silence=False, bit_error_rate=1.0))
    with pytest.raises(ValueError, match="CRC"):
        bench.read("GCONF")


def test_a_rigid_motor_takes_no_load() -> None:
    bench = Bench(motor="rigid")
    with pytest.raises(WrongState):
        bench.patch(load_torque_nm=0.1)


def test_phase_a_is_the_sine() -> None:
    """DS-TMC2209 5.4: MSCNT is the place of CUR_A, CUR_B is 256 ahead."""
    bench = Bench(motor="rigid")
    bench.ready()
    bench.write("VACTUAL", ONE_TURN_A_S // 100)
    for _ in range(20):
        bench.wait(0.031)
        place, currents = bench.read("MSCNT"), bench.fields("MSCURACT")
        quarter = place // 256
        assert (currents["CUR_A"] >= 0) == (quarter in (0, 1))
        assert (currents["CUR_B"] >= 0) == (quarter in (0, 3))
