"""Names of serial ports: what they may say, and which devices this server opens.

A name comes from whoever may add a connection, and pyserial makes of it whatever it can: `spy://` writes files, a
device name opens any file. So a name is taken apart here and only known parts are let through, and a device is opened
only where it is a serial one, by its real path.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from fnmatch import fnmatchcase

from serial.tools import list_ports

from ..errors import LinkDown, UsageError

OPTIONS = {
    "socket": frozenset[str](),
    "rfc2217": frozenset({"ign_set_control", "poll_modem"}),
    "spy": frozenset({"color", "raw", "all"}),
}
"""Schemes of pyserial that are taken, and the options of each; all are switches without a value."""
NAME_MAX = 200
HOST = re.compile(r"\[[0-9a-fA-F:.]+\]|[A-Za-z0-9_]([A-Za-z0-9_.-]*[A-Za-z0-9_])?")
SERIAL_DEVICE = re.compile(
    r"/dev/(tty[A-Za-z.][\w.+:-]*|cu\.[\w.+:-]+|rfcomm\d+|pts/\d+)" if os.name == "posix" else r"(\\\\\.\\)?COM\d{1,3}",
    re.ASCII | (0 if os.name == "posix" else re.IGNORECASE),
)
"""What serial devices are called; not the consoles of the machine (/dev/tty, /dev/tty0 ...)."""

_allowed: tuple[str, ...] = ()


def allow_ports(patterns: Iterable[str]) -> None:
    """Name the further devices that this process may open, as patterns of the shell (`/dev/motor*`)."""
    global _allowed
    _allowed = tuple(patterns)


def port_url(port: str) -> str:
    """The device name, or the URL (`socket://host:port`, `rfc2217://host:port?poll_modem`, `spy:///dev/ttyUSB0?color`).

    Raises UsageError for another scheme or option, and for anything that could be read in two ways: escapes, control
    characters, a scheme within a scheme.
    """
    if len(port) > NAME_MAX or not port.isprintable() or "%" in port:
        raise UsageError(
            f"a port's name has at most {NAME_MAX} characters, all printable and none a %: write it without escapes"
        )
    scheme, divider, rest = port.partition("://")
    if not divider:
        return port
    if scheme not in OPTIONS:
        raise UsageError(f"no serial port begins with {scheme}://; use a device name, or {', '.join(OPTIONS)}")
    place, asks, query = rest.partition("?")
    chosen = query.split("&") if asks else []
    for option in chosen:
        if option not in OPTIONS[scheme]:
            known = ", ".join(sorted(OPTIONS[scheme])) or "none"
            raise UsageError(f"{scheme}:// has no option {option!r} here; there is {known}")
    if scheme == "spy":
        if not place or "://" in place or "#" in place:
            raise UsageError("spy:// is followed by a device name: spy:///dev/ttyUSB0")
    else:
        host, colon, number = place.rpartition(":")
        if (
            not colon
            or not HOST.fullmatch(host)
            or not number.isascii()
            or not number.isdecimal()
            or not 0 < int(number) < 1 << 16
        ):
            raise UsageError(f"{scheme}:// is followed by host:port: {scheme}://192.168.0.5:4000")
    return port


def device_of(url: str) -> str:
    """The file behind a device name or `spy://`; empty for what is reached over a network."""
    scheme, divider, rest = url.partition("://")
    if not divider:
        return url
    return rest.partition("?")[0] if scheme == "spy" else ""


def openable(name: str, url: str) -> str:
    """`url` with the real path of its device, links followed. Blocks for some milliseconds at the most.

    Raises LinkDown where it is none that this server opens; the same words whether there is such a file or not. `name`
    names the link there.
    """
    device = device_of(url)
    if not device:
        return url
    real = os.path.realpath(device) if os.name == "posix" else device
    if (
        not SERIAL_DEVICE.fullmatch(real)
        and not _listed(real)
        and not any(fnmatchcase(real, each) for each in _allowed)
    ):
        raise LinkDown(
            name,
            f"{device} is not there, or not a serial port that this server opens: those that the system lists, and what"
            " is called like one; its setting allowed_ports names others",
        )
    return url.replace(device, real, 1)


def _listed(real: str) -> bool:
    return any(os.path.realpath(port.device) == real for port in list_ports.comports())
