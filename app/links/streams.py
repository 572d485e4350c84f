"""Bytes to and from a line, blocking, for the thread that owns it. Opening tells people what is wrong.

Where the line has a file descriptor we write, poll and read it ourselves: a transaction then costs
little more than its system calls. Elsewhere (Windows, rfc2217://, spy://) it goes through pyserial.
"""

from __future__ import annotations

import contextlib
import errno
import os
import select
import socket
import stat
import sys
import time
from typing import Any, Protocol

import serial

from ..errors import LinkDown
from .serial_address import openable

if sys.platform != "win32":
    import fcntl
    import grp
    import termios

READ_MAX = 4096
SLICE_S = 0.05
"""How long a read waits at most before it looks whether the line is being closed [s]."""
WRITE_TIMEOUT_S = 0.5
PATIENT_S = 0.1
"""The shortest wait that a terminal keeps by itself [s]: VTIME counts tenths of a second."""
PIECE_BYTES = 64


class Closing(ConnectionError):
    """The line is being closed while a caller waits for an answer."""


class Stream(Protocol):
    """An open line. Everything but `abort` is for one thread. Raises OSError where the line has gone."""

    @property
    def fd(self) -> int | None:
        """What `poll` may wait for; None where there is no such thing."""
        ...

    def clear(self) -> bool:
        """Whether nothing came unasked, and the line takes a frame at once: `send` may follow."""
        ...

    def send(self, data: bytes) -> None:
        """Send a frame right after `clear` said so: as short a way as there is."""
        ...

    def write(self, data: bytes) -> None:
        """Send it all. Raises TimeoutError where the line takes nothing for `WRITE_TIMEOUT_S`."""
        ...

    def read(self, timeout_s: float) -> bytes:
        """Whatever is there, as soon as there is something; b"" when nothing came within `timeout_s` [s]."""
        ...

    def abort(self) -> None:
        """Make a waiting read raise Closing soon. Any thread may call it."""
        ...

    def close(self) -> None:
        """A second call does nothing."""
        ...


class FdStream:
    """A terminal or a socket that pyserial opened and set up, by its file descriptor.

    A terminal's reads block, at most for `PATIENT_S`, as the terminal itself offers it (VMIN 0, VTIME): a
    poll before each would cost a fifth of a transaction. So nothing is written before a poll said that there is room.
    """

    def __init__(self, port: Any) -> None:
        self._port = port
        self._fd: int = port.fileno()
        self._closing = False
        self._readable = select.poll()
        self._readable.register(self._fd, select.POLLIN)
        self._poll = self._readable.poll
        both = select.poll()
        both.register(self._fd, select.POLLIN | select.POLLOUT)
        self._poll_both = both.poll
        self._is_clear = [(self._fd, select.POLLOUT)]
        self._patient = os.isatty(self._fd) and _let_reads_block(self._fd)

    @property
    def fd(self) -> int | None:
        return self._fd

    def clear(self) -> bool:
        return self._poll_both(0) == self._is_clear

    def send(self, data: bytes) -> None:
        sent = os.write(self._fd, data)
        if sent < len(data):
            self.write(data[sent:])

    def write(self, data: bytes) -> None:
        until_s = time.monotonic() + WRITE_TIMEOUT_S
        writable = select.poll()
        writable.register(self._fd, select.POLLOUT)
        while data:
            left_s = until_s - time.monotonic()
            if self._closing:
                raise Closing("closed")
            if left_s <= 0:
                raise TimeoutError("the line takes no bytes")
            if writable.poll(min(left_s, SLICE_S) * 1000):
                with contextlib.suppress(BlockingIOError):
                    # In pieces that there is room for where a poll says that there is some: none blocks.
                    data = data[os.write(self._fd, data[:PIECE_BYTES]) :]

    def read(self, timeout_s: float) -> bytes:
        if self._patient and timeout_s >= PATIENT_S:
            data = os.read(self._fd, READ_MAX)
            if data:
                return data
            timeout_s -= PATIENT_S  # or the line has gone: the poll will tell
        if timeout_s <= SLICE_S:
            ready = self._poll(timeout_s * 1000)
        else:
            ready = self._poll(SLICE_S * 1000) or self._wait_on(timeout_s)
        if not ready:
            return b""
        data = os.read(self._fd, READ_MAX)
        if not data and not (self._patient and ready[0][1] == select.POLLIN):
            raise ConnectionError("unplugged, or closed by the other side")
        return data

    def _wait_on(self, timeout_s: float) -> list[tuple[int, int]]:
        until_s = time.monotonic() + timeout_s - SLICE_S
        while (left_s := until_s - time.monotonic()) > 0:
            if self._closing:
                raise Closing("closed")
            ready = self._poll(min(left_s, SLICE_S) * 1000)
            if ready:
                return ready
        return []

    def abort(self) -> None:
        self._closing = True

    def close(self) -> None:
        _close(self._port)


