"""pyTMCL, a client that shares no line with PyTrinamic: over the pty by pyserial, over TCP by its socket:// ports.

Of the two packages of that family on PyPI this is the one that runs today. TMCL 1.1.1 packs the sum of the frame's
fields as one byte and so fails with every value above 255 or below 0, and names an exception it never imports.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import pyTMCL
import serial
from pyTMCL.reply import TrinamicException

from tests.peers.emulator_process import EmulatorProcess

SOON_S = 20.0


@pytest.fixture(params=["pty", "tcp"])
def bus(modules: EmulatorProcess, request: pytest.FixtureRequest) -> Iterator[Any]:
    assert modules.tcp is not None
    url = str(modules.pty) if request.param == "pty" else f"socket://{modules.tcp[0]}:{modules.tcp[1]}"
    with serial.serial_for_url(url, 115_200, timeout=5) as port:
        yield pyTMCL.connect(port)


def wait_for(condition: Callable[[], bool]) -> None:
    until_s = time.monotonic() + SOON_S
    while not condition():
        assert time.monotonic() < until_s, "it does not come"


def hurry(motor: Any) -> None:
    for number, value in ((4, 200_000), (5, 1_000_000), (15, 1_000_000), (17, 1_000_000), (18, 1_000_000), (6, 255)):
        motor.set_axis_parameter(number, value)


def test_parameters(bus: Any) -> None:
    motor = bus.get_motor(1)
    motor.axis.max_positioning_speed = 60_000
    motor.axis.max_current = 100
    motor.axis.right_limit_switch_disabled = True
    motor.axis.actual_position = -4321
    assert (motor.axis.max_positioning_speed, motor.axis.max_current) == (60_000, 100)
    assert motor.axis.right_limit_switch_disabled
    assert motor.axis.actual_position == -4321


def test_motion(bus: Any) -> None:
    motor = bus.get_motor(1)
    hurry(motor)
    motor.move_absolute(20_000)
    wait_for(motor.get_position_reached)
    motor.move_relative(-5_000)
    wait_for(lambda: motor.axis.actual_position == 15_000)
    motor.rotate_left(30_000)
    wait_for(lambda: motor.axis.actual_speed == -30_000)
    motor.stop()
    wait_for(lambda: motor.axis.actual_speed == 0)
    motor.rotate_right(30_000)
    wait_for(lambda: motor.axis.actual_speed == 30_000)
    motor.stop()


def test_its_own_thread_sees_the_target_reached(bus: Any) -> None:
    motor = bus.get_motor(1)
    hurry(motor)
    there = threading.Event()
    motor.move_absolute(10_000, callback=there.set)
    assert there.wait(SOON_S)
    motor.trigger_thread.join(SOON_S)
    assert motor.axis.actual_position == 10_000


def test_user_variables(bus: Any) -> None:
    motor = bus.get_motor(1)
    motor.set_user_var(7, -77_777)
    assert motor.get_user_var(7) == -77_777


def test_errors_are_told_with_their_status(bus: Any) -> None:
    motor = bus.get_motor(1)
    with pytest.raises(TrinamicException, match="Wrong Type"):
        motor.get_axis_parameter(253)
    with pytest.raises(TrinamicException, match="Invalid Value"):
        motor.set_axis_parameter(140, 9)
    with pytest.raises(TrinamicException, match="Invalid Command"):
        motor.send(99, 0, 0, 0)


def test_two_modules(bus: Any) -> None:
    first, second = bus.get_module(1).get_motor(0), bus.get_module(2).get_motor(0)
    first.set_axis_parameter(1, 111)
    second.set_axis_parameter(1, 222)
    assert (first.get_axis_parameter(1), second.get_axis_parameter(1)) == (111, 222)
