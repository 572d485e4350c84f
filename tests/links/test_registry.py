"""Options of serial links and of modules behind TCP: what is taken, and what is told about the rest."""

from __future__ import annotations

from typing import cast

import pytest

from app.clock import VirtualClock
from app.errors import OutOfRange, UnknownThing, UsageError
from app.links.registry import can_factory, serial_factory, tcp_factory
from app.links.serial_line import LinePort
from app.links.tcp import TcpPort

MODEL = "pd42-1241"


def serial(**options: object) -> LinePort:
    return cast("LinePort", serial_factory(MODEL, {"kind": "serial", **options}, VirtualClock()))


def test_a_serial_link() -> None:
    port = serial(port=" /dev/ttyUSB0 ")
    assert (port.name, port.baud, port.address) == ("serial /dev/ttyUSB0, module 1", 9600, 1)
    assert port.timeout_s == pytest.approx(180 / 9600 + 0.25)
    port = serial(port="COM3", baud=115200, address=7, timeout_s=0.1)
    assert (port.name, port.baud, port.address) == ("serial COM3, module 7", 115200, 7)
    assert port.timeout_s == pytest.approx(180 / 115200 + 0.1)


def test_modules_on_one_port_share_its_line() -> None:
    one, two, other = serial(port="/dev/a"), serial(port="/dev/a", address=2), serial(port="/dev/b")
    assert one.line is two.line
    assert one.line is not other.line
    gateway = tcp_factory(MODEL, {"kind": "tcp", "host": "h", "port": 5, "address": 2}, VirtualClock())
    by_url = serial(port="socket://h:5")
    assert isinstance(gateway, LinePort)
    assert gateway.line is by_url.line


def test_a_module_and_a_chip_behind_tcp() -> None:
    module = tcp_factory(MODEL, {"kind": "tcp", "host": "h", "port": 5}, VirtualClock())
    assert module.name == "tcp h:5, module 1"
    assert cast("LinePort", module).wire.calls_per_s_possible is None
    assert tcp_factory(MODEL, {"kind": "tcp", "host": "::1", "port": 5}, VirtualClock()).name == "tcp [::1]:5, module 1"
    assert isinstance(tcp_factory("tmc428", {"kind": "tcp", "host": "h", "port": 5}, VirtualClock()), TcpPort)
    with pytest.raises(UnknownThing):
        tcp_factory("tmc428", {"kind": "tcp", "host": "h", "port": 5, "address": 1}, VirtualClock())
    with pytest.raises(UsageError):
        tcp_factory(MODEL, {"kind": "tcp", "host": "h/../?logging=debug", "port": 5}, VirtualClock())


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({}, UsageError),
        ({"port": ""}, UsageError),
        ({"port": 3}, UsageError),
        ({"port": "/dev/a\0b"}, UsageError),
        ({"port": "alt:///dev/a?class=Serial"}, UsageError),
        ({"port": "spy:///dev/a?file=/etc/passwd"}, UsageError),
        ({"port": "x", "baud": 0}, OutOfRange),
        ({"port": "x", "baud": 9600.0}, OutOfRange),
        ({"port": "x", "address": 0}, OutOfRange),
        ({"port": "x", "address": 256}, OutOfRange),
        ({"port": "x", "timeout_s": 0}, OutOfRange),
        ({"port": "x", "timeout_s": None}, OutOfRange),
        ({"port": "x", "timeout_s": float("nan")}, OutOfRange),
        ({"port": "x", "parity": "E"}, UnknownThing),
    ],
)
def test_options_that_cannot_be(options: dict[str, object], error: type[Exception]) -> None:
    with pytest.raises(error):
        serial(**options)


def test_a_chip_has_no_serial_link() -> None:
    with pytest.raises(UsageError, match="a tmc428 has no serial link"):
        serial_factory("tmc428", {"kind": "serial", "port": "x"}, VirtualClock())


def test_a_module_without_can_is_reached_by_its_serial_line_and_sockets_alone() -> None:
    with pytest.raises(UsageError, match=r"a tmcm-1161 has no can link; pd42-1241 has"):
        can_factory("tmcm-1161", {"kind": "can", "interface": "virtual", "channel": "x"}, VirtualClock())
