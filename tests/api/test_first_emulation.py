"""`stepscope emulate` where nothing is compiled yet: it is there at once, and compiles what its model needs behind."""

from __future__ import annotations

import re
import socket
import subprocess
from pathlib import Path

import pytest

from app import kernels
from app.emulator_server.compiling import compiled_behind, serve_plain
from app.links.datagram40 import read, write
from app.registers.catalog import find_model
from tests.api.processes import STEPSCOPE, environment

ROOT = Path(__file__).parents[2]
REGISTERS = {"CHOPCONF": 0x6C, "IHOLD_IRUN": 0x10, "AMAX": 0x26, "VMAX": 0x27, "RAMPMODE": 0x20}
TO_TURN = {"CHOPCONF": 0x1041_0155, "IHOLD_IRUN": 0x1F0F, "AMAX": 60_000, "VMAX": 200_000, "RAMPMODE": 1}
XACTUAL = 0x21


def test_a_motor_turns_before_anything_is_compiled(tmp_path: Path) -> None:
    command = [*STEPSCOPE, "emulate", "tmc5160", "--tcp", "127.0.0.1:0"]
    process = subprocess.Popen(
        command,
        cwd=ROOT,
        env=environment() | {"NUMBA_CACHE_DIR": str(tmp_path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdout is not None
    try:
        told = process.stdout.readline()
        found = re.search(r"tcp 127\.0\.0\.1:(\d+)", told)
        assert found is not None, told
        with socket.create_connection(("127.0.0.1", int(found[1])), timeout=60) as line:

            def exchange(frame: bytes) -> int:
                line.sendall(frame)
                answer = b""
                while len(answer) < len(frame):
                    answer += line.recv(16)
                return int.from_bytes(answer[1:], "big")

            for name, value in TO_TURN.items():
                exchange(write(REGISTERS[name], value))
            while True:
                exchange(read(XACTUAL))
                if 0 < exchange(read(XACTUAL)) < 1 << 31:
                    break
        assert not list(tmp_path.rglob("*.nbc")), "else it was compiled first"
        process.terminate()
        assert process.wait(30) == 0
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


@pytest.mark.parametrize(("model", "chip"), [("tmc428", ""), ("landungsbruecke", ""), ("landungsbruecke", "tmc5160")])
def test_it_compiles_what_its_model_needs_and_nothing_else(
    model: str, chip: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[object] = []
    monkeypatch.setattr("app.emulator_server.compiling.all_compiled", asked.append)
    jobs = serve_plain(model, chip)
    try:
        assert kernels.serves_plain()
        family = find_model(chip or ("tmc4361" if model == "landungsbruecke" else model)).family
        assert family in jobs
        assert "ramps" not in jobs
        assert asked == [jobs]
    finally:
        kernels.plain_meanwhile(on=False)


def test_nothing_runs_behind_it_where_all_is_on_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.emulator_server.compiling.all_compiled", lambda jobs: True)
    assert serve_plain("tmc5160") == {}
    assert not kernels.serves_plain()
    with compiled_behind({}):
        assert not kernels.serves_plain()
