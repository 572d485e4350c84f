"""Profiles through the command line and the clients."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

from typer.testing import CliRunner, Result

from app.cli import cli
from app.client import AsyncBench


async def run(server: str, *arguments: str) -> Result:
    """`stepscope profile ARGUMENTS`, in a thread: the server's loop has to go on."""
    invoke = CliRunner(env={"STEPSCOPE_URL": server}).invoke
    return await asyncio.to_thread(invoke, cli, ["profile", *arguments])


def said(result: Result) -> str:
    assert result.exit_code == 0, result.output
    return result.stdout


async def test_a_session_of_keeping_comparing_and_bringing_back(server: str, tmp_path: Path) -> None:
    file = tmp_path / "before.json"
    said(await run(server, "capture", "bench", "--out", str(file), "--name", "before"))
    assert json.loads(file.read_text())["name"] == "before"
    assert json.loads(said(await run(server, "capture", "bench", "--json")))["tables"]["mslut"] is None
    kept = json.loads(said(await run(server, "save", "bench", "--name", "factory", "--note", "as it came", "--json")))
    assert "as it came" in said(await run(server, "list", "factory"))
    number = str(kept["id"])
    assert "v_max" in said(await run(server, "show", number))
    assert "no difference" in said(await run(server, "diff", "bench", str(file)))

    async with AsyncBench(server) as bench:
        await bench.write("bench", "v_max", 321, axis=2)
        different = await run(server, "diff", "bench", number)
        assert (different.exit_code, "321" in different.stdout, "pps" in different.stdout) == (1, True, True)
        assert "321" in said(await run(server, "apply", "bench", number, "--dry-run"))
        assert (await bench.read("bench", "v_max", 2)).value == 321
        assert "1 registers written" in said(await run(server, "apply", "bench", number))
        assert (await bench.read("bench", "v_max", 2)).value != 321
    assert "unchanged" in said(await run(server, "apply", "bench", str(file)))

    exported = tmp_path / "factory.json"
    said(await run(server, "export", number, "--out", str(exported)))
    again = json.loads(said(await run(server, "import", str(exported), "--name", "copy", "--json")))
    assert "no difference" in said(await run(server, "diff", number, str(again["id"])))
    assert "renamed" in said(await run(server, "edit", number, "--name", "renamed"))
    said(await run(server, "delete", number))
    assert [each["name"] for each in json.loads(said(await run(server, "list", "--json")))] == ["copy"]


async def test_the_program_of_a_module(server: str, tmp_path: Path) -> None:
    file = tmp_path / "module.json"
    async with AsyncBench(server) as bench:
        await bench.call("POST", "devices", {"name": "stored", "model": "pd42-1241", "link": {"kind": "emulator"}})
        await bench.call("PUT", "devices/stored/program", {"text": "MVP ABS, 0, 5000\nSTOP"})
        said(await run(server, "capture", "stored", "--out", str(file)))
        assert "MVP ABS, 0, 5000" in said(await run(server, "show", str(file)))
        await bench.call("PUT", "devices/stored/program", {"text": "MVP ABS, 0, 77\nSTOP"})
        different = await run(server, "diff", "stored", str(file))
        assert (different.exit_code, "program: 1 differ, of 2 commands and 2" in different.stdout) == (1, True)
        assert "MVP ABS, 0, 77" in different.stdout
        assert "a program of 2 commands stored" in said(await run(server, "apply", "stored", str(file)))
    assert "no difference" in said(await run(server, "diff", "stored", str(file)))


async def test_what_goes_wrong_is_a_line_and_a_code(server: str, tmp_path: Path) -> None:
    broken = tmp_path / "broken.json"
    broken.write_text("{")
    for arguments, code, words in (
        (("apply", "bench", str(tmp_path / "nowhere.json")), 2, "nowhere.json"),
        (("apply", "bench", str(broken)), 2, "Expecting"),
        (("apply", "bench", "77"), 1, "77"),
        (("delete", "77"), 1, "77"),
        (("capture", "nobody"), 1, "nobody"),
        (("way-back", "bench"), 1, "half applied"),
    ):
        result = await run(server, *arguments)
        assert (result.exit_code, words in result.output) == (code, True), result.output
