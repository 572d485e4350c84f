"""What the image starts once: byte code of what a start imports is there for containers that may not write it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.docker.test_files import DOCKER


@pytest.mark.slow
@pytest.mark.timeout(200)
def test_a_start_leaves_the_byte_code_of_its_database_too(tmp_path: Path) -> None:
    mine = {"PYTHONPYCACHEPREFIX", "PYTHONDONTWRITEBYTECODE"}
    environment = {name: value for name, value in os.environ.items() if name not in mine}
    done = subprocess.run(
        [sys.executable, str(DOCKER / "started.py")],
        env={**environment, "PYTHONPYCACHEPREFIX": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    left = {path.parent.name + "/" + path.name.split(".")[0] for path in tmp_path.rglob("*.pyc")}
    assert {"store/database_file", "orm/session", "alembic/op", "http/page"} <= left
    assert "started.py" in (DOCKER / "Dockerfile").read_text().split("RUN ")[-2], "behind what it has to leave out"
