"""Opening, closing and losing a line: errors that say what to do, nothing left behind, others kept out."""

from __future__ import annotations

import asyncio
import errno
import fcntl
import os
import socket
import termios
import threading
import time
from pathlib import Path

import pytest
import serial
from serial.rfc2217 import PortManager

from app.errors import LinkDown, LinkTimeout
from app.links import line_thread
from app.links.queue import LinkQueue
from app.links.serial_line import LinePort, serial_port
from app.links.streams import open_stream
from app.links.tmcl import Reply
from tests.links.pty_module import (
    LONG_S,
    PtyModule,
    answer,
    but_version,
    gap,
    port_to,
    pty_module,
    silent,
    until,
    value_of,
)


def descriptors() -> int:
    return len(os.listdir("/proc/self/fd"))


def line_threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name.startswith("line ")]


async def value(port: LinePort, number: int) -> int:
    return Reply.decode(await port.exchange(gap(number))).value


async def test_a_line_opens_when_it_is_needed_and_closes_with_its_last_port() -> None:
    with pty_module(addresses=(1, 2)) as module:
        before = descriptors()
        ports = [port_to(module, address) for address in (1, 2)]
        assert descriptors() == before
        await until(lambda: not line_threads())  # those of earlier tests may still be ending
        for _ in range(3):
            for port in ports:
                await port.exchange(gap(1, port.address))
            assert len(line_threads()) == 1
            await ports[0].aclose()
            assert len(line_threads()) == 1
            await ports[1].aclose()
            await ports[1].aclose()
            assert line_threads() == []
            assert descriptors() == before


async def test_closing_ends_a_question_that_waits() -> None:
    with pty_module(but_version(silent)) as module:
        port = port_to(module)
        asking = asyncio.create_task(port.exchange(gap(1)))
        await until(lambda: bool(module.asked()))
        started_s = time.monotonic()
        await port.aclose()
        with pytest.raises(LinkDown):
            await asking
        assert time.monotonic() - started_s < LONG_S / 2
        assert line_threads() == []


async def test_a_device_that_blocks_does_not_hold_up_closing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Opening may hang in the kernel; a FIFO that nobody writes to hangs just so."""
    release = threading.Event()

    def hang(*_: object, **__: object) -> serial.Serial:
        release.wait(20)
        raise serial.SerialException(errno.ENOENT, "gone")

    monkeypatch.setattr(serial, "serial_for_url", hang)
    monkeypatch.setattr(line_thread, "JOIN_S", 0.1)
    port = serial_port("/dev/stuck")
    asking = asyncio.create_task(port.exchange(gap(1)))
    await until(lambda: len(line_threads()) == 1)
    started_s = time.monotonic()
    await port.aclose()
    assert time.monotonic() - started_s < 5
    release.set()
    with pytest.raises(LinkDown):
        await asking
    await until(lambda: not line_threads())


async def test_another_baud_rate_opens_the_line_again() -> None:
    with pty_module() as module:
        slow, fast = port_to(module, baud=9600), port_to(module, baud=115200)
        await slow.exchange(gap(1))
        await slow.aclose()
        await fast.exchange(gap(1))
        texts = [incident.text for incident in fast.incidents.list() if incident.kind == "opened"]
        assert [text.rpartition("at ")[2] for text in texts] == ["9600 baud", "115200 baud"]
        await fast.aclose()


# --- told clearly -----------------------------------------------------------------------------


async def told(url: str) -> str:
    port = serial_port(url)
    with pytest.raises(LinkDown) as caught:
        await port.exchange(gap(1))
    await port.aclose()
    assert line_threads() == []
    return str(caught.value)


async def test_a_port_that_is_not_there() -> None:
    assert "not there: is it plugged in" in await told("/dev/ttyNOPE7")


async def test_a_port_that_is_no_port(tmp_path: Path) -> None:
    file = tmp_path / "notes.txt"
    file.write_text("precious")
    assert "not a serial port" in await told(str(file))
    assert file.read_text() == "precious"


async def test_a_port_that_another_program_has() -> None:
    with pty_module() as module:
        other = os.open(module.path, os.O_RDWR | os.O_NOCTTY)
        fcntl.flock(other, fcntl.LOCK_EX)
        port = port_to(module)
        with pytest.raises(LinkDown, match="in use by another program"):
            await value(port, 1)
        os.close(other)
        assert await value(port, 1) == value_of(1)
        # And now it is us who keep others out.
        with pytest.raises(serial.SerialException):
            serial.Serial(module.path, exclusive=True)
        await port.aclose()
        serial.Serial(module.path, exclusive=True).close()


async def test_one_device_under_two_names_is_one_line(tmp_path: Path) -> None:
    with pty_module() as module:
        alias = tmp_path / "by-id"
        alias.symlink_to(module.path)
        port, same = port_to(module), serial_port(str(alias))
        await value(port, 1)
        with pytest.raises(LinkDown, match=r"open already as .*; use one name"):
            await value(same, 1)
        await port.aclose()
        await same.aclose()


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (PermissionError(errno.EACCES, "Permission denied"), "join the group dialout: sudo usermod -aG dialout"),
        (OSError(errno.EBUSY, "Device or resource busy"), "in use by another program"),
        (serial.SerialException("could not open port 'COM3': PermissionError(13, 'Access is denied.')"), "in use by"),
        (serial.SerialException("could not open port 'COM3': FileNotFoundError(2, 'No such file')"), "not there"),
        (serial.SerialException("something else"), "something else"),
        (termios.error(5, "Input/output error"), "Input/output error"),
    ],
)
def test_what_the_system_says_is_said_in_words(error: Exception, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run as root, nothing is ever denied; so the system's errors are raised here, as pyserial hands them on."""

    def refuse(*_: object, **__: object) -> serial.Serial:
        raise error

    monkeypatch.setattr(serial, "serial_for_url", refuse)
    with pytest.raises(LinkDown) as caught:
        open_stream("serial x", "/dev/ttyNOPE7", 9600)
    assert text in str(caught.value)
    assert caught.value.__cause__ is error


