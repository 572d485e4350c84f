"""PyTrinamic, the manufacturer's own client, as it comes from PyPI: what it can do with a module it can do here."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from pytrinamic.connections import ConnectionManager
from pytrinamic.modules import TMCM1241
from pytrinamic.tmcl import TMCLCommand, TMCLReplyChecksumError, TMCLReplyStatusError, TMCLStatus

from app.registers.model import Space
from app.registers.tmcl.pd42 import PD42
from tests.peers.conftest import patch
from tests.peers.emulator_process import EmulatorProcess

SOON_S = 20.0
AP = TMCM1241._MotorTypeA.AP
NUMBERS = {name: number for name, number in vars(AP).items() if not name.startswith("_")}
"""Every axis parameter that PyTrinamic knows of this module."""
GLOBALS = {name: number for name, number in vars(TMCM1241.GP0).items() if not name.startswith("_")}


@pytest.fixture(params=["pty", "tcp"])
def connection(modules: EmulatorProcess, request: pytest.FixtureRequest) -> Iterator[Any]:
    """A connection by PyTrinamic's own manager: its serial interface, or its own one for sockets."""
    if request.param == "pty":
        arguments = f"--interface serial_tmcl --port {modules.pty} --data-rate 115200"
    else:
        assert modules.tcp is not None
        arguments = f"--interface socket_serial_tmcl --port {modules.tcp[0]}:{modules.tcp[1]}"
    with ConnectionManager(f"{arguments} --timeout 5").connect() as connection:
        yield connection


@pytest.fixture
def module(connection: Any) -> Any:
    return TMCM1241(connection)


@pytest.fixture
def motor(module: Any) -> Any:
    return module.motors[0]


def wait_for(condition: Callable[[], bool]) -> None:
    until_s = time.monotonic() + SOON_S
    while not condition():
        assert time.monotonic() < until_s, "it does not come"


def refused(call: Callable[[], object]) -> int:
    """The status with which the module refuses `call`."""
    with pytest.raises(TMCLReplyStatusError) as error:
        call()
    return int(error.value.status_code)


# --- what it is ---------------------------------------------------------------------------------


def test_the_version_in_both_forms(connection: Any) -> None:
    assert connection.get_version_string() == "1241V144"
    reply = connection.send(TMCLCommand.GET_FIRMWARE_VERSION, 1, 0, 0)
    assert reply.value == 1241 << 16 | 1 << 8 | 44


def test_what_this_firmware_has_not_is_told(connection: Any) -> None:
    assert refused(lambda: connection.send(TMCLCommand.GET_INFO, 0, 0, 0)) == TMCLStatus.INVALID_COMMAND


# --- axis parameters ----------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "3.6.6")
@pytest.mark.parametrize("name", NUMBERS)
def test_every_axis_parameter_can_be_read(shared_connection: Any, name: str) -> None:
    row = PD42.at(NUMBERS[name], Space.AXIS)
    assert row is not None
    value = shared_connection.get_axis_parameter(NUMBERS[name], 0, signed=True)
    assert row.minimum <= value <= row.maximum


@pytest.fixture(scope="module")
def shared_connection(shared_emulator: EmulatorProcess) -> Iterator[Any]:
    with ConnectionManager(f"--interface serial_tmcl --port {shared_emulator.pty}").connect() as connection:
        yield connection


@pytest.mark.sheet("FM-PD42-1241", "3.6.5")
def test_axis_parameters_hold_what_is_written(motor: Any) -> None:
    for number, value in (
        (AP.MaxVelocity, 60_000),
        (AP.MaxAcceleration, 120_000),
        (AP.MaxCurrent, 200),
        (AP.StandbyCurrent, 16),
        (AP.RightLimitSwitchDisable, 1),
        (AP.MicrostepResolution, 5),
        (AP.SG2Threshold, -12),
        (AP.StopVelocity, 12),
    ):
        motor.set_axis_parameter(number, value)
        assert motor.get_axis_parameter(number, signed=True) == value
    motor.actual_position = -70_000
    assert motor.actual_position == -70_000


