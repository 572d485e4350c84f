"""Time, registers, currents at rest and in motion, power."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from app.emulators.drive import Drive, DriveOptions, EncoderOptions, EventKind, MotorOptions, StageSwitches
from app.emulators.drive.registers import READ_ONLY, WRITABLE
from tests.emulators.drive.rig import (
    CHOPPER_ON,
    ONE_TURN_A_SECOND,
    RATED,
    SECOND,
    bit,
    energised,
    load_value,
    until,
    wait,
    write,
)

DELAY = 1 << 18
EVERYTHING = EventKind(0x1FFF)


def everything(drive: Drive) -> dict[str, object]:
    """All that can be seen of a drive."""
    registers = {name: drive.read(name) for name in (*WRITABLE, *READ_ONLY, "RAMP_STAT", "GSTAT", "ENC_STATUS")}
    encoders = [(e.counts, e.position, e.exceeded, e.clear_on_null) for e in (drive.internal, drive.external)]
    return {
        "clocks": drive.clocks,
        "plant": drive.plant_state,
        "encoders": encoders,
        "switches": drive.switches,
        **registers,
    }


def busy(seed: int = 3) -> Drive:
    """One that moves between switches under load, with stalls and deviation looked for."""
    drive = energised(seed=seed, stage=StageSwitches(left_at_fullsteps=-90.0, right_at_fullsteps=150.0))
    drive.plant.load_torque_nm = 0.05
    drive.internal.limit = 40_000
    write(drive, {"SW_MODE": 0x0EF, "TCOOLTHRS": 0xFFFFF, "COOLCONF": 0x0000_2304, "VMAX": 3 * ONE_TURN_A_SECOND})
    return drive


def play(drive: Drive, seed: int) -> None:
    """A minute's worth of somebody's commands, each at its own moment."""
    random_ = random.Random(seed)
    for _ in range(6):
        drive.write("XTARGET", random_.randrange(-40_000, 60_000))
        yield_at = drive.clocks + random_.randrange(1, SECOND // 2)
        yield_to(drive, yield_at)


def yield_to(drive: Drive, clocks: int) -> None:
    while drive.advance(clocks) is not None:
        pass


@given(cuts=st.lists(st.integers(0, 8_000_000), max_size=30), watching=st.booleans())
@settings(max_examples=20, deadline=None)
def test_it_makes_no_difference_in_how_many_pieces_time_is_advanced(cuts: list[int], watching: bool) -> None:
    whole, cut = busy(), busy()
    if watching:
        cut.watch = EVERYTHING
    start = whole.clocks
    for target in (30_000, -30_000):
        for drive in (whole, cut):
            drive.write("XTARGET", target)
        start = whole.clocks
        yield_to(whole, start + 8_000_000)
        for at in sorted(cuts):
            yield_to(cut, start + at)
        yield_to(cut, start + 8_000_000)
        assert everything(whole) == everything(cut)


def test_the_same_seed_gives_the_same_run_and_another_one_other_noise() -> None:
    runs = []
    for seed in (3, 3, 4):
        drive = busy(seed)
        play(drive, 1)
        drive.write("VMAX", 0)
        runs.append(everything(drive))
        write(drive, {"SW_MODE": 0, "VMAX": ONE_TURN_A_SECOND, "RAMPMODE": 1})
        wait(drive, 0.5)
        loads = []
        for _ in range(20):
            wait(drive, 0.01)
            loads.append(load_value(drive))
        runs[-1]["load"] = loads
    assert runs[0] == runs[1]
    assert runs[0]["load"] != runs[2]["load"]


def test_events_come_at_their_tick_and_time_never_goes_back() -> None:
    drive = energised()
    drive.watch = EventKind.POSITION_REACHED
    drive.write("XTARGET", 5000)
    end = drive.clocks + SECOND
    event = drive.advance(end)
    assert event is not None
    assert event.clocks == drive.clocks < end
    assert event.clocks % 256 == 0
    assert drive.advance(end) is None
    assert drive.clocks == end
    with pytest.raises(ValueError, match="is over"):
        drive.advance(end - 1)


@pytest.mark.parametrize("name", [n for n in WRITABLE if n not in ("X_ENC", "XACTUAL")])
def test_a_register_reads_back_what_was_written_within_its_width(name: str) -> None:
    drive = Drive()
    assert drive.read(name) == WRITABLE[name].reset
    row = WRITABLE[name]
    drive.write(name, 0x5_5555_5555)
    assert drive.read(name) == 0x55555555 & ((1 << row.bits) - 1)
    drive.write(name, -1)
    assert drive.read(name) == (-1 if row.signed else (1 << row.bits) - 1)


def test_positions_can_be_written() -> None:
    drive = Drive()
    write(drive, {"RAMPMODE": 3, "XACTUAL": 0xFFFF_FFFE, "X_ENC": -77, "GLOBAL_SCALER": 40})
    assert (drive.read("XACTUAL"), drive.read("X_ENC"), drive.read("GLOBALSCALER")) == (-2, -77, 40)


def test_registers_that_are_not_there_and_those_that_can_only_be_read_are_refused() -> None:
    drive = Drive()
    with pytest.raises(KeyError, match="VMIN"):
        drive.write("VMIN", 1)
    with pytest.raises(KeyError, match="VMIN"):
        drive.read("VMIN")
    with pytest.raises(PermissionError, match="DRV_STATUS"):
        drive.write("DRV_STATUS", 1)


def test_options_that_could_not_be_computed_are_refused() -> None:
    with pytest.raises(ValidationError, match="physics steps"):
        DriveOptions(motor=MotorOptions(rotor_inertia_kgm2=1e-8))
    with pytest.raises(ValidationError, match="left"):
        StageSwitches(left_at_fullsteps=1.0, right_at_fullsteps=0.0)
    assert DriveOptions(regulator_s=5e-5).steps_a_tick == 2


def test_more_physics_steps_a_tick_change_little() -> None:
    places = []
    for regulator_s in (8e-5, 8e-5 / 3):
        drive = energised(regulator_s=regulator_s)
        drive.write("XTARGET", 30_000)
        until(drive, EventKind.POSITION_REACHED)
        places.append(drive.plant_state.rotor_fullsteps)
    assert places[0] == pytest.approx(places[1], abs=0.02)


def test_the_current_falls_to_the_hold_current_in_steps_after_its_delay() -> None:
    drive = energised()
    write(drive, {"IHOLD_IRUN": 4 | 20 << 8 | 2 << 16, "TPOWERDOWN": 6, "XTARGET": 3000})
    wait(drive, 0.01)
    assert drive.plant_state.current_scale == 20
    assert not bit(drive.read("DRV_STATUS"), 31)
    stop = until(drive, EventKind.POSITION_REACHED).clocks
    standstill = until(drive, EventKind.STANDSTILL).clocks
    assert standstill - stop == pytest.approx(1 << 20, abs=512)
    assert bit(drive.read("DRV_STATUS"), 31)
    falls = []
    last = 20
    for at in range(standstill, standstill + 50 * DELAY, 2048):
        drive.advance(at)
        now = drive.plant_state.current_scale
        if now != last:
            falls.append((now, (at - standstill) / DELAY))
            last = now
    assert [scale for scale, _ in falls] == list(range(19, 3, -1))
    assert falls[0][1] == pytest.approx(6 + 2, abs=0.05)
    assert falls[-1][1] == pytest.approx(6 + 2 * 16, abs=0.05)
    assert (drive.read("DRV_STATUS") >> 16) & 31 == 4
    drive.write("XTARGET", 0)
    wait(drive, 0.01)
    assert drive.plant_state.current_scale == 20


def test_scalers_make_the_current() -> None:
    drive = Drive()
    write(drive, {"CHOPCONF": CHOPPER_ON, "IHOLD_IRUN": 31 | 31 << 8})
    wait(drive, 0.1)
    assert drive.plant_state.current_b_a == pytest.approx(4.2, rel=0.003)
    write(drive, {"GLOBALSCALER": 128, "IHOLD_IRUN": 15 | 15 << 8})
    wait(drive, 0.1)
    assert drive.plant_state.current_b_a == pytest.approx(4.2 / 4, rel=0.003)


def test_without_toff_the_rotor_is_free() -> None:
    drive = energised()
    drive.write("CHOPCONF", CHOPPER_ON & ~0xF)
    drive.plant.load_torque_nm = 0.05
    wait(drive, 0.2)
    truth = drive.plant_state
    assert truth.bridges == "open"
    assert (truth.current_a_a, truth.current_b_a) == (0.0, 0.0)
    assert truth.speed_rad_s < -20
    assert drive.read("XACTUAL") == 0


@pytest.mark.parametrize(("mode", "bridges"), [(0, "voltage"), (1, "open"), (2, "shorted"), (3, "shorted")])
def test_a_standing_motor_freewheels_or_brakes_in_stealthchop(mode: int, bridges: str) -> None:
    drive = energised()
    write(drive, {"GCONF": 0x4, "IHOLD_IRUN": RATED << 8, "PWMCONF": 0xC40C001E | mode << 20, "XTARGET": 100})
    until(drive, EventKind.STANDSTILL)
    wait(drive, 0.5)
    assert drive.plant_state.bridges == bridges
    drive.plant.load_torque_nm = 0.1
    wait(drive, 0.5)
    speed = abs(drive.plant_state.speed_rad_s)
    if mode == 0:  # a 32nd of the current is left, which is not enough, and bridges that are a voltage brake too
        assert 1 < speed < 30
    elif mode == 1:
        free = (0.1 - 0.005) / 1e-3
        assert speed == pytest.approx(free, rel=0.15)
    else:  # back-EMF drives a current that brakes
        assert speed < 30
    drive.write("PWMCONF", 0xC40C001E)
    wait(drive, 0.1)
    assert drive.plant_state.bridges == "voltage"


def test_stealthchop_ends_above_its_threshold() -> None:
    drive = energised()
    turn = 2**24 // ONE_TURN_A_SECOND
    write(drive, {"GCONF": 0x4, "TPWMTHRS": turn, "VMAX": ONE_TURN_A_SECOND // 2, "RAMPMODE": 1})
    wait(drive, 0.5)
    assert bit(drive.read("DRV_STATUS"), 14)
    assert 0 < drive.read("PWM_SCALE") & 0xFF < 255
    assert drive.read("TSTEP") == pytest.approx(2 * turn, rel=0.01)
    drive.write("VMAX", 2 * ONE_TURN_A_SECOND)
    wait(drive, 0.5)
    assert not bit(drive.read("DRV_STATUS"), 14)
    assert drive.read("PWM_SCALE") == 0


def test_a_coarser_resolution_takes_bigger_steps_and_interpolates_them() -> None:
    drive = energised()
    write(drive, {"CHOPCONF": CHOPPER_ON | 4 << 24, "VMAX": ONE_TURN_A_SECOND // 16, "XTARGET": 16 * 50})
    event = until(drive, EventKind.POSITION_REACHED)
    wait(drive, 0.2)
    assert event.position == 800
    assert drive.plant_state.rotor_fullsteps == pytest.approx(50, abs=0.1)
    smooth = []
    for interpolate in (0, 1):
        write(drive, {"CHOPCONF": CHOPPER_ON | 4 << 24 | interpolate << 28, "RAMPMODE": 1})
        wait(drive, 0.5)
        seen = set()
        for _ in range(3000):
            drive.advance(drive.clocks + 256)
            seen.add(drive.read("MSCNT"))
        smooth.append(len(seen))
        write(drive, {"RAMPMODE": 0, "XTARGET": 0})
        until(drive, EventKind.POSITION_REACHED)
        assert drive.read("MSCNT") == 8
    assert smooth[0] <= 64
    assert smooth[1] > 900


def test_shaft_turns_the_motor_around() -> None:
    drive = energised()
    write(drive, {"GCONF": 0x10, "XTARGET": 2560})
    until(drive, EventKind.POSITION_REACHED)
    wait(drive, 0.2)
    assert drive.plant_state.rotor_fullsteps == pytest.approx(-10, abs=0.1)
    assert drive.plant_state.lost_fullsteps == 0


def test_the_table_in_the_chip_makes_the_currents() -> None:
    drive = energised()
    drive.write("XTARGET", 30)
    until(drive, EventKind.POSITION_REACHED)
    wait(drive, 0.2)
    word = drive.read("MSCURACT")
    assert (word & 0x1FF, word >> 16 & 0x1FF) == (45, 243)  # a register dump of a real TMC5160
    drive.write("MSLUTSTART", 0x00F7_0000 | 3)
    assert drive.read("MSCURACT") & 0x1FF == 48
    wait(drive, 0.01)
    assert drive.plant_state.current_a_a == pytest.approx(4.2 * 12 / 32 * 48.5 / 248, abs=1e-6)


def test_undervoltage_heat_and_a_pulled_plug_switch_the_bridges_off() -> None:
    drive = energised()
    assert drive.read("GSTAT") == 1
    drive.write("GSTAT", 7)
    drive.plant.supply_v = 5.0
    wait(drive, 0.1)
    assert drive.plant_state.bridges == "open"
    assert drive.read("GSTAT") == 4
    drive.plant.supply_v = 24.0
    assert drive.read("GSTAT") == 4
    drive.write("GSTAT", 4)
    wait(drive, 0.1)
    assert (drive.read("GSTAT"), drive.plant_state.bridges) == (0, "regulated")
    drive.plant.temperature_c = 130.0
    assert (drive.read("DRV_STATUS") >> 25) & 3 == 2
    drive.plant.temperature_c = 155.0
    wait(drive, 0.1)
    assert (drive.read("DRV_STATUS") >> 25) & 3 == 3
    assert (drive.read("GSTAT"), drive.plant_state.bridges) == (2, "open")
    drive.plant.temperature_c = 130.0
    wait(drive, 0.1)
    assert drive.plant_state.bridges == "open"
    drive.plant.temperature_c = 60.0
    wait(drive, 0.1)
    assert drive.plant_state.bridges == "regulated"
    drive.plant.motor_connected = False
    wait(drive, 0.1)
    assert (drive.read("DRV_STATUS") >> 29) & 3 == 3
    assert drive.plant_state.current_b_a == 0.0


def test_a_power_cycle_forgets_registers_but_not_where_the_rotor_is() -> None:
    drive = energised(encoders=EncoderOptions(internal_zero_fullsteps=0.0))
    drive.write("XTARGET", 256 * 41)
    until(drive, EventKind.POSITION_REACHED)
    wait(drive, 0.3)
    absolute, clocks, load = drive.internal.absolute, drive.clocks, 0.01
    drive.plant.load_torque_nm = load
    drive.power_cycle()
    assert drive.clocks == clocks
    assert (drive.read("XACTUAL"), drive.read("VMAX"), drive.read("GSTAT")) == (0, 0, 1)
    assert (drive.internal.position, drive.external.position, drive.internal.absolute) == (0, 0, absolute)
    assert drive.plant_state.rotor_fullsteps == pytest.approx(41, abs=0.1)
    assert drive.plant.load_torque_nm == load
    write(drive, {"CHOPCONF": CHOPPER_ON, "IHOLD_IRUN": RATED})
    wait(drive, 0.3)
    # MSCNT 0 is a place every four full steps
    assert drive.plant_state.rotor_fullsteps == pytest.approx(40, abs=0.2)
    assert drive.plant_state.lost_fullsteps == 0


@pytest.mark.parametrize(
    ("name", "value"),
    [("load_torque_nm", 51.0), ("supply_v", -1.0), ("extra_friction_nm", -0.1), ("supply_v", float("nan"))],
)
def test_a_plant_value_out_of_range_is_refused(name: str, value: float) -> None:
    drive = Drive()
    before = getattr(drive.plant, name)
    with pytest.raises(ValueError, match=name):
        setattr(drive.plant, name, value)
    assert getattr(drive.plant, name) == before
