"""How-to pages of the help: each command in them runs, in the order of the text, in an empty folder."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from server_process import free_port

from tests.e2e.tutorials import DOCS, steps_of

PAGES = ("back-up", "on-a-network")
WITHIN_S = 180


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    """Where a reader stands; a server that the page has started ends with it."""
    yield tmp_path
    with suppress(OSError, ValueError):
        os.kill(int((tmp_path / "server.pid").read_text()), signal.SIGKILL)


@pytest.mark.parametrize("page", PAGES)
def test_its_commands_run(folder: Path, page: str) -> None:
    commands = [step.words[1] for step in steps_of((DOCS / "how" / f"{page}.md").read_text()) if step.is_code]
    assert len(commands) > 2
    data = folder / "data"
    data.mkdir()
    (data / "connections.json").write_text('{"format": "stepscope-connections", "version": 1, "connections": []}')
    (data / "server.lock").write_text("")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("STEPSCOPE_")} | {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "HOME": str(folder),
        "STEPSCOPE_DATA_DIR": str(data),
        "PORT": str(free_port()),
    }
    # All in one shell: what one block sets, the next one has.
    done = subprocess.run(
        ["bash", "-e", "-u", "-o", "pipefail", "-c", "\n".join(commands)],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=WITHIN_S,
        check=False,
    )
    log = folder / "server.log"
    assert done.returncode == 0, f"{done.stdout}{done.stderr}{log.read_text() if log.exists() else ''}"
    if page == "back-up":
        assert (folder / "moved" / "connections.json").is_file()
        assert "server.lock" not in done.stdout.split("stepscope", 1)[0]