def test_features_read_and_write_by_name(motor: Any) -> None:
    motor.drive_settings.max_current = 128
    motor.linear_ramp.max_velocity = 40_000
    motor.linear_ramp.max_acceleration = 80_000
    motor.stallguard2.threshold = 7
    assert (motor.drive_settings.max_current, motor.linear_ramp.max_velocity) == (128, 40_000)
    assert (motor.linear_ramp.max_acceleration, motor.stallguard2.threshold) == (80_000, 7)
    # Not coolstep: its text asks for a parameter that PyTrinamic's own list for this module does not have.
    for feature in (motor, motor.drive_settings, motor.linear_ramp, motor.stallguard2):
        assert str(feature)


@pytest.mark.sheet("FM-PD42-1241", "3.2.1")
def test_what_cannot_be_is_refused_with_the_manuals_status(connection: Any) -> None:
    assert refused(lambda: connection.send(99, 0, 0, 0)) == TMCLStatus.INVALID_COMMAND
    assert refused(lambda: connection.get_axis_parameter(253, 0)) == TMCLStatus.WRONG_TYPE
    assert refused(lambda: connection.set_axis_parameter(AP.MicrostepResolution, 0, 9)) == TMCLStatus.INVALID_VALUE
    assert refused(lambda: connection.get_axis_parameter(AP.ActualPosition, 1)) == TMCLStatus.INVALID_VALUE
    assert refused(lambda: connection.set_axis_parameter(AP.LoadValue, 0, 1)) in (
        TMCLStatus.WRONG_TYPE,
        TMCLStatus.INVALID_VALUE,
    )
    assert connection.get_axis_parameter(AP.ActualPosition, 0) == 0, "and the next command is as good as ever"


# --- motion -------------------------------------------------------------------------------------


def hurry(motor: Any) -> None:
    """A turn a second is the default; tests have less time."""
    motor.linear_ramp.max_velocity = 200_000
    motor.linear_ramp.max_acceleration = 1_000_000
    motor.set_axis_parameter(AP.MaxDeceleration, 1_000_000)
    motor.set_axis_parameter(AP.A1, 1_000_000)
    motor.set_axis_parameter(AP.D1, 1_000_000)
    motor.drive_settings.max_current = 255


@pytest.mark.sheet("FM-PD42-1241", "3.6.4")
def test_it_moves_to_and_by_and_tells_when_it_is_there(motor: Any) -> None:
    hurry(motor)
    motor.move_to(30_000)
    assert motor.get_position_reached() == 0
    wait_for(motor.get_position_reached)
    assert (motor.actual_position, motor.target_position) == (30_000, 30_000)
    before = motor.get_axis_parameter(AP.EncoderPosition, signed=True)
    motor.move_by(-50_000)
    wait_for(lambda: motor.actual_position == -20_000)
    assert motor.get_position_reached() == 1
    after = motor.get_axis_parameter(AP.EncoderPosition, signed=True)
    assert after - before == pytest.approx(-50_000, abs=600), "a motor turned, not only a number"


@pytest.mark.sheet("FM-PD42-1241", "3.6.1")
@pytest.mark.sheet("FM-PD42-1241", "3.6.3")
@pytest.mark.parametrize("velocity", [40_000, -40_000])
def test_it_rotates_and_stops(motor: Any, velocity: int) -> None:
    hurry(motor)
    motor.rotate(velocity)
    wait_for(lambda: motor.actual_velocity == velocity)
    assert motor.target_velocity == velocity
    motor.stop()
    wait_for(lambda: motor.actual_velocity == 0)
    here = motor.actual_position
    assert here * velocity > 0
    assert motor.actual_position == here


