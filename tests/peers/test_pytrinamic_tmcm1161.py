"""PyTrinamic's own class of the TMCM-1161 against `stepscope emulate tmcm-1161`."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from pytrinamic.connections import ConnectionManager
from pytrinamic.modules import TMCM1161
from pytrinamic.tmcl import TMCLCommand, TMCLReplyStatusError, TMCLStatus

from app.registers.model import Space
from app.registers.tmcl.modules import MODULES
from tests.peers.emulator_process import EmulatorProcess, emulator

SOON_S = 20.0
AP = TMCM1161._MotorTypeA.AP
NUMBERS = {name: number for name, number in vars(AP).items() if not name.startswith("_")}
GLOBALS = {name: number for name, number in vars(TMCM1161.GP0).items() if not name.startswith("_")}
MODULE = MODULES["tmcm-1161"]


@pytest.fixture(scope="module")
def process(tmp_path_factory: pytest.TempPathFactory) -> Iterator[EmulatorProcess]:
    where: Path = tmp_path_factory.mktemp("tmcm1161") / "port"
    with emulator("--tcp", "127.0.0.1:0", pty=where, model="tmcm-1161") as started:
        yield started


@pytest.fixture(scope="module", params=["pty", "tcp"])
def connection(process: EmulatorProcess, request: pytest.FixtureRequest) -> Iterator[Any]:
    """By PyTrinamic's own manager: its serial interface, or its own one for sockets."""
    if request.param == "pty":
        arguments = f"--interface serial_tmcl --port {process.pty}"
    else:
        assert process.tcp is not None
        arguments = f"--interface socket_serial_tmcl --port {process.tcp[0]}:{process.tcp[1]}"
    with ConnectionManager(f"{arguments} --timeout 5").connect() as connection:
        yield connection


@pytest.fixture
def motor(connection: Any) -> Iterator[Any]:
    motor = TMCM1161(connection).motors[0]
    motor.set_axis_parameter(AP.PulseDivisor, 1)
    motor.set_axis_parameter(AP.rampDivisor, 6)
    motor.linear_ramp.max_velocity = 1_640
    motor.linear_ramp.max_acceleration = 500
    motor.drive_settings.max_current = 255
    yield motor
    motor.stop()
    wait_for(lambda: motor.actual_velocity == 0)
    motor.actual_position = 0


def wait_for(condition: Callable[[], bool]) -> None:
    until_s = time.monotonic() + SOON_S
    while not condition():
        assert time.monotonic() < until_s, "it does not come"


def test_the_version_in_both_forms(connection: Any) -> None:
    assert connection.get_version_string() == "1161V146"
    assert connection.send(TMCLCommand.GET_FIRMWARE_VERSION, 1, 0, 0).value == 1161 << 16 | 1 << 8 | 46


@pytest.mark.parametrize("name", NUMBERS)
def test_every_axis_parameter_can_be_read(connection: Any, name: str) -> None:
    row = MODULE.rows(Space.AXIS)[NUMBERS[name]]
    assert row.minimum <= connection.get_axis_parameter(NUMBERS[name], 0, signed=True) <= row.maximum


@pytest.mark.parametrize("name", GLOBALS)
def test_every_global_parameter_can_be_read(connection: Any, name: str) -> None:
    row = MODULE.rows(Space.GLOBAL_0)[GLOBALS[name]]
    assert row.minimum <= connection.get_global_parameter(GLOBALS[name], 0, signed=True) <= row.maximum


def test_features_read_and_write_by_name(motor: Any) -> None:
    motor.drive_settings.standby_current = 12
    motor.stallguard2.threshold = 7
    assert (motor.drive_settings.standby_current, motor.stallguard2.threshold) == (12, 7)
    assert (motor.linear_ramp.max_velocity, motor.linear_ramp.max_acceleration) == (1_640, 500)
    # Not stallguard2: its text asks for a parameter by a name that the list for this module writes otherwise.
    for feature in (motor, motor.drive_settings, motor.linear_ramp):
        assert str(feature)


def test_it_moves_to_and_by_and_tells_when_it_is_there(motor: Any) -> None:
    motor.move_to(30_000)
    wait_for(motor.get_position_reached)
    assert (motor.actual_position, motor.target_position) == (30_000, 30_000)
    before = motor.get_axis_parameter(AP.EncoderPosition, signed=True)
    motor.move_by(-50_000)
    wait_for(lambda: motor.actual_position == -20_000)
    after = motor.get_axis_parameter(AP.EncoderPosition, signed=True)
    assert after - before == pytest.approx(-50_000, abs=600), "a motor turned, not only a number"


@pytest.mark.parametrize("velocity", [800, -800])
def test_it_rotates_and_stops(motor: Any, velocity: int) -> None:
    motor.rotate(velocity)
    wait_for(lambda: motor.actual_velocity == velocity)
    assert motor.target_velocity == velocity
    assert motor.get_axis_parameter(AP.RampMode) == 2
    motor.stop()
    wait_for(lambda: motor.actual_velocity == 0)
    assert motor.actual_position * velocity > 0


def test_parameters_are_stored_and_restored(connection: Any, motor: Any) -> None:
    motor.linear_ramp.max_velocity = 321
    connection.store_axis_parameter(AP.MaxVelocity, 0)
    motor.linear_ramp.max_velocity = 100
    connection.restore_axis_parameter(AP.MaxVelocity, 0)
    assert motor.linear_ramp.max_velocity == 321


def test_what_its_sibling_has_is_refused(connection: Any) -> None:
    for number in (15, 29, 202, 216, 251, 255):
        with pytest.raises(TMCLReplyStatusError) as refusal:
            connection.get_axis_parameter(number, 0)
        assert refusal.value.status_code == TMCLStatus.WRONG_TYPE
    with pytest.raises(TMCLReplyStatusError) as refusal:
        connection.set_axis_parameter(AP.MaxVelocity, 0, 2048)
    assert refusal.value.status_code == TMCLStatus.INVALID_VALUE
