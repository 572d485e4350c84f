"""Profiles as scripts from a terminal and from the client."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

import pytest

from app.client import AsyncBench, Refused
from tests.client.test_profiles import run, said


async def test_a_script_of_a_kept_profile_and_of_a_file(server: str, tmp_path: Path) -> None:
    number = str(json.loads(said(await run(server, "save", "bench", "--name", "quiet", "--json")))["id"])
    header = tmp_path / "quiet.h"
    done = await run(server, "script", number, "--language", "c", "-o", str(header))
    assert said(done) == ""
    assert "tried on an emulated tmc428" in done.stderr
    assert "profile_quiet_apply" in header.read_text()

    file = tmp_path / "quiet.json"
    said(await run(server, "export", number, "--out", str(file)))
    printed = await run(server, "script", str(file), "--language", "c")
    assert said(printed) == header.read_text()
    whole = json.loads(said(await run(server, "script", number, "-l", "c", "--json")))
    assert (whole["file_name"], whole["checked"]["differences"]) == ("quiet.h", [])


async def test_a_language_that_a_chip_does_not_speak(server: str) -> None:
    async with AsyncBench(server) as bench:
        document = await bench.profile("slider")
        with pytest.raises(Refused, match="speaks no TMCL"):
            await bench.profile_script(document, "tmcl")
        script, again = await asyncio.gather(bench.profile_script(document, "c"), bench.profile_script(document, "c"))
        assert script == again
        assert "V_MAX" in script.text