@pytest.mark.sheet("FM-PD42-1241", "3.6.2")
def test_rotating_left_counts_down(connection: Any, motor: Any) -> None:
    hurry(motor)
    connection.send(TMCLCommand.ROL, 0, 0, 30_000)
    wait_for(lambda: motor.actual_velocity == -30_000)
    motor.stop()


@pytest.mark.sheet("FM-PD42-1241", "3.6.13")
def test_it_finds_its_reference_switch(connection: Any, modules: EmulatorProcess, motor: Any) -> None:
    hurry(motor)
    patch(modules, 1, stage={"left_at_fullsteps": -150.0, "right_at_fullsteps": 4000.0, "position_fullsteps": 0.0})
    motor.set_axis_parameter(AP.ReferenceSearchMode, 1)  # the left stop switch, and no other
    motor.set_axis_parameter(AP.ReferenceSearchSpeed, 60_000)
    motor.set_axis_parameter(AP.ReferenceSwitchSpeed, 20_000)
    assert connection.reference_search(2, 0) == 0
    connection.reference_search(0, 0)
    assert connection.reference_search(2, 0) != 0
    wait_for(lambda: connection.reference_search(2, 0) == 0)
    state = patch(modules, 1)
    stage = state["stage"]
    assert isinstance(stage, dict)
    assert stage["position_fullsteps"] == pytest.approx(-150.0, abs=3.0), "where the switch really is"
    assert motor.actual_position == pytest.approx(0, abs=1500), "and there is zero now"


def test_a_reference_search_can_be_ended(connection: Any, motor: Any) -> None:
    hurry(motor)
    motor.set_axis_parameter(AP.ReferenceSearchMode, 1)
    connection.reference_search(0, 0)
    connection.reference_search(1, 0)
    assert connection.reference_search(2, 0) == 0
    wait_for(lambda: motor.actual_velocity == 0)


@pytest.mark.sheet("FM-PD42-1241", "3.6.35")
def test_the_position_reached_event_comes_by_itself(connection: Any, motor: Any) -> None:
    hurry(motor)
    connection.send(TMCLCommand.TARGET_POSITION_REACHED, 1, 0, 1)
    motor.move_to(10_000)
    # What PyTrinamic has for a frame that nobody asked for at that moment: to receive it.
    event = connection._recv(2, 1)
    assert event[2:4] == bytes((128, 138))
    assert motor.actual_position == 10_000


# --- everything else ----------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "3.6.8")
@pytest.mark.parametrize("name", GLOBALS)
def test_every_global_parameter_can_be_read(shared_connection: Any, name: str) -> None:
    row = PD42.at(GLOBALS[name], Space.GLOBAL_0)
    assert row is not None
    assert row.minimum <= shared_connection.get_global_parameter(GLOBALS[name], 0, signed=True) <= row.maximum


@pytest.mark.sheet("FM-PD42-1241", "3.6.7")
def test_global_parameters_hold_what_is_written(module: Any) -> None:
    module.set_global_parameter(TMCM1241.GP0.AutoStartMode, 0, 1)
    assert module.get_global_parameter(TMCM1241.GP0.AutoStartMode, 0) == 1
    module.set_global_parameter(TMCM1241.GP0.AutoStartMode, 0, 0)
    module.set_global_parameter(TMCM1241.GP3.Timer_1, 3, 250)
    assert module.get_global_parameter(TMCM1241.GP3.Timer_1, 3) == 250
    assert refused(lambda: module.get_global_parameter(200, 0)) == TMCLStatus.WRONG_TYPE


@pytest.mark.sheet("FM-PD42-1241", "3.6.9")
@pytest.mark.sheet("FM-PD42-1241", "3.6.10")
def test_user_variables_are_kept_when_they_are_stored(module: Any, modules: EmulatorProcess) -> None:
    module.set_global_parameter(42, 2, -123_456)
    module.store_global_parameter(42, 2)
    module.set_global_parameter(42, 2, 7)
    module.restore_global_parameter(42, 2)
    assert module.get_global_parameter(42, 2, signed=True) == -123_456
    module.set_global_parameter(43, 2, 99)
    patch(modules, 1, power_cycle=True)
    assert module.get_global_parameter(42, 2, signed=True) == -123_456
    assert module.get_global_parameter(43, 2) == 0


