"""`stepscope emulate MAP.toml`: a chip that only a file tells, as a process, to a client that is not ours."""

from __future__ import annotations

import os
import select
import socket
from pathlib import Path

import pytest

from app.links.datagram_uart import UartForm
from tests.api.processes import running
from tests.peers.test_command_line import stepscope
from tests.registers.maps.test_reader import EXAMPLE, TOLD, example


def kept(folder: Path, content: bytes, name: str = "own_core.toml") -> str:
    (folder / name).write_bytes(content)
    return str(folder / name)


def asked(line: str, *frames: str) -> list[str]:
    """What a plain socket gets for these frames, one after the other."""
    host, _, port = line.split(" on tcp ")[1].split()[0].rpartition(":")
    replies = []
    with socket.create_connection((host, int(port)), 10) as client:
        for frame in frames:
            client.sendall(bytes.fromhex(frame))
            held = b""
            while len(held) < len(bytes.fromhex(frame)):
                held += client.recv(64)
            replies.append(held.hex())
    return replies


def test_usual_datagrams_over_tcp(tmp_path: Path) -> None:
    with running("emulate", kept(tmp_path, EXAMPLE), "--tcp", "127.0.0.1:0") as (_, line):
        assert line.startswith("emulated own-core listens")
        assert asked(line, "a700001234", "2700000000", "2700000000")[-1] == "0000001234"


def test_datagrams_of_its_own_over_tcp(tmp_path: Path) -> None:
    # Address 4 with the write bit below it (0 writes), 24 bits lowest byte first, answered at once.
    with running("emulate", kept(tmp_path, TOLD), "--tcp", "127.0.0.1:0") as (_, line):
        assert asked(line, "0008563412", "0009000000") == ["0000563412", "0000563412"]


def test_a_table_too(tmp_path: Path) -> None:
    with running("emulate", kept(tmp_path, example("csv"), "table.csv"), "--tcp", "127.0.0.1:0") as (_, line):
        assert asked(line, "a100000007", "2100000000", "2100000000")[-1] == "0000000007"


def test_its_uart_at_a_terminal(tmp_path: Path) -> None:
    content = EXAMPLE.replace(b"[spi]\n", b"[uart]\n")
    with running("emulate", kept(tmp_path, content), "--pty", str(tmp_path / "wire"), "--node", "3") as (_, line):
        assert line.startswith(f"emulated own-core at pty {tmp_path / 'wire'}")
        port, form = os.open(tmp_path / "wire", os.O_RDWR | os.O_NOCTTY), UartForm(3)
        os.write(port, form.write(0x27, 0x1234))
        os.write(port, form.read(0x27))
        reply = b""
        while len(reply) < form.reply_bytes and select.select([port], [], [], 10)[0]:
            reply += os.read(port, form.reply_bytes - len(reply))
        assert form.data_of(0x27, reply) == 0x1234
        os.close(port)


@pytest.mark.parametrize(
    ("content", "name", "words"),
    [
        (EXAMPLE.replace(b"width = 23", b"width = 33"), "x.toml", "x.toml:56: register VMAX, width: is 33, allowed is"),
        (EXAMPLE, "tmc428.toml", "tmc428 is a model already"),
        (EXAMPLE, "ä.toml", "a register map is called by small letters"),
        (EXAMPLE.replace(b"[spi]\n", b""), "x.toml", "x has no [spi]"),
        (EXAMPLE.replace(b"[spi]\n", b"[uart]\n"), "x.toml", "x has no [spi], only a UART: say --pty, or --uart"),
    ],
)
def test_what_cannot_be_is_told(content: bytes, name: str, words: str, tmp_path: Path) -> None:
    said = stepscope("emulate", kept(tmp_path, content, name), "--tcp", "127.0.0.1:0")
    assert (said.returncode, words in said.stderr) == (1, True), said.stderr


def test_a_file_that_is_not_there() -> None:
    said = stepscope("emulate", "/nowhere/map.toml", "--tcp", "127.0.0.1:0")
    assert said.returncode == 1
    assert "No such file" in said.stderr
