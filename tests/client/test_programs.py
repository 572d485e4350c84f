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


COUNTING = """\
Loop:
  CALC ADD, 1
  AGP 0, 2
  COMP 5
  JC LT, Loop
  CSUB Double
  STOP
Double:
  CALC MUL, 2
  AGP 1, 2
  RSUB
"""


async def test_a_program_is_tried_debugged_and_looked_at(server: str, tmp_path: Path) -> None:
    source, trace = tmp_path / "counting.tmc", tmp_path / "trace.csv"
    source.write_text(COUNTING, encoding="utf-8")

    async def ran(*arguments: str) -> Result:
        done = await asyncio.to_thread(CliRunner(env={"STEPSCOPE_URL": server}).invoke, cli, list(arguments))
        assert isinstance(done.exception, SystemExit | None), done.exception
        return done

    async def said(*arguments: str) -> str:
        done = await ran(*arguments)
        assert done.exit_code == 0, done.output
        return done.stdout

    device = {"name": "debugged", "model": "pd42-1241", "link": {"kind": "emulator"}}
    await said("api", "POST", "devices", *(f"{key}={json.dumps(value)}" for key, value in device.items()))

    tried = await said("tmcl", "try", "debugged", str(source), "--out", str(trace), "--seconds", "1")
    assert "it stopped by itself" in tried
    assert "accumulator 10" in tried
    assert "variable 1: 10" in tried
    head, *rows = trace.read_text(encoding="utf-8").splitlines()
    assert head == "time_s,position,velocity_pps,counters"
    assert rows
    assert "accumulator 0," in await said("tmcl", "try", "debugged", str(source), "--label", "double")
    assert "no label nowhere" in (await ran("tmcl", "try", "debugged", str(source), "--label", "nowhere")).output
    assert "not both" in (await ran("tmcl", "try", "debugged", str(source), "--label", "x", "--address", "1")).output

    halted = await said("tmcl", "debug", "debugged", str(source), "--break", "double", "-v", "0", "-v", "1")
    assert "halted at 6, a breakpoint" in halted
    assert "at address 6: CALC MUL, 2" in halted
    assert "accumulator 5," in halted
    assert "variable 0: 5" in halted
    assert "at 5, after 3 steps" in await said("tmcl", "debug", "debugged", "--mode", "out")
    state = json.loads(await said("tmcl", "state", "debugged", "--variable", "1", "--json"))
    assert (state["counter"], state["accumulator"], state["variables"]) == (5, 10, {"1": 10})
    assert "at address 5: STOP" in await said("tmcl", "state", "debugged")
    ended = json.loads(await said("tmcl", "debug", "debugged", "--json"))
    assert ended["debug"]["message"] == "the program ended at 5"

    source.write_text("Loop: JA Loop", encoding="utf-8")
    endless = await ran("tmcl", "debug", "debugged", str(source), "--timeout", "0.3")
    assert endless.exit_code == 5
    assert "paused at 0" in endless.stdout
    assert "the program has no label" in (await ran("tmcl", "debug", "debugged", "-b", "Loop")).output


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
    stretch = await said("tmcl", "read", "module", "--address", "1", "--count", "3")
    assert [line.split() for line in stretch.splitlines()] == [["JA", "8"], ["JA", "12"], ["MVP", "ABS,", "0,", "1000"]]
    source.write_text("STOP\nfunc2: JA func2\n", encoding="utf-8")  # runs until it is stopped, however slow we are
    assert "running" in await said("tmcl", "run", "module", str(source), "--label", "func2")
    assert json.loads(await said("api", "GET", "devices/module/program/state"))["status"] == "running"
    await said("stop", "module")
    assert json.loads(await said("api", "GET", "devices/module/program/state"))["status"] == "stopped"