class ApiStream:
    """Any port of pyserial, by its own methods. Its read timeout is `API_SLICE_S` and never changed: over rfc2217://
    each change would be a negotiation."""

    def __init__(self, port: Any) -> None:
        self._port = port
        self._closing = False

    @property
    def fd(self) -> int | None:
        return None

    def clear(self) -> bool:
        return not self._port.in_waiting

    def send(self, data: bytes) -> None:
        self.write(data)

    def write(self, data: bytes) -> None:
        try:
            self._port.write(data)
        except serial.SerialTimeoutException as error:
            raise TimeoutError("the line takes no bytes") from error

    def read(self, timeout_s: float) -> bytes:
        until_s = time.monotonic() + timeout_s
        while True:
            waiting = self._port.in_waiting
            if waiting or timeout_s > 0:
                data = bytes(self._port.read(waiting or 1))
                if data:
                    return data
            if time.monotonic() >= until_s:
                return b""
            if self._closing:
                raise Closing("closed")

    def abort(self) -> None:
        self._closing = True

    def close(self) -> None:
        _close(self._port)


API_SLICE_S = 0.02


def open_stream(name: str, url: str, baud: int) -> Stream:
    """Open a device name or a URL of pyserial, raw, eight bits, no parity, for us alone.

    `name` names the link in errors. Raises LinkDown with what to do about it.
    """
    is_device = "://" not in url
    real = openable(name, url)
    try:
        port = serial.serial_for_url(
            real,
            baudrate=baud,
            timeout=API_SLICE_S,
            write_timeout=WRITE_TIMEOUT_S if is_device else None,
            exclusive=True if is_device and os.name == "posix" else None,
        )
    except Exception as error:  # SerialException and other OSErrors, ValueError, termios.error
        raise LinkDown(name, _why(url, error)) from error
    by_fd = os.name == "posix" and (is_device or url.startswith("socket://"))
    try:
        if is_device and os.name == "posix":
            _keep_others_out(port.fileno(), url)
            _pass_on_at_once(port)
        elif url.startswith("socket://"):
            _send_at_once(port.fileno())
        return FdStream(port) if by_fd else ApiStream(port)
    except OSError as error:
        port.close()
        raise LinkDown(name, _why(url, error)) from error


def _let_reads_block(fd: int) -> bool:
    """Let a terminal's reads wait for `PATIENT_S` and no longer. False where it has no such thing."""
    if sys.platform == "win32":
        return False
    try:
        settings = termios.tcgetattr(fd)
        settings[6][termios.VMIN], settings[6][termios.VTIME] = 0, round(PATIENT_S * 10)
        termios.tcsetattr(fd, termios.TCSANOW, settings)
    except termios.error:
        return False
    os.set_blocking(fd, True)
    return True


def _keep_others_out(fd: int, url: str) -> None:
    # pyserial's flock keeps out those who ask for the lock; TIOCEXCL keeps out the rest. Not on a pseudo-terminal:
    # there the flag outlives us, for the other side keeps the terminal alive, and whoever comes next would be shut out.
    if sys.platform != "win32" and not os.path.realpath(url).startswith("/dev/pts/"):
        with contextlib.suppress(OSError):
            fcntl.ioctl(fd, termios.TIOCEXCL)


def _pass_on_at_once(port: Any) -> None:
    """Ask the driver of an adapter not to collect bytes: those of FTDI keep an answer for 16 ms, and so for 1 ms."""
    with contextlib.suppress(AttributeError, NotImplementedError, OSError, ValueError):  # not every port has that
        port.set_low_latency_mode(True)


def _send_at_once(fd: int) -> None:
    with socket.socket(fileno=os.dup(fd)) as connection:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def _close(port: Any) -> None:
    # pyserial leaves a socket open that the other side has reset: it shuts down first, and that fails.
    connection = getattr(port, "_socket", None)
    # What is unplugged already need not close well.
    with contextlib.suppress(OSError):
        port.close()
    if connection is not None:
        connection.close()


def _why(url: str, error: Exception) -> str:
    """What kept us from opening the port, and what to do, for people."""
    text = str(error)
    number = getattr(error, "errno", None)
    if number in (errno.EBUSY, errno.EAGAIN) or "exclusively lock" in text:
        return "in use by another program; end that first"
    if "PermissionError(13" in text:  # how Windows says that another process has it
        return "in use by another program, or forbidden"
    if number in (errno.EACCES, errno.EPERM):
        return f"permission denied; {_how_to_be_allowed(url)}"
    if number in (errno.ENOENT, errno.ENODEV, errno.ENXIO) or "FileNotFoundError" in text:
        return "not there: is it plugged in and switched on?"
    if number == errno.ECONNREFUSED or "Connection refused" in text:
        return "connection refused: nobody listens there"
    if "Inappropriate ioctl" in text:
        return "not a serial port"
    return text


def _how_to_be_allowed(url: str) -> str:
    group = "dialout"
    if sys.platform != "win32":
        with contextlib.suppress(OSError, KeyError):
            of_device = os.stat(url)
            if stat.S_IMODE(of_device.st_mode) & stat.S_IWGRP and of_device.st_gid != 0:
                group = grp.getgrgid(of_device.st_gid).gr_name
    return f"join the group {group}: sudo usermod -aG {group} $USER, then log in again"
