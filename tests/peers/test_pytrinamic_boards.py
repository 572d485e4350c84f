"""PyTrinamic's classes of the TMC5xxx evaluation boards, unmodified, and the emulated board: over a pty and TCP."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pytrinamic.connections import ConnectionManager
from pytrinamic.evalboards import TMC5031_eval, TMC5062_eval, TMC5072_eval, TMC5130_eval, TMC5160_eval, TMC5240_eval
from pytrinamic.modules import Landungsbruecke

from app.clock import WallClock
from app.emulators.board.build import build_board
from app.emulators.line.line import Line
from tests.peers.served_line import served
from tests.peers.test_pytrinamic import wait_for
from tests.peers.test_pytrinamic_landungsbruecke import refused

EVALUATIONS = {
    "tmc5031": TMC5031_eval,
    "tmc5062": TMC5062_eval,
    "tmc5072": TMC5072_eval,
    "tmc5130": TMC5130_eval,
    "tmc5160": TMC5160_eval,
    "tmc5240": TMC5240_eval,
}
REFUSED = {"tmc5072": {185}}
"""Parameters that PyTrinamic has a name for and the published firmware of the board no answer."""


@pytest.fixture(params=[(model, how) for model in EVALUATIONS for how in ("pty", "tcp")],
                ids=lambda param: " over ".join(param))  # fmt: skip
def evaluation(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Any]:
    model, how = request.param
    line = Line([build_board(model, WallClock(), {})], WallClock())
    with served(line, tmp_path / "board") as (host, port):
        arguments = (
            f"--interface serial_tmcl --port {tmp_path / 'board'} --data-rate 115200"
            if how == "pty"
            else f"--interface socket_serial_tmcl --port {host}:{port}"
        )
        with ConnectionManager(f"{arguments} --timeout 20").connect() as connection:
            made = EVALUATIONS[model](connection)
            made.model, made.connection = model, connection
            yield made


def test_it_is_known_and_its_registers_survive_both_ways(evaluation: Any) -> None:
    assert Landungsbruecke(evaluation.connection).get_board_names()[0] == evaluation.model.upper()
    for value in (0, -1, 0x1234_5678, -(2**31)):
        evaluation.write_register(0x21, value)
        assert evaluation.read_register(0x21, signed=True) == value
    assert evaluation.read_register(0x26) == 0, "most can only write it: from the firmware's memory"
    evaluation.write_register(0x26, 1000)
    assert evaluation.read_register(0x26) == 1000


def test_every_motor_moves_rotates_and_stops(evaluation: Any) -> None:
    for axis, motor in enumerate(evaluation.motors):
        ap = motor.AP
        settings = (
            (ap.MaxAcceleration, 50_000), (ap.MaxDeceleration, 50_000), (ap.D1, 50_000), (ap.StopVelocity, 10),
        )  # fmt: skip
        for number, value in settings:
            motor.set_axis_parameter(number, value)
            assert motor.get_axis_parameter(number) == value
        motor.move_to(3000 + axis, 500_000)
        wait_for(lambda motor=motor, ap=ap: bool(motor.get_axis_parameter(ap.PositionReachedFlag)))  # type: ignore[misc]  # mypy knows no defaults of lambdas
        assert motor.actual_position == 3000 + axis
        assert motor.target_position == 3000 + axis
        motor.rotate(-100_000)
        wait_for(lambda motor=motor: motor.actual_velocity == -100_000)  # type: ignore[misc]  # likewise
        motor.stop()
        wait_for(lambda motor=motor: motor.actual_velocity == 0)  # type: ignore[misc]  # likewise
        assert motor.actual_position < 3000
    positions = [motor.actual_position for motor in evaluation.motors]
    assert [evaluation.read_register(0x21 + 0x20 * axis, True) for axis in range(len(positions))] == positions


def test_every_parameter_that_it_has_a_name_for_is_answered(evaluation: Any) -> None:
    numbers = {number for name, number in vars(evaluation.motors[0].AP).items() if not name.startswith("_")}
    missing = REFUSED.get(evaluation.model, set())
    for motor in evaluation.motors:
        for number in sorted(numbers - missing):
            assert isinstance(motor.get_axis_parameter(number), int), number
    for number in missing:
        assert refused(lambda number=number: evaluation.motors[0].get_axis_parameter(number)) == 3


def test_it_measures_how_fast_a_motor_turns(evaluation: Any) -> None:
    motor = evaluation.motors[0]
    motor.set_axis_parameter(motor.AP.MaxAcceleration, 50_000)
    motor.rotate(100_000)
    wait_for(lambda: motor.actual_velocity == 100_000)
    # the TMC5031's board shows 0 for ever; the others look every 5 or 25 ms
    # it reckons with 16 MHz, and the TMC5240 has 12.5
    number, expected = (motor.AP.MeasuredSpeed, 78_125) if evaluation.model == "tmc5240" else (29, 100_000)
    wait_for(lambda: abs(motor.get_axis_parameter(number) - expected) < 1000 or evaluation.model == "tmc5031")
    motor.stop()


def test_what_the_info_script_of_the_maker_reads(evaluation: Any) -> None:
    """examples/modules/Landungsbruecke/connected_eval_information.py, and what its write script does."""
    board = Landungsbruecke(evaluation.connection)
    number, name = board.get_board_ids()[0], evaluation.model.upper()
    assert board.id_eeprom_mc.read_id_info() == {"description": name, "id": number, "hw_major": 1, "hw_minor": 0}
    assert board.id_eeprom_drv.read_id_info() is None
    board.id_eeprom_mc.write_id_info(name, number, hw_major_version=1, hw_minor_version=2)
    assert board.id_eeprom_mc.read_id_info()["hw_minor"] == 2
