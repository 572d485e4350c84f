"""PyTrinamic, as it comes from PyPI, and a TMC4361 on an emulated evaluation board: it finds nothing amiss."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pytrinamic.connections import ConnectionManager
from pytrinamic.evalboards import TMC4361_eval
from pytrinamic.modules import Landungsbruecke
from pytrinamic.tmcl import TMCLCommand, TMCLReplyStatusError, TMCLStatus

from app.registers.tmc4361.table import TMC4361
from tests.peers.board import board, patch_board, shared_board
from tests.peers.emulator_process import EmulatorProcess
from tests.peers.test_pytrinamic import wait_for

__all__ = ["board", "shared_board"]
AP = TMC4361_eval._MotorTypeA.AP


@pytest.fixture(params=["pty", "tcp"])
def connection(board: EmulatorProcess, request: pytest.FixtureRequest) -> Iterator[Any]:
    """By PyTrinamic's own manager: its serial interface, or its own one for sockets."""
    if request.param == "pty":
        arguments = f"--interface serial_tmcl --port {board.pty} --data-rate 115200"
    else:
        assert board.tcp is not None
        arguments = f"--interface socket_serial_tmcl --port {board.tcp[0]}:{board.tcp[1]}"
    with ConnectionManager(f"{arguments} --timeout 20").connect() as connection:
        yield connection


@pytest.fixture
def evaluation(connection: Any) -> Any:
    return TMC4361_eval(connection)


@pytest.fixture
def registers(evaluation: Any) -> Any:
    return evaluation.ics[0].REG


@pytest.fixture
def motor(evaluation: Any) -> Any:
    return evaluation.motors[0]


def refused(call: Any) -> int:
    with pytest.raises(TMCLReplyStatusError) as error:
        call()
    return int(error.value.status_code)


# --- what it is ---------------------------------------------------------------------------------


def test_it_is_a_landungsbruecke_with_a_tmc4361(connection: Any) -> None:
    assert connection.get_version_string() == "0012V310"
    base = Landungsbruecke(connection)
    assert base.get_board_ids() == (11, 1)
    assert base.get_board_names() == ("TMC4361A", "TMC2660")
    assert connection.get_info(0) == 12
    assert connection.get_info(21) == 12, "bits of a register's address, as PyTrinamic sends it"


def test_asked_what_it_does_not_know(connection: Any, evaluation: Any) -> None:
    assert refused(lambda: connection.send(99, 0, 0, 0)) == TMCLStatus.INVALID_COMMAND
    assert refused(lambda: connection.get_axis_parameter(99, 0)) == TMCLStatus.WRONG_TYPE
    assert refused(lambda: connection.get_axis_parameter(0, 1)) == TMCLStatus.WRONG_TYPE
    assert refused(lambda: connection.set_axis_parameter(AP.ActualVelocity, 0, 1)) == TMCLStatus.WRONG_TYPE
    assert refused(lambda: connection.set_axis_parameter(AP.MaxAcceleration, 0, -1)) == TMCLStatus.INVALID_VALUE
    assert evaluation.read_register(0x7F) == 2, "and the next command is as good as ever"


# --- registers ----------------------------------------------------------------------------------


def test_every_register_can_be_read(evaluation: Any, registers: Any) -> None:
    names = {name: address for name, address in vars(registers).items() if not name.startswith("_")}
    assert len(names) > 100
    for name, address in names.items():
        word = evaluation.read_register(address)
        row = TMC4361.at(address)
        assert row is not None, name
        if row.access.readable:
            assert word & ~row.mask == 0, name


@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(value=st.integers(-(2**31), 2**32 - 1))
def test_words_of_32_bits_survive_both_ways(evaluation: Any, registers: Any, value: int) -> None:
    evaluation.write_register(registers.POS_COMP, value)
    assert evaluation.read_register(registers.POS_COMP) == value & 0xFFFF_FFFF
    assert evaluation.read_register(registers.POS_COMP, signed=True) == (value + 2**31) % 2**32 - 2**31


