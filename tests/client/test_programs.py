"""`stepscope tmcl`: programs as files, and in a module behind a server."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

from typer.testing import CliRunner, Result

from app.cli import cli
from tests.calc.tmcl_programs import HELLO, HELLO_BINARY, PY_TEST_BINARY, ROUTINES


def _invoke(*arguments: str, url: str = "") -> Result:
    return CliRunner(env={"STEPSCOPE_URL": url}).invoke(cli, ["tmcl", *arguments])


def test_text_to_binary_and_back(tmp_path: Path) -> None:
    source, binary, again = tmp_path / "hello.tmc", tmp_path / "hello.bin", tmp_path / "again.tmc"
    source.write_text(HELLO, encoding="utf-8")
    made = _invoke("assemble", str(source), "--out", str(binary), "--listing")
    assert made.exit_code == 0, made.output
    assert binary.read_bytes() == HELLO_BINARY
    assert "    2  01 00 00 00 00 00 32" in made.stdout
    assert _invoke("disassemble", str(binary), "--out", str(again)).exit_code == 0
    assert _invoke("assemble", str(again), "--out", str(binary)).exit_code == 0
    assert binary.read_bytes() == HELLO_BINARY
    binary.write_bytes(PY_TEST_BINARY)
    assert "VECT 3, L5" in _invoke("disassemble", str(binary)).stdout


def test_files_beside_the_program_are_included(tmp_path: Path) -> None:
    (tmp_path / "main.tmc").write_text(
        "#include speeds.tmc\n#include TMCLParam.tmc\nSAP APMaxAcceleration, Motor0, Fast\n"
    )
    (tmp_path / "speeds.tmc").write_text("Fast = 51200\n")
    made = _invoke("assemble", str(tmp_path / "main.tmc"), "--listing")
    assert "05 05 00 00 00 C8 00" in made.stdout


def test_mistakes(tmp_path: Path) -> None:
    source = tmp_path / "wrong.tmc"
    source.write_text("ROX 1\nJA Nowhere\n")
    made = _invoke("assemble", str(source))
    assert made.exit_code == 1
    assert f"{source}:1:1: no command is called ROX" in made.output
    assert f"{source}:2:4: nothing is called Nowhere" in made.output
    assert _invoke("assemble", str(tmp_path / "absent.tmc")).exit_code == 2
    damaged = tmp_path / "damaged.bin"
    damaged.write_bytes(HELLO_BINARY[:-1])
    assert "no multiple" in _invoke("disassemble", str(damaged)).output
    assert "known: " in _invoke("assemble", str(source), "--model", "other").output


async def test_a_program_in_a_module(server: str, tmp_path: Path) -> None:
    source = tmp_path / "routines.tmc"
    source.write_text(ROUTINES, encoding="utf-8")

    async def said(*arguments: str) -> str:
        done = await asyncio.to_thread(CliRunner(env={"STEPSCOPE_URL": server}).invoke, cli, list(arguments))
        assert done.exit_code == 0, done.output
        return done.stdout

    device = {"name": "module", "model": "pd42-1241", "link": {"kind": "emulator"}}
    await said("api", "POST", "devices", *(f"{key}={json.dumps(value)}" for key, value in device.items()))
    assert "16 commands stored and read back" in await said("tmcl", "download", "module", str(source))
    assert "running" in await said("tmcl", "run", "module", str(source), "--label", "func2")
    assert json.loads(await said("api", "GET", "devices/module/program/state"))["status"] == "running"
    await said("stop", "module")
    assert json.loads(await said("api", "GET", "devices/module/program/state"))["status"] == "stopped"
