"""Real pseudo terminals and real sockets: the only things here that happen in real time."""

from __future__ import annotations

import contextlib
import os
import select
import socket
import termios
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.clock import WallClock
from app.emulators.line.faults import LinePatch
from app.emulators.line.line import Line
from app.emulators.line.pty import PtyEnd
from app.emulators.line.server import LineServer
from app.emulators.line.tcp import MOST_CLIENTS, TcpEnd
from app.links import tmcl
from app.registers.tmcl.commands import Opcode
from tests.emulators.line.modules import SmallModule, gap, sap

SOON_S = 10.0
"""How long anything may take on a busy machine [s]; normally it is there in under a millisecond."""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "module"


@contextlib.contextmanager
def serving(server: LineServer) -> Iterator[LineServer]:
    """`server`, entered, and run by a thread of its own."""
    with server:
        thread = threading.Thread(target=server.run, name="line")
        thread.start()
        try:
            yield server
        finally:
            server.stop()
            thread.join(SOON_S)
            assert not thread.is_alive()


def line(baud: int | None = None, addresses: tuple[int, ...] = (1,), move_s: float = 0.05) -> Line:
    clock = WallClock()
    return Line([SmallModule(clock, address, move_s=move_s) for address in addresses], clock, baud=baud)


def tcp() -> tuple[TcpEnd, tuple[str, int]]:
    listener = socket.create_server(("127.0.0.1", 0))
    return TcpEnd(listener), listener.getsockname()


@contextlib.contextmanager
def opened(path: Path, speed: int | None = None) -> Iterator[int]:
    descriptor = os.open(path, os.O_RDWR | os.O_NOCTTY)
    try:
        if speed is not None:
            settings = termios.tcgetattr(descriptor)
            settings[4] = settings[5] = speed
            termios.tcsetattr(descriptor, termios.TCSANOW, settings)
        yield descriptor
    finally:
        os.close(descriptor)


def hear(descriptor: int, count: int = 9, within_s: float = SOON_S) -> bytes:
    """`count` bytes, or what came of them in time."""
    got, until_s = b"", time.monotonic() + within_s
    while len(got) < count and (left_s := until_s - time.monotonic()) > 0:
        if select.select([descriptor], [], [], left_s)[0]:
            more = os.read(descriptor, count - len(got))
            if not more:
                break
            got += more
    return got


def ask(descriptor: int, frame: bytes) -> tmcl.Reply:
    os.write(descriptor, frame)
    return tmcl.Reply.decode(hear(descriptor))


def faults(server: LineServer, **change: object) -> None:
    server.call(lambda: server.line.patch(LinePatch.model_validate({"faults": change})))


# --- pty ----------------------------------------------------------------------------------------


def test_bytes_pass_a_pty_unchanged(path: Path) -> None:
    """Also those that a terminal would take for Ctrl-C, XOFF or a line end."""
    with serving(LineServer(line(), [PtyEnd(path)])), opened(path) as port:
        for value in (0x0A0D0311, 0x1304_1C7F, -1, 0):
            assert ask(port, sap(4, value)).value == value
            assert ask(port, gap(4)).value == value


def test_the_next_client_finds_the_port_as_the_first_did(path: Path) -> None:
    with serving(LineServer(line(), [PtyEnd(path)])):
        for count in range(20):
            with opened(path) as port:
                assert ask(port, sap(4, count)).value == count


def test_a_stale_link_is_replaced_and_ours_removed_at_the_end(path: Path) -> None:
    path.symlink_to("/dev/pts/no-such-terminal")
    with serving(LineServer(line(), [PtyEnd(path)])), opened(path) as port:
        assert ask(port, gap()).ok
    assert not path.is_symlink()
    assert list(path.parent.iterdir()) == []


def test_a_link_that_another_emulator_has_taken_over_stays(path: Path) -> None:
    with contextlib.ExitStack() as first:
        first.enter_context(serving(LineServer(line(), [PtyEnd(path)])))
        with serving(LineServer(line(addresses=(2,)), [PtyEnd(path)])), opened(path) as port:
            first.close()
            assert ask(port, gap(address=2)).module == 2
            assert path.is_symlink()
        assert not path.is_symlink()


def test_what_is_no_link_is_left_alone(path: Path) -> None:
    path.write_text("precious")
    descriptors = open_descriptors()
    with pytest.raises(FileExistsError, match="choose another path"), LineServer(line(), [PtyEnd(path)]):
        pass
    with pytest.raises(OSError, match="No such file"), LineServer(line(), [PtyEnd(path.parent / "nowhere" / "module")]):
        pass
    assert path.read_text() == "precious"
    assert open_descriptors() == descriptors


def test_pulled_and_plugged_in_again_it_is_the_same_port(path: Path) -> None:
    with serving(LineServer(line(), [PtyEnd(path)])) as server:
        descriptors = None
        for count in range(25):
            with opened(path) as port:
                assert ask(port, sap(4, count)).value == count
                os.write(port, gap()[:5])  # half a frame, which nobody must remember
                faults(server, unplugged=True)
                assert not path.is_symlink()
                with pytest.raises(OSError, match="Input/output"):  # noqa: PT012 - an end or an error: both are an end
                    if not os.read(port, 9):
                        raise OSError("Input/output: end of file")
            faults(server, unplugged=False)
            with opened(path) as port:
                assert ask(port, gap(4)).value == count, "the module was on all the time"
            descriptors = descriptors or open_descriptors()
        assert open_descriptors() == descriptors


