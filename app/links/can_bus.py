"""A bus of python-can: which interfaces there are, how a channel is called, and how it is opened."""

from __future__ import annotations

import re
from importlib.util import find_spec
from typing import Any

from ..errors import LinkDown, UsageError
from .serial_address import openable, port_url

SOCKETCAN = "socketcan"
"""The interface of Linux itself."""
SERIAL_INTERFACES = frozenset({"robotell", "seeedstudio", "serial", "slcan"})
"""Interfaces of python-can whose channel is a serial port, with `@` and a baud rate behind it."""
INTERFACES = frozenset(
    {
        "canalystii",
        "cantact",
        "etas",
        "gs_usb",
        "iscan",
        "ixxat",
        "kvaser",
        "neousys",
        "neovi",
        "nican",
        "nixnet",
        "pcan",
        SOCKETCAN,
        "systec",
        "udp_multicast",
        "usb2can",
        "vector",
        "virtual",
    }
)
"""Interfaces of python-can whose channel is a name or a number; not those that need more than that (socketcand)."""
CHANNEL = re.compile(r"[A-Za-z0-9_.:-]{1,200}")


def bus_name(interface: str, channel: str) -> str:
    """What people call the bus."""
    return f"can {interface} {channel}"


def require_python_can() -> None:
    """Raises UsageError where python-can is not installed."""
    if find_spec("can") is None:
        raise UsageError("CAN needs python-can: pip install 'stepscope[can]'")


def check_bus(interface: str, channel: str) -> None:
    """Raises UsageError. python-can loads an interface by name, and several open whatever file a channel names."""
    if interface in SERIAL_INTERFACES:
        device, at, baud = channel.partition("@")
        if at and not (baud.isascii() and baud.isdecimal() and len(baud) < 8):
            raise UsageError(f"behind the @ of a {interface} channel stands its baud rate, not {baud!r}")
        if port_url(device).startswith("spy://"):
            raise UsageError(f"a {interface} channel is a device name, or socket://host:port")
    elif interface not in INTERFACES:
        known = ", ".join(sorted(INTERFACES | SERIAL_INTERFACES))
        raise UsageError(f"python-can has no interface {interface!r} here; there is {known}")
    elif not CHANNEL.fullmatch(channel):
        raise UsageError(f"a {interface} channel is called by letters, digits and . _ : -, not {channel!r}")


def open_bus(interface: str, channel: str, bitrate: int) -> Any:
    """An open `can.Bus` at `bitrate` [bit/s], which buses of the system (socketcan) have been given already.

    Raises LinkDown where it cannot be had.
    """
    import can

    name = bus_name(interface, channel)
    if interface in SERIAL_INTERFACES:
        device, at, baud = channel.partition("@")
        channel = f"{openable(name, device)}{at}{baud}"
    try:
        return can.Bus(interface=interface, channel=channel, bitrate=bitrate)
    except Exception as error:  # every adapter's driver has errors of its own
        raise LinkDown(name, str(error) or type(error).__name__) from error
