"""Names and words of `stepscope fault`; tests/peers/test_command_line.py lets it talk to an emulator."""

from __future__ import annotations

import socket
import threading

import pytest
from typer.testing import CliRunner

from app.cli import cli
from app.emulator_server import fault
from app.emulators.board.options import BoardPatch
from app.emulators.line.faults import LinePatch
from app.emulators.tmcl.options import TmclPatch
from app.errors import LinkDown, LinkError, UnknownThing, UsageError


@pytest.mark.parametrize(
    ("name", "path"),
    [
        ("silence", "faults.silence"),
        ("faults.silence", "faults.silence"),
        ("unplugged", "faults.unplugged"),
        ("undervoltage", "faults.undervoltage"),
        ("load_torque_nm", "load_torque_nm"),
        ("slip_fullsteps", "encoder.slip_fullsteps"),
        ("left", "switches.left"),
        ("pulses", "step_dir.pulses"),
        ("blocked", "blocked"),
        ("power_cycle", "power_cycle"),
    ],
)
def test_a_name_may_leave_out_its_path(name: str, path: str) -> None:
    assert fault.path_of(TmclPatch, name) == path


def test_a_board_and_its_chip_have_faults_of_the_same_name() -> None:
    assert fault.path_of(BoardPatch, "silence") == "faults.silence"
    assert fault.path_of(BoardPatch, "chip.faults.silence") == "chip.faults.silence"
    assert fault.path_of(BoardPatch, "load_torque_nm") == "chip.load_torque_nm"


def test_every_name_leads_to_itself_and_every_short_one_is_alone() -> None:
    for model in (TmclPatch, LinePatch):
        for path in fault.names_of(model):
            assert fault.path_of(model, path) == path
            assert fault.path_of(model, path.rpartition(".")[2]) == path


def test_an_unknown_name_is_told_with_those_that_there_are() -> None:
    with pytest.raises(UnknownThing, match=r"faults\.silence"):
        fault.path_of(TmclPatch, "silent")


@pytest.mark.parametrize(
    ("word", "value"),
    [("on", True), ("OFF", False), ("true", True), ("3", 3), ("-0.25", -0.25), ("1e-3", 0.001), ("auto", "auto")],
)
def test_a_word_is_what_it_looks_like(word: str, value: object) -> None:
    meant = fault._value(word)
    assert meant == value
    assert type(meant) is type(value)


@pytest.mark.parametrize("word", ["nan", "inf", "-Infinity"])
def test_no_number_is_no_value(word: str) -> None:
    with pytest.raises(UsageError):
        fault._value(word)


@pytest.mark.parametrize(
    ("url", "target"),
    [
        ("http://127.0.0.1:9000", "http://127.0.0.1:9000/emulator"),
        ("127.0.0.1:9000/", "http://127.0.0.1:9000/emulator"),
        ("http://h:1/api/v1/devices/far/emulator", "http://h:1/api/v1/devices/far/emulator"),
    ],
)
def test_where_it_goes(url: str, target: str) -> None:
    assert fault._target(url, None, line=False) == target


def test_where_it_goes_with_an_address_or_to_the_line() -> None:
    assert fault._target("http://h:1", 7, line=False) == "http://h:1/emulator/7"
    assert fault._target("http://h:1", None, line=True) == "http://h:1/line"


@pytest.mark.parametrize("url", ["ftp://h:1", "http://", "http://h:99999", "file:///etc/passwd"])
def test_what_is_no_address_is_told(url: str) -> None:
    with pytest.raises(UsageError, match="no address"):
        fault._target(url, None, line=False)


def test_nobody_there_and_somebody_else_there() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]

        def answer() -> None:
            connection, _ = server.accept()
            with connection:
                connection.recv(4096)
                connection.sendall(b"SSH-2.0-something\r\n")

        thread = threading.Thread(target=answer)
        thread.start()
        with pytest.raises(LinkError, match="does not answer like an emulator"):
            fault.change(f"http://127.0.0.1:{port}", "silence", "on")
        thread.join()
    with pytest.raises(LinkDown, match="is `stepscope emulate"):
        fault.change(f"http://127.0.0.1:{port}", "silence", "on")


def test_the_command_line_tells_and_does_not_throw() -> None:
    for arguments, words in (
        (["http://127.0.0.1:1", "silence", "on"], "is `stepscope emulate"),
        (["http://127.0.0.1:1", "loudness", "on"], "no fault is called"),
        (["nowhere:0x1", "silence", "on"], "no address"),
    ):
        result = CliRunner().invoke(cli, ["fault", *arguments])
        assert result.exit_code == 1
        assert words in result.output
        assert isinstance(result.exception, SystemExit)