def open_descriptors() -> int:
    return len(os.listdir("/proc/self/fd"))


@pytest.mark.parametrize(("speed", "heard"), [(termios.B115200, True), (termios.B9600, False), (None, True)])
def test_with_a_modelled_baud_rate_only_that_one_is_understood(path: Path, speed: int | None, heard: bool) -> None:
    with serving(LineServer(line(baud=115_200), [PtyEnd(path)])), opened(path, speed) as port:
        os.write(port, gap())
        assert len(hear(port, within_s=SOON_S if heard else 0.3)) == (9 if heard else 0)


def test_answers_keep_their_wire_time(path: Path) -> None:
    """Never early; how late is a matter of the machine, so only that it is not absurd."""
    questions = 50
    with serving(LineServer(line(baud=19_200), [PtyEnd(path)])), opened(path) as port:
        ask(port, gap())
        start_s = time.monotonic()
        for _ in range(questions):
            assert ask(port, gap()).ok
        took_s = time.monotonic() - start_s
    wire_s = questions * 180 / 19_200
    assert wire_s <= took_s < wire_s + SOON_S


def test_an_event_comes_unasked(path: Path) -> None:
    with serving(LineServer(line(move_s=0.05), [PtyEnd(path)])), opened(path) as port:
        assert ask(port, tmcl.Request(1, Opcode.REQUEST_EVENT, 1, 0, 1).encode()).ok
        assert ask(port, tmcl.Request(1, Opcode.MVP, 0, 0, 1000).encode()).ok
        assert tmcl.is_event(hear(port))


def test_who_never_reads_stops_nobody_else(path: Path) -> None:
    end, address = tcp()
    with serving(LineServer(line(), [PtyEnd(path), end])), opened(path) as port:
        os.set_blocking(port, False)
        for _ in range(3000):  # 27,000 bytes of answers, of which a terminal keeps four thousand
            with contextlib.suppress(BlockingIOError):
                os.write(port, gap())
        with socket.create_connection(address, SOON_S) as other:
            assert ask(other.fileno(), gap()).ok


# --- tcp ----------------------------------------------------------------------------------------


def test_two_clients_at_once_each_get_their_own_answers() -> None:
    end, address = tcp()
    wrong: list[object] = []

    def hammer(own: int) -> None:
        with socket.create_connection(address, SOON_S) as connection:
            for count in range(300):
                value = own * 1000 + count
                for frame in (sap(own, value), gap(own)):
                    reply = ask(connection.fileno(), frame)
                    if reply.value != value:
                        wrong.append((own, frame, reply))

    with serving(LineServer(line(), [end])):
        clients = [threading.Thread(target=hammer, args=(own,)) for own in (1, 2)]
        for client in clients:
            client.start()
        for client in clients:
            client.join(SOON_S * 3)
    assert wrong == []


def test_a_client_that_leaves_in_the_middle_is_forgotten() -> None:
    end, address = tcp()
    with serving(LineServer(line(), [end])):
        for length in range(1, 9):
            with socket.create_connection(address, SOON_S) as connection:
                connection.sendall(gap()[:length])
        with socket.create_connection(address, SOON_S) as connection:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\x01\0\0\0\0\0\0\0")
            connection.sendall(gap() * 100)  # and away, with a reset, before the answers come
        with socket.create_connection(address, SOON_S) as connection:
            assert ask(connection.fileno(), gap()).ok


def test_unplugged_it_hangs_up_on_everybody() -> None:
    end, address = tcp()
    with serving(LineServer(line(), [end])) as server, socket.create_connection(address, SOON_S) as connection:
        assert ask(connection.fileno(), gap()).ok
        faults(server, unplugged=True)
        assert connection.recv(9) == b""
        with socket.create_connection(address, SOON_S) as late:
            assert late.recv(9) == b""
        faults(server, unplugged=False)
        with socket.create_connection(address, SOON_S) as again:
            assert ask(again.fileno(), gap()).ok


def test_more_clients_than_it_can_watch_are_turned_away() -> None:
    end, address = tcp()
    with serving(LineServer(line(), [end])), contextlib.ExitStack() as stack:
        first = stack.enter_context(socket.create_connection(address, SOON_S))
        assert ask(first.fileno(), gap()).ok
        crowd = [stack.enter_context(socket.create_connection(address, SOON_S)) for _ in range(MOST_CLIENTS)]
        assert crowd[-1].recv(9) == b""
        assert ask(first.fileno(), gap()).ok


# --- from outside -------------------------------------------------------------------------------


def test_an_error_of_a_call_comes_back_to_who_called(path: Path) -> None:
    with serving(LineServer(line(), [PtyEnd(path)])) as server:
        with pytest.raises(ZeroDivisionError):
            server.call(lambda: 1 // 0)
        faults(server, unplugged=True)
        path.write_text("in the way")
        with pytest.raises(FileExistsError):
            faults(server, unplugged=False)
        path.unlink()
        faults(server, unplugged=False)
        with opened(path) as port:
            assert ask(port, gap()).ok


def test_modules_live_on_while_nobody_asks(path: Path) -> None:
    served = line()
    module = served.modules[0]
    assert isinstance(module, SmallModule)
    with serving(LineServer(served, [PtyEnd(path)])):
        until_s = time.monotonic() + SOON_S
        while module.lived_s < 0.2 and time.monotonic() < until_s:
            time.sleep(0.01)
    assert module.lived_s >= 0.2
