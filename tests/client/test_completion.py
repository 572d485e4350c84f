"""Shell completion as a shell asks for it: a process of its own that is told the words so far."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = Path(sys.executable).with_name("stepscope")


async def completed(server: str, line: str) -> list[str]:
    """What Tab offers behind `line`."""
    words = line.split(" ")
    environment = {
        **os.environ,
        "STEPSCOPE_URL": server,
        "_STEPSCOPE_COMPLETE": "complete_bash",
        "COMP_WORDS": line,
        "COMP_CWORD": str(len(words) - 1),
    }
    for _ in range(5):  # a server that takes longer than half a second to answer offers nothing: Tab is pressed again
        done = await asyncio.to_thread(
            subprocess.run, [PROGRAM], env=environment, capture_output=True, text=True, check=False, timeout=60
        )
        assert not done.stderr
        if done.stdout:
            break
    return done.stdout.split()


async def test_commands_and_devices(server: str) -> None:
    assert await completed(server, "stepscope re") == ["read", "record", "recordings", "replay"]
    assert await completed(server, "stepscope axis ") == ["bench", "slider"]
    assert await completed(server, "stepscope move be") == ["bench"]


async def test_registers_and_fields_of_the_device(server: str) -> None:
    assert await completed(server, "stepscope read bench v_m") == ["v_min", "v_max"]
    assert "x_actual" in await completed(server, "stepscope read bench v_min x")
    assert "v_max=" in await completed(server, "stepscope write bench v_")


async def test_channels_once_each(server: str) -> None:
    assert "position.0" in await completed(server, "stepscope watch bench pos")
    assert "position.0" not in await completed(server, "stepscope watch bench position.0 pos")


async def test_without_a_server_nothing_is_offered() -> None:
    assert await completed("http://127.0.0.1:1", "stepscope read bench v") == []


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_for_a_shell(shell: str) -> None:
    environment = {**os.environ, "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    done = subprocess.run(
        [PROGRAM, "--show-completion", shell], env=environment, capture_output=True, text=True, check=True, timeout=60
    )
    assert "_STEPSCOPE_COMPLETE" in done.stdout