def test_fields_are_changed_alone(evaluation: Any) -> None:
    fields = evaluation.ics[0].FIELD
    before = evaluation.read_register(0)
    evaluation.write_register_field(fields.SDIN_MODE, 2)
    assert evaluation.read_register_field(fields.SDIN_MODE) == 2
    assert evaluation.read_register(0) == before | 2 << 6


def test_what_can_only_be_written_is_read_from_the_boards_memory(evaluation: Any, registers: Any) -> None:
    assert evaluation.read_register(registers.SER_PTIME) == 0x190, "what the chip comes up with"
    evaluation.write_register(registers.SER_PTIME, 0x123)
    assert evaluation.read_register(registers.SER_PTIME) == 0x123


def test_reading_events_clears_them(evaluation: Any, registers: Any) -> None:
    assert evaluation.read_register(registers.EVENTS) >> 31, "the reset is an event"
    assert not evaluation.read_register(registers.EVENTS) >> 31


def test_after_power_on_the_board_has_set_up_its_chip(evaluation: Any, registers: Any) -> None:
    assert evaluation.read_register(registers.GENERAL_CONF) == 0x6000
    assert evaluation.read_register(registers.AMAX) == 320_000
    assert [evaluation.read_register(registers.BOW1 + n) for n in range(4)] == [1000] * 4


def test_a_reset_sets_the_chip_up_again(connection: Any, evaluation: Any, registers: Any) -> None:
    for command, type_ in ((152, 0), (TMCLCommand.ASSIGNMENT, 0)):
        evaluation.write_register(registers.BOW1, 5)
        connection.send(command, type_, 0, 0)
        assert evaluation.read_register(registers.BOW1) == 1000


# --- motion -------------------------------------------------------------------------------------


def test_it_moves_to_a_position_and_tells_that_it_is_there(board: EmulatorProcess, evaluation: Any, motor: Any) -> None:
    motor.set_axis_parameter(AP.MaxAcceleration, 400_000)
    motor.set_axis_parameter(AP.MaxDeceleration, 400_000)
    motor.move_to(30_000, 100_000)
    assert not motor.get_axis_parameter(AP.PositionReachedFlag)
    assert motor.target_position == 30_000
    wait_for(lambda: bool(motor.get_axis_parameter(AP.PositionReachedFlag)))
    assert motor.actual_position == 30_000
    assert evaluation.read_register(0x21) == 30_000
    output = patch_board(board, {})["chip"]
    assert isinstance(output, dict)
    assert output["step_output"]["steps_sent"] >= 30_000, "steps left the chip, not only a number changed"
    motor.move_to(-10_000)
    wait_for(lambda: bool(motor.actual_position == -10_000))


def test_an_s_ramp_goes_there_too(motor: Any) -> None:
    for number, value in ((AP.RampType, 1), (AP.BOW1, 400_000), (AP.BOW2, 400_000), (AP.BOW3, 400_000)):
        motor.set_axis_parameter(number, value)
        assert motor.get_axis_parameter(number) == value
    motor.set_axis_parameter(AP.BOW4, 400_000)
    motor.set_axis_parameter(AP.MaxAcceleration, 400_000)
    motor.set_axis_parameter(AP.MaxDeceleration, 400_000)
    motor.move_to(20_000, 100_000)
    wait_for(lambda: bool(motor.get_axis_parameter(AP.PositionReachedFlag)))
    assert motor.actual_position == 20_000


@pytest.mark.parametrize("velocity", [40_000, -40_000])
def test_it_rotates_and_stops(motor: Any, velocity: int) -> None:
    motor.set_axis_parameter(AP.MaxAcceleration, 400_000)
    motor.set_axis_parameter(AP.MaxDeceleration, 400_000)
    motor.rotate(velocity)
    wait_for(lambda: bool(motor.actual_velocity == velocity))
    assert motor.target_velocity == velocity
    motor.stop()
    wait_for(lambda: bool(motor.actual_velocity == 0))
    here = motor.actual_position
    assert here * velocity > 0
    assert motor.actual_position == here
