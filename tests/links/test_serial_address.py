"""Names of serial ports: nothing but serial devices is opened, however a name is written."""

from __future__ import annotations

import os
import random
import sys
from collections.abc import Iterator
from contextlib import aclosing, contextmanager
from pathlib import Path
from urllib.parse import quote

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.clock import VirtualClock
from app.errors import BenchError, LinkDown, UsageError
from app.links.can_bus import INTERFACES, SERIAL_INTERFACES
from app.links.registry import Link, can_factory
from app.links.serial_address import allow_ports, device_of, openable, port_url
from app.links.streams import open_stream

SWITCHES = ["", "?color", "?raw", "?all", "?color&raw&all"]


@pytest.mark.parametrize(
    "name",
    [
        "/dev/ttyUSB0",
        "/dev/serial/by-id/usb-FTDI_FT232R_USB_UART_A50285BI-if00-port0",
        "COM3",
        "/tmp/motor",
        "socket://192.168.0.5:4000",
        "socket://[::1]:4000",
        "socket://bench-1.local:1",
        "rfc2217://127.0.0.1:65535?poll_modem",
        "rfc2217://gateway:2217?ign_set_control&poll_modem",
        *(f"spy:///dev/ttyUSB0{options}" for options in SWITCHES),
    ],
)
def test_names_that_pyserial_may_have(name: str) -> None:
    assert port_url(name) == name


@pytest.mark.parametrize(
    "name",
    [
        "spy:///dev/null?file=/tmp/x",
        "spy:///dev/null?%66ile=/tmp/x",
        "spy:///dev/null?fi\tle=/tmp/x",
        "spy:///dev/null?fi\nle=/tmp/x",
        "spy:///dev/null?color&file=/tmp/x",
        "spy:///dev/null?color;file=/tmp/x",
        "spy:///dev/null?File=/tmp/x",
        "spy:///dev/null?",
        "spy:///dev/null#?file=/tmp/x",
        "spy://spy:///dev/null?file=/tmp/x",
        "spy://",
        "SPY:///dev/null?file=/tmp/x",
        "sPy:///dev/ttyUSB0",
        "alt:///dev/null?class=PosixPollSerial",
        "loop://?logging=debug",
        "hwgrep://.*",
        "cp2110://0001:004a:00",
        "socket://host",
        "socket://host:0",
        "socket://host:65536",
        "socket://host:٣",
        "socket://user@host:1",
        "socket://host:1/?logging=debug",
        "socket://host:1?logging=debug",
        "rfc2217://host:1?logging=debug",
        "rfc2217://host:1?timeout=1e9",
        "/dev/tty%55SB0",
        "/dev/tty\0USB0",
        "/dev/ttyUSB0\n",
        "/dev/" + "x" * 200,
    ],
)
def test_names_that_could_mean_more_are_refused(name: str) -> None:
    with pytest.raises(UsageError):
        port_url(name)


@pytest.mark.parametrize(
    "device",
    ["/dev/null", "/dev/mem", "/dev/tty", "/dev/tty1", "/dev/ptmx", "/etc/hostname", "/", "COM3", "../ttyUSB0"],
)
@pytest.mark.skipif(os.name != "posix", reason="names of devices are those of a posix system")
def test_what_is_no_serial_device_is_not_opened_and_nobody_learns_whether_it_is_there(device: str) -> None:
    told = []
    for name in (device, device + "-that-is-not-there"):
        with pytest.raises(LinkDown, match="not a serial port") as refused:
            open_stream("line", name, 9600)
        told.append(str(refused.value).replace(name, "it"))
    assert told[0] == told[1]


@pytest.mark.skipif(os.name != "posix", reason="links of a posix system")
def test_a_link_is_followed_before_it_is_judged(tmp_path: Path) -> None:
    file, motor, trap = tmp_path / "file", tmp_path / "motor", tmp_path / "ttyUSB0"
    file.write_text("kept")
    _, far = os.openpty()
    motor.symlink_to(os.ttyname(far))
    trap.symlink_to(file)
    assert openable("line", str(motor)) == os.ttyname(far)
    assert openable("line", f"spy://{motor}?raw") == f"spy://{os.ttyname(far)}?raw"
    for name in (str(trap), f"spy://{trap}", f"/dev/../{trap}"):
        with pytest.raises(LinkDown):
            openable("line", name)