@pytest.mark.sheet("FM-PD42-1241", "3.6.22")
@pytest.mark.sheet("FM-PD42-1241", "3.6.23")
def test_coordinates_can_be_stored_read_and_moved_to(connection: Any, motor: Any) -> None:
    hurry(motor)
    connection.send(TMCLCommand.SCO, 5, 0, 12_345)
    assert connection.send(TMCLCommand.GCO, 5, 0, 0).value == 12_345
    connection.move(2, 0, 5)
    wait_for(lambda: motor.actual_position == 12_345)
    connection.send(TMCLCommand.CCO, 6, 0, 0)
    assert connection.send(TMCLCommand.GCO, 6, 0, 0).value == 12_345


@pytest.mark.sheet("FM-PD42-1241", "3.6.11")
def test_outputs_and_inputs(module: Any, modules: EmulatorProcess) -> None:
    module.set_digital_output(0)
    assert module.get_digital_output(0) == 1
    module.clear_digital_output(0)
    assert module.get_digital_output(0) == 0
    for level in (True, False):
        patch(modules, 1, inputs={"in1": level, "analog": 1234})
        assert module.get_digital_input(1) == level
    assert module.get_analog_input(0) == 1234


@pytest.mark.sheet("FM-PD42-1241", "3")
def test_two_modules_on_one_line(connection: Any) -> None:
    first, second = TMCM1241(connection, module_id=1), TMCM1241(connection, module_id=2)
    for each in (first, second):
        hurry(each.motors[0])
    first.motors[0].move_to(20_000)
    second.motors[0].move_to(-20_000)
    wait_for(first.motors[0].get_position_reached)
    wait_for(second.motors[0].get_position_reached)
    assert (first.motors[0].actual_position, second.motors[0].actual_position) == (20_000, -20_000)


# --- faults, as a client of others meets them -----------------------------------------------------


def test_flipped_bits_are_a_wrong_checksum_for_it(connection: Any, modules: EmulatorProcess) -> None:
    patch(modules, 1, faults={"bit_error_rate": 0.05})
    found = 0
    for _ in range(100):
        try:
            assert connection.get_axis_parameter(AP.ActualPosition, 0) == 0
        except (TMCLReplyChecksumError, TMCLReplyStatusError):
            found += 1
    assert found > 50
    patch(modules, 1, faults={"bit_error_rate": 0.0})
    assert connection.get_axis_parameter(AP.ActualPosition, 0) == 0


def test_silence_is_a_timeout_and_over_when_it_is_over(modules: EmulatorProcess) -> None:
    with ConnectionManager(f"--interface serial_tmcl --port {modules.pty} --timeout 0.2").connect() as connection:
        patch(modules, 1, faults={"silence": True})
        with pytest.raises(RuntimeError, match="timed out"):
            connection.get_axis_parameter(AP.ActualPosition, 0)
        patch(modules, 1, faults={"silence": False})
        assert connection.get_axis_parameter(AP.ActualPosition, 0) == 0


def test_a_blocked_shaft_loses_steps_by_fours(modules: EmulatorProcess, motor: Any) -> None:
    hurry(motor)
    patch(modules, 1, blocked=True)
    motor.move_to(25_600)
    wait_for(motor.get_position_reached)
    state = patch(modules, 1, blocked=False)
    truth = state["truth"]
    assert isinstance(truth, dict)
    assert truth["lost_fullsteps"] != 0
    assert truth["lost_fullsteps"] % 4 == 0
    encoder = motor.get_axis_parameter(AP.EncoderPosition, signed=True)
    assert abs(encoder - motor.actual_position) > 4 * 256 - 300
