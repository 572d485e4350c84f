"""`stepscope emulate pd42-1241` and `stepscope fault` as a user types them."""

from __future__ import annotations

import json
import os
import select
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli import cli
from app.links import tmcl
from app.registers.tmcl.commands import Opcode
from tests.peers.emulator_process import EmulatorProcess, emulator

SOON_S = 20.0
GAP = tmcl.Request(1, Opcode.GAP, 1).encode()


def ask(port: int, frame: bytes, within_s: float = SOON_S) -> bytes:
    os.write(port, frame)
    got, until_s = b"", time.monotonic() + within_s
    while len(got) < 9 and (left_s := until_s - time.monotonic()) > 0:
        if select.select([port], [], [], left_s)[0]:
            got += os.read(port, 9 - len(got))
    return got


def stepscope(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "app.cli", *arguments], capture_output=True, text=True, timeout=60, check=False
    )


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_it_ends_cleanly_and_takes_its_link_along(tmp_path: Path, how: signal.Signals) -> None:
    with emulator(pty=tmp_path / "module") as process:
        assert process.end(how) == 0
        assert process.process.stdout is not None
        said = process.process.stdout.read().splitlines()
        # that it was held up by a busy machine it says, and has to
        assert [line for line in said if b"stood still" not in line] == [], "nothing but its first line was said"
    assert list(tmp_path.iterdir()) == []


def test_it_keeps_its_eeprom_where_it_is_told(tmp_path: Path) -> None:
    store = [tmcl.Request(1, opcode, 5, 2, 4711).encode() for opcode in (Opcode.SGP, Opcode.STGP)]
    for round_ in range(2):
        with emulator("--data-dir", str(tmp_path / "data"), pty=tmp_path / "module") as process:
            assert process.pty is not None
            port = os.open(process.pty, os.O_RDWR | os.O_NOCTTY)
            if round_ == 0:
                assert all(tmcl.Reply.decode(ask(port, frame)).ok for frame in store)
            assert tmcl.Reply.decode(ask(port, tmcl.Request(1, Opcode.GGP, 5, 2).encode())).value == 4711
            os.close(port)
            assert process.end() == 0
    assert [path.name for path in (tmp_path / "data" / "emulators").iterdir()] == ["pd42-1241-1.json"]


def test_faults_by_command_line(modules: EmulatorProcess) -> None:
    """Unplugged and back, of the whole line: the port goes, and comes again under its name."""
    assert modules.pty is not None
    port = os.open(modules.pty, os.O_RDWR | os.O_NOCTTY)
    assert len(ask(port, GAP)) == 9
    said = stepscope("fault", modules.control, "unplugged", "on", "--line")
    assert (said.returncode, said.stdout) == (0, "faults.unplugged = on\n")
    assert not modules.pty.is_symlink()
    os.close(port)
    said = stepscope("fault", modules.control, "unplugged", "off", "--line", "--json")
    assert json.loads(said.stdout)["plugged"] is True
    port = os.open(modules.pty, os.O_RDWR | os.O_NOCTTY)
    assert len(ask(port, GAP)) == 9
    said = stepscope("fault", modules.control, "silence", "on", "--address", "1")
    assert said.returncode == 0
    assert ask(port, GAP, within_s=0.3) == b""
    assert len(ask(port, tmcl.Request(2, Opcode.GAP, 1).encode())) == 9, "the other module speaks"
    os.close(port)
    refused = stepscope("fault", modules.control, "silence", "on")
    assert refused.returncode == 1
    assert "/emulator/2" in refused.stderr


def test_on_a_shared_bus_everybody_hears_everybody(tmp_path: Path) -> None:
    with emulator("--tcp", "127.0.0.1:0", "--shared-bus", pty=tmp_path / "module") as process:
        assert process.tcp is not None
        assert process.pty is not None
        port = os.open(process.pty, os.O_RDWR | os.O_NOCTTY)
        with socket.create_connection(process.tcp, SOON_S) as other:
            assert len(ask(other.fileno(), GAP)) == 9
            reply = ask(port, b"")
            assert reply == GAP, "the question of the other first"
            assert len(ask(port, b"")) == 9, "then its answer"
        os.close(port)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["emulate", "pd42-1241"], "--pty PATH"),
        (["emulate", "tmc428"], "--tcp HOST:PORT"),
        (["emulate", "pd42-1241", "--tcp", "nowhere"], "HOST:PORT"),
        (["emulate", "pd42-1241", "--pty", "/nowhere/at/all"], "No such file"),
        (["emulate", "pd42-1241", "--pty", "/dev/null"], "choose another path"),
        (["emulate", "pd42-1241", "--tcp", "127.0.0.1:0", "--address", "1", "--address", "1"], "address of its own"),
        (["emulate", "pd42-1241", "--tcp", "127.0.0.1:0", "--address", "300"], "address"),
        (["emulate", "pd42-1241", "--tcp", "127.0.0.1:0", "--wiring", "left-only"], "--wiring is not for a pd42-1241"),
        (
            ["emulate", "pd42-1241", "--tcp", "127.0.0.1:0", "--v-actual-writable", "velocity-mode"],
            "--v-actual-writable is not for a pd42-1241",
        ),
        (["emulate", "tmc428", "--tcp", "127.0.0.1:0", "--shared-bus"], "--shared-bus is not for a tmc428"),
        (["emulate", "tmc428", "--can", "vcan0"], "--can is not for a tmc428"),
        (["emulate", "tmcm-1161", "--can", "virtual:x"], "--can is not for a tmcm-1161"),
        (["emulate", "pd42-1241", "--can", "stepscope-none"], "can socketcan stepscope-none"),
        (["emulate", "pd42-1241", "--can", "carrier-pigeon:x"], "no interface 'carrier-pigeon'"),
        (["emulate", "pd42-1241", "--can", "virtual:/etc/passwd"], "letters, digits"),
        (["emulate", "pd42-1241", "--tcp", "127.0.0.1:0", "--control", "9000"], "--control is HOST:PORT"),
        (["emulate", "pd42-1241", "--tcp", "127.0.0.1:0", "--node", "1"], "--node is not for a pd42-1241"),
        (["emulate", "tmc4361", "--tcp", "127.0.0.1:0", "--uart"], "--uart is not for a tmc4361"),
        (["emulate", "tmc5160", "--tcp", "127.0.0.1:0", "--echo"], "--echo is not for a tmc5160 here"),
        (["emulate", "tmc5031", "--pty", "/nowhere/x", "--node", "1"], "--node is not for a tmc5031"),
        (["emulate", "tmc5062", "--pty", "/nowhere/x", "--node", "1"], "has no node address"),
        (["emulate", "tmc5160", "--pty", "/nowhere/x", "--node", "1", "--node", "1"], "address of its own"),
        (["emulate", "tmc5160", "--pty", "/nowhere/x", "--node", "255"], "node"),
    ],
)
def test_what_cannot_be_served_is_told(arguments: list[str], words: str) -> None:
    result = CliRunner().invoke(cli, arguments)
    assert result.exit_code in (1, 2)
    assert words in result.output
    assert isinstance(result.exception, SystemExit), "told, not thrown"