# --- other ways to a line ---------------------------------------------------------------------


class NoModemLines(serial.Serial):  # type: ignore[misc]  # pyserial has no types
    """A pseudo-terminal has none, and the server of RFC 2217 sets them."""

    def _update_dtr_state(self) -> None:
        pass

    def _update_rts_state(self) -> None:
        pass

    cts = dsr = ri = cd = True


class Bridge:
    """A TCP port before a module on a pty: bytes as they are, or RFC 2217."""

    def __init__(self, module: PtyModule, *, rfc2217: bool) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        self._device = NoModemLines(module.path, timeout=0.002)
        self._rfc2217 = rfc2217
        self._over = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        self._listener.settimeout(0.05)
        while not self._over:
            try:
                connection, _ = self._listener.accept()
            except TimeoutError:
                continue
            with connection:
                connection.settimeout(0.002)
                self._serve(connection)

    def _serve(self, connection: socket.socket) -> None:
        manager = PortManager(self._device, _Writer(connection)) if self._rfc2217 else None
        while not self._over:
            try:
                data = connection.recv(1024)
                if not data:
                    return
                self._device.write(data if manager is None else b"".join(manager.filter(data)))
            except TimeoutError:
                pass
            except OSError:
                return
            if waiting := self._device.in_waiting:
                data = self._device.read(waiting)
                connection.sendall(data if manager is None else b"".join(manager.escape(data)))

    def close(self) -> None:
        self._over = True
        self._thread.join(5)
        self._listener.close()
        self._device.close()


class _Writer:
    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection

    def write(self, data: bytes) -> None:
        self._connection.sendall(data)


@pytest.mark.filterwarnings("ignore:set(Daemon|Name):DeprecationWarning")  # pyserial 3.5, rfc2217
@pytest.mark.parametrize("kind", ["socket", "rfc2217", "spy"])
async def test_other_ways_to_a_line(kind: str) -> None:
    with pty_module() as module:
        bridge = None if kind == "spy" else Bridge(module, rfc2217=kind == "rfc2217")
        url = f"spy://{module.path}" if bridge is None else f"{kind}://127.0.0.1:{bridge.port}"
        port = serial_port(url, timeout_s=LONG_S)
        queue = LinkQueue(port)
        heard: list[bytes] = []
        port.on_event(heard.append)
        replies = await queue.exchange_many([gap(n) for n in range(20)])
        assert [Reply.decode(reply).value for reply in replies] == [value_of(n) for n in range(20)]
        module.say(bytes.fromhex("0201808a000000010e"))
        await until(lambda: len(heard) == 1)
        module.behave = but_version(silent)
        with pytest.raises(LinkTimeout):
            await port.exchange(gap(1), timeout_s=0.05)
        module.behave = lambda module, frame: answer(frame)
        assert await value(port, 3) == value_of(3)
        await port.aclose()
        await until(lambda: not line_threads())
        if bridge is not None:
            bridge.close()


async def test_nobody_listens_at_the_other_end() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        number = taken.getsockname()[1]
        assert "connection refused" in await told(f"socket://127.0.0.1:{number}")


# --- pulled and plugged in --------------------------------------------------------------------


async def test_a_pulled_cable_is_noticed_at_once_and_told() -> None:
    with pty_module() as module:
        port = port_to(module)
        down: list[LinkDown] = []
        port.on_down(down.append)
        await value(port, 1)
        module.unplug()
        await until(lambda: len(down) == 1)
        with pytest.raises(LinkDown, match="not there"):
            await value(port, 1)
        assert [incident.kind for incident in port.incidents.list()] == ["opened", "down", "down"]
        await port.aclose()


async def test_a_cable_pulled_in_the_middle_of_a_question() -> None:
    with pty_module(but_version(silent)) as module:
        port = port_to(module)
        asking = asyncio.create_task(port.exchange(gap(1)))
        await until(lambda: bool(module.asked()))
        module.unplug()
        with pytest.raises(LinkDown):
            await asking
        await port.aclose()
    assert line_threads() == []


async def test_plugged_in_again_under_load_leaves_nothing_behind() -> None:
    """The link alone, without the watch: each time the first question after the plug is answered, and rightly."""
    with pty_module() as module:
        port = port_to(module)
        queue = LinkQueue(port)
        await queue.exchange(gap(1))
        before = descriptors(), threading.active_count()
        for number in range(20):
            seen = len(module.seen)
            load = asyncio.create_task(queue.exchange_many([gap(n) for n in range(256)] * 50))
            await until(lambda seen=seen: len(module.seen) > seen + 50)  # type: ignore[misc]
            module.unplug()
            with pytest.raises(LinkDown):
                await load
            module.plug()
            assert Reply.decode(await queue.exchange(gap(number))).value == value_of(number)
            assert (descriptors(), threading.active_count()) == before
        await port.aclose()


@pytest.mark.parametrize("error", [None, AttributeError(), NotImplementedError(), OSError(25, "no"), ValueError("no")])
def test_adapters_are_asked_not_to_collect_bytes(error: Exception | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of FTDI keep an answer for 16 ms otherwise; a port that cannot is as good as ever."""
    asked: list[bool] = []

    def low_latency(self: object, wanted: bool) -> None:
        asked.append(wanted)
        if error is not None:
            raise error

    monkeypatch.setattr(serial.Serial, "set_low_latency_mode", low_latency, raising=False)
    with pty_module() as module:
        open_stream("line", module.path, 9600).close()
    assert asked == [True]