def test_what_the_setting_names_is_opened_and_nothing_beside_it(tmp_path: Path) -> None:
    allow_ports([f"{os.path.realpath(tmp_path)}/motor*"])
    try:
        assert openable("line", str(tmp_path / "motor1")) == os.path.realpath(tmp_path / "motor1")
        for name in ("other", "motor/../other"):
            with pytest.raises(LinkDown):
                openable("line", str(tmp_path / name))
    finally:
        allow_ports([])


# --- whatever is asked -------------------------------------------------------------------------

_opened: list[str] | None = None


def _hear(event: str, arguments: tuple[object, ...]) -> None:
    if event == "open" and _opened is not None and isinstance(arguments[0], str | bytes | os.PathLike):
        _opened.append(os.fsdecode(arguments[0]))


sys.addaudithook(_hear)


@contextmanager
def opened_files() -> Iterator[list[str]]:
    """The names of all files that this process opens meanwhile."""
    global _opened
    _opened = []
    try:
        yield _opened
    finally:
        _opened = None


def _spoilt(chance: random.Random, text: str) -> str:
    """`text` with some of its characters escaped, in the other case, or with blanks between them."""
    spoil = chance.choice(["plain", "escaped", "case", "tab"])
    at = chance.randrange(len(text))
    if spoil == "escaped":
        return text[:at] + "".join(f"%{byte:02x}" for byte in text[at].encode()) + text[at + 1 :]
    if spoil == "case":
        return text[:at] + text[at].swapcase() + text[at + 1 :]
    return text[:at] + chance.choice("\t\n\r ") + text[at:] if spoil == "tab" else text


def strange_names(target: str, count: int, seed: int = 13) -> Iterator[str]:
    """Ways to write `target` (a file) as the name of a port, or into one."""
    chance = random.Random(seed)
    schemes = ("spy", "alt", "loop", "hwgrep", "socket", "rfc2217", "file", "cp2110")
    shapes = (
        lambda: target,
        lambda: f"/dev/../{target}",
        lambda: f"{chance.choice(schemes)}://{target}",
        lambda: f"spy:///dev/ttyUSB9?{_spoilt(chance, 'file')}={chance.choice([target, quote(target, safe='')])}",
        lambda: f"spy://{chance.choice(schemes)}://{target}?{_spoilt(chance, 'file')}={target}",
        lambda: f"spy://{target}?{chance.choice(['raw', 'all', 'color'])}{chance.choice('&;#')}file={target}",
        lambda: f"{target}@{chance.randrange(100000)}",
        lambda: f"alt://{target}?class={chance.choice(['Serial', 'PosixPollSerial', 'VTIMESerial'])}",
    )
    for number in range(count):
        name = shapes[number % len(shapes)]()
        yield _spoilt(chance, name) if chance.random() < 0.5 else name


def test_no_name_of_a_serial_port_opens_or_writes_a_file(tmp_path: Path) -> None:
    target = tmp_path / "kept.txt"
    target.write_text("kept")
    with opened_files() as opened:
        for name in strange_names(str(target), 2000):
            with pytest.raises(BenchError):
                open_stream("line", port_url(name), 9600)
    assert [name for name in opened if str(tmp_path) in name] == []
    assert [path.name for path in tmp_path.iterdir()] == ["kept.txt"]
    assert target.read_text() == "kept"


async def ask_over_can(link: Link) -> None:
    async with aclosing(can_factory("pd42-1241", link, VirtualClock())) as port:
        await port.exchange(bytes(9))


async def test_no_channel_of_a_can_bus_opens_or_writes_a_file(tmp_path: Path) -> None:
    target = tmp_path / "kept.txt"
    target.write_text("kept")
    interfaces = sorted((SERIAL_INTERFACES | INTERFACES | {"socketcand", "canine", "../x", "os"}) - {"virtual"})
    with opened_files() as opened:
        for number, name in enumerate(strange_names(str(target), 400)):
            link = {"kind": "can", "interface": interfaces[number % len(interfaces)], "channel": name}
            with pytest.raises(BenchError):
                await ask_over_can(link)
    assert [name for name in opened if str(tmp_path) in name] == []
    assert target.read_text() == "kept"


@given(st.text(max_size=210))
def test_whatever_is_let_through_names_one_device_or_one_host(name: str) -> None:
    try:
        url = port_url(name)
    except UsageError:
        return
    assert url == name
    assert not any(character in url for character in "%\t\n\r\0")
    device = device_of(url)
    assert device or url.startswith(("socket://", "rfc2217://")) or not url
