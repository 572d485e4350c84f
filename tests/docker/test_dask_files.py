"""The Dask cluster of `docker compose`, as far as no engine is needed; tests/studies/cluster.py starts its commands."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from app.settings import Settings

ROOT = Path(__file__).resolve().parents[2]
DOCKER = ROOT / "docker"
SERVICES: dict[str, dict[str, Any]] = yaml.safe_load((DOCKER / "dask.compose.yaml").read_text())["services"]


def test_its_dockerfile_is_linted() -> None:
    linter = str(Path(sys.executable).with_name("hadolint"))
    # DL3006: its base is the image that compose.yaml builds here, and has no version.
    command = [linter, "--ignore", "DL3006", str(DOCKER / "dask.Dockerfile")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_dashboard_is_told_where_the_scheduler_is_and_two_workers_too() -> None:
    address = SERVICES["dashboard"]["environment"]["STEPSCOPE_DASK"]
    assert Settings(dask=address).dask == address
    assert address in SERVICES["worker"]["command"]
    assert SERVICES["worker"]["deploy"]["replicas"] == 2
    assert address.rsplit(":")[-1] in SERVICES["scheduler"]["command"]


@pytest.mark.parametrize("name", ["scheduler", "worker"])
def test_a_service_may_do_no_more_than_it_has_to_and_nobody_outside_reaches_it(name: str) -> None:
    service = SERVICES[name]
    assert service["cap_drop"] == ["ALL"]
    assert "no-new-privileges:true" in service["security_opt"]
    assert service["read_only"] is True
    assert not {"ports", "privileged"} & service.keys()
    assert {"cpus", "mem_limit", "pids_limit"} <= service.keys()
    assert re.findall(r"^USER (\S+)", (DOCKER / "dask.Dockerfile").read_text(), re.MULTILINE)[-1] == "10001"


def test_its_packages_are_those_tested_by_hash_and_none_is_in_the_image_already() -> None:
    def pins(name: str) -> dict[str, int]:
        lines = (DOCKER / name).read_text().replace("\\\n", " ").splitlines()
        return {line.split()[0].lower(): line.count("--hash=sha256:") for line in lines if not line.startswith("#")}

    own = pins("dask-requirements.txt")
    tested = {line.lower().replace("_", "-") for line in (ROOT / "constraints.txt").read_text().splitlines()}
    assert own.keys() <= tested, "run `make lock`"
    assert all(own.values())
    assert not own.keys() & pins("requirements.txt").keys()
    assert {pin.split("==")[0] for pin in own} >= {"dask", "distributed"}
