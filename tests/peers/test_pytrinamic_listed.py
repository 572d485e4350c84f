"""The maker's own class of every listed module against its plain emulated one: rotate, move, stop, parameters, ports.

Those that are known well have tests of their own: `test_pytrinamic`, `test_pytrinamic_tmcm1161`.
"""

from __future__ import annotations

import importlib
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pytrinamic.connections import ConnectionManager

from app.clock import WallClock
from app.emulators.build import build_emulator
from app.emulators.line.line import Line
from app.registers import catalog
from app.registers.listed import package
from tests.peers.served_line import served

SOON_S = 20.0
NAMES = [model.name for model in catalog.listings() if model.kind == "module"]


MOVED = ("TargetPosition", "ActualPosition", "TargetVelocity", "ActualVelocity", "PositionReachedFlag")


def numbers_of(constants: Any) -> dict[str, int]:
    """What a class of the package names; nothing of None."""
    return {} if constants is None else {name: n for name, n in vars(constants).items() if isinstance(n, int)}


def wait_for(motor: Any, name: str, value: int) -> None:
    until_s = time.monotonic() + SOON_S
    while getattr(motor, name) != value:
        assert time.monotonic() < until_s, "it does not come"


@pytest.fixture(params=NAMES)
def module(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Any]:
    listing = package.listings()[request.param]
    emulated, clock = build_emulator(request.param, WallClock()), WallClock()
    with served(Line([emulated], clock), tmp_path / "port") as (host, port):  # type: ignore[list-item]
        arguments = f"--interface socket_serial_tmcl --port {host}:{port} --timeout 5"
        with ConnectionManager(arguments).connect() as connection:
            yield getattr(importlib.import_module(listing.module), listing.class_name)(connection)


def test_rotate_move_stop_and_parameters(module: Any) -> None:
    for index, motor in enumerate(module.motors):
        names = {name.casefold(): number for name, number in vars(motor.AP).items() if not name.startswith("_")}
        speed = names.get("maxvelocity", names.get("maxpositioningspeed"))
        motor.set_axis_parameter(speed, 40_000)
        motor.set_axis_parameter(motor.AP.MaxAcceleration, 400_000)
        assert motor.get_axis_parameter(speed) == 40_000
        module.rotate(index, 12_345)
        wait_for(motor, "actual_velocity", 12_345)
        assert motor.target_velocity == 12_345
        module.stop(index)
        wait_for(motor, "actual_velocity", 0)
        motor.actual_position = 0
        module.move_to(index, 1500)
        wait_for(motor, "actual_position", 1500)
        module.move_by(index, -2500)
        wait_for(motor, "actual_position", -1000)
        assert motor.target_position == -1000
    for index, motor in enumerate(module.motors):
        numbers = set(numbers_of(motor.AP).values()) - {numbers_of(motor.AP).get(name) for name in MOVED}
        for number in numbers:
            motor.set_axis_parameter(number, 1000 * index + number)
    for index, motor in enumerate(module.motors):  # after all of them: no axis has written over another
        numbers = set(numbers_of(motor.AP).values()) - {numbers_of(motor.AP).get(name) for name in MOVED}
        assert {number: motor.get_axis_parameter(number) for number in numbers} == {
            number: 1000 * index + number for number in numbers
        }


def test_global_parameters_and_ports(module: Any) -> None:
    kind = type(module)
    for name, bank in (("GP", 0), ("GP0", 0), ("GP3", 3)):
        for number in numbers_of(getattr(kind, name, None)).values():
            module.set_global_parameter(number, bank, 7 + number)
            assert module.get_global_parameter(number, bank) == 7 + number
    mixed = numbers_of(getattr(kind, "IO", None))
    for name, number in {**numbers_of(getattr(kind, "DO", None)), **mixed}.items():
        if name.startswith(("OUT", "GPO")):
            module.set_digital_output(number)
            assert module.get_digital_output(number) == 1
            module.clear_digital_output(number)
            assert module.get_digital_output(number) == 0
    inputs = {name: number for name, number in mixed.items() if name.startswith(("IN", "GPI"))}
    for number in {**numbers_of(getattr(kind, "DI", None)), **inputs}.values():
        assert module.get_digital_input(number) == 0
    for number in numbers_of(getattr(kind, "AIN", None)).values():
        assert module.get_analog_input(number) == 0
