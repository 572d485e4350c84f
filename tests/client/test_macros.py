"""Macros from a terminal, and as a Python program that is run against the server."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from pathlib import Path

from app.client import AsyncBench


def steps(home: int) -> list[dict[str, object]]:
    """Some of each kind, which end at `home`; what is waited for lasts until it was seen."""
    return [
        {"do": "record start", "name": "mine", "channels": ["position.0"], "rate_hz": 100},
        {"do": "move", "target": 2000, "relative": True},
        {"do": "wait position", "at_most_s": 20},
        {"do": "rotate", "velocity": 500},
        {"do": "wait channel", "channel": "velocity.0", "when": "above", "value": 10, "at_most_s": 20},
        {"do": "stop"},
        {"do": "record stop"},
        {"do": "wait", "seconds": 0.05},
        {"do": "move", "target": home},
        {"do": "wait position", "at_most_s": 20},
    ]


async def program(server: str, *command: str) -> tuple[int, str]:
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        *command,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.STDOUT,
        stdin=asyncio.subprocess.DEVNULL,
        env={**os.environ, "STEPSCOPE_URL": server},
    )
    out, _ = await process.communicate()
    assert process.returncode is not None
    return process.returncode, out.decode()


async def test_a_macro_is_added_tried_and_run_and_its_python_does_the_same(server: str, tmp_path: Path) -> None:
    async with AsyncBench(server) as bench:
        began = (await bench.axis("bench", 0)).position
    made = steps(began)
    file = tmp_path / "mine.json"
    file.write_text(json.dumps({"format": "stepscope.macro", "version": 1, "name": "Mine", "steps": made}))
    cli = ("-m", "app.cli", "macro")
    code, out = await program(server, *cli, "add", str(file))
    assert (code, out) == (0, "mine, revision 1\n")
    code, out = await program(server, *cli, "run", "mine", "bench")
    assert code == 0, out
    assert "done in" in out
    async with AsyncBench(server) as bench:
        standing = await bench.call("GET", "/devices/bench/macro-run")
        assert [each["passed"] for each in standing["tried"]] == [True]
        assert len(standing["run"]["done"]) == len(made)
        before = len(await bench.recordings())
        code, text = await program(server, *cli, "python", "mine", "--device", "bench")
        assert code == 0
        script = tmp_path / "mine.py"
        script.write_text(text)
        code, out = await program(server, str(script))
        assert (code, out) == (0, "")
        assert (await bench.axis("bench", 0)).position == began
        assert len(await bench.recordings()) == before + 1
        assert (await bench.recordings())[0].name == "mine"
