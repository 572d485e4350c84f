"""The wheel in the newest Python of this machine that it is made for: installed, started, and a motor moved."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import httpx
import pytest

from tests.installation import ROOT, answers, install, move, server, until, wheel

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
VERSIONS = sorted(
    (3, int(found[1])) for one in PROJECT["classifiers"] if (found := re.fullmatch(r".*:: 3\.(\d+)", one))
)
NO_REGISTRY = re.compile("establish a new connection|name resolution|Network is unreachable|timed out", re.IGNORECASE)


def newest() -> str | None:
    """The interpreter of the newest version but this one's, on the path or as pyenv keeps them."""
    for version in reversed(VERSIONS):
        name = "python" + ".".join(map(str, version))
        kept = sorted(Path.home().glob(f".pyenv/versions/*/bin/{name}"))
        for found in (shutil.which(name), *map(str, kept)):
            # one of pyenv's own ends with an error where that version is not chosen
            if (
                found
                and subprocess.run([found, "-m", "venv", "--help"], capture_output=True, check=False).returncode == 0
            ):
                return None if version == sys.version_info[:2] else found
    return None


def test_what_the_wheel_says_it_runs_in_begins_with_what_it_requires() -> None:
    assert PROJECT["requires-python"] == f">=3.{VERSIONS[0][1]}"
    assert [minor for _, minor in VERSIONS] == list(range(VERSIONS[0][1], VERSIONS[-1][1] + 1))


@pytest.mark.slow
@pytest.mark.timeout(400)
def test_it_installs_starts_and_moves_a_motor(tmp_path: Path) -> None:
    python = newest()
    if python is None:
        pytest.skip("this machine has no newer Python than the one that runs the tests")
    try:
        install(wheel(tmp_path, page=False), tmp_path / "venv", python, "--no-compile", "--only-binary=:all:")
    except subprocess.CalledProcessError as error:
        if NO_REGISTRY.search(error.stderr or ""):
            pytest.skip("no registry can be reached")
        raise AssertionError(error.stderr) from error
    with server(tmp_path / "venv", tmp_path) as (url, _):
        until(lambda: answers(url), 120)
        with httpx.Client(base_url=f"{url}/api/v1/", timeout=30) as api:
            move(api)
