"""What the image installs over its base: the lines of docker/Dockerfile that make it, run in a folder of their own."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from tests.bench.table import Row
from tests.installation import ROOT, wheel

LIMIT_MB = 450.0
DOCKERFILE = ROOT / "docker" / "Dockerfile"
STAGE = re.compile(r"^FROM (\S+) AS packages\n(.*?)^FROM ", re.DOTALL | re.MULTILINE)


def measure(quick: bool) -> Sequence[Row]:
    """Some minutes: everything is fetched, and all kernels are compiled. `quick` leaves it out."""
    version, steps = lines()
    python = interpreter(version)
    if quick or python is None:
        return []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        built = wheel(folder / "wheels")
        instead = {
            "/opt/stepscope": str(folder / "stepscope"),
            "/wheels/*.whl": str(built),
            "/tmp/": f"{ROOT / 'docker'}/",
            "pip --python": f"{sys.executable} -m pip --python",
        }
        environment = {**os.environ, "NUMBA_CPU_NAME": "generic"}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        environment["PATH"] = f"{aside(folder, python)}{os.pathsep}{environment['PATH']}"
        for step in steps:
            here = re.sub("|".join(map(re.escape, instead)), lambda found: instead[found[0]], step)
            subprocess.run(["bash", "-ec", here], env=environment, cwd=folder, check=True, stdout=sys.stderr)
        files = [path for path in (folder / "stepscope").rglob("*") if path.is_file() and not path.is_symlink()]
        megabytes = sum(path.stat().st_size for path in files) / 1e6
    return [
        Row(
            what="what the image installs over its base",
            measured=f"{megabytes:.1f} MB",
            peer=f"{len(files)} files",
            ratio=LIMIT_MB / megabytes,
            required=f"< {LIMIT_MB:g} MB",
            ok=megabytes < LIMIT_MB,
        )
    ]


def lines() -> tuple[str, list[str]]:
    """The version of Python, and what the stage runs behind what it has from Debian."""
    found = STAGE.search(DOCKERFILE.read_text().replace("\\\n", " "))
    assert found is not None
    version = re.search(r"python:(3\.\d+)", found[1])
    assert version is not None
    steps = [line.removeprefix("RUN ") for line in found[2].splitlines() if line.startswith("RUN ")]
    return version[1], [step for step in steps if "apt-get" not in step]


def interpreter(version: str) -> str | None:
    """That Python of this machine, on the path or as pyenv keeps it."""
    kept = sorted(Path.home().glob(f".pyenv/versions/{version}.*/bin/python{version}"))
    return str(kept[-1]) if kept else shutil.which(f"python{version}")


def aside(folder: Path, python: str) -> Path:
    """A folder for the path in which it is called `python`."""
    (folder / "bin").mkdir()
    program = folder / "bin" / "python"
    program.write_text(f'#!/bin/sh\nexec {python} "$@"\n')
    program.chmod(0o755)
    return folder / "bin"
