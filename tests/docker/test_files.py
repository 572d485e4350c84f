"""The demo of `docker compose`, as far as no engine is needed: what the files say, and that the image can be made."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

from app.cli import cli
from app.registers.catalog import MODELS

ROOT = Path(__file__).resolve().parents[2]
DOCKER = ROOT / "docker"
COMPOSE: dict[str, Any] = yaml.safe_load((DOCKER / "compose.yaml").read_text())
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]
BENCH: list[dict[str, Any]] = json.loads((DOCKER / "bench.json").read_text())
FAMILIES = {"tmc428", "tmc4210", "tmc4361", "tmc5160", "pd42-1241"}


def test_the_dockerfile_is_linted() -> None:
    linter = str(Path(sys.executable).with_name("hadolint"))
    done = subprocess.run([linter, str(DOCKER / "Dockerfile")], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_everything_that_the_image_copies_is_there_and_not_ignored() -> None:
    ignored = (ROOT / ".dockerignore").read_text().split()
    for line in (DOCKER / "Dockerfile").read_text().splitlines():
        if line.startswith("COPY ") and "--from" not in line:
            for source in line.split()[1:-1]:
                assert (ROOT / source).exists(), source
                assert f"!{source.split('/')[0]}" in ignored, f"{source} never reaches the engine"


def test_three_services_of_one_image_that_nobody_outside_this_machine_reaches() -> None:
    assert set(SERVICES) == {"emulators", "dashboard", "session"}
    assert {service["image"] for service in SERVICES.values()} == {"stepscope"}
    ports = [port for service in SERVICES.values() for port in service.get("ports", [])]
    assert ports == ["127.0.0.1:8000:8000"]


@pytest.mark.parametrize("name", list(SERVICES))
def test_a_service_may_do_no_more_than_it_has_to(name: str) -> None:
    service = SERVICES[name]
    assert service["cap_drop"] == ["ALL"]
    assert "no-new-privileges:true" in service["security_opt"]
    assert service["read_only"] is True
    assert "privileged" not in service
    users = re.findall(r"^USER (\S+)", (DOCKER / "Dockerfile").read_text(), re.MULTILINE)
    assert users[-1] not in ("root", "0")


def test_each_waits_until_what_it_needs_is_well() -> None:
    assert SERVICES["dashboard"]["depends_on"] == {"emulators": {"condition": "service_healthy"}}
    assert SERVICES["session"]["depends_on"] == {"dashboard": {"condition": "service_healthy"}}
    assert SERVICES["emulators"]["healthcheck"]["test"][0] == "CMD"
    assert "healthcheck" not in SERVICES["dashboard"], "the image's own, which follows port and TLS"
    assert "healthy.py" in (DOCKER / "Dockerfile").read_text()


@pytest.mark.parametrize("name", list(SERVICES))
def test_a_service_takes_no_more_than_its_share(name: str) -> None:
    assert {"cpus", "mem_limit", "pids_limit"} <= SERVICES[name].keys()


def test_nothing_has_a_default_secret_or_a_volume_without_a_name() -> None:
    assert "VOLUME" not in (DOCKER / "Dockerfile").read_text()
    for service in SERVICES.values():
        assert service.get("environment", {}).get("STEPSCOPE_TOKEN") is None, "as it is set outside, or made"


def test_the_image_installs_what_was_tested_by_hash_for_both_architectures() -> None:
    lines = (DOCKER / "requirements.txt").read_text().replace("\\\n", " ").splitlines()
    pinned = {line.split()[0].lower(): line.count("--hash=sha256:") for line in lines if not line.startswith("#")}
    tested = {line.lower().replace("_", "-") for line in (ROOT / "constraints.txt").read_text().splitlines()}
    assert pinned.keys() <= tested, "run `make lock`"
    assert {pinned[name] for name in pinned if name.startswith(("pyarrow=", "numba="))} == {2}, "a file for each"
    assert all(pinned.values())
    wanted = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    names = {re.split("[>=<;\\[ ]", one)[0].lower() for one in wanted}
    assert names <= {pin.split("==")[0] for pin in pinned}, "run `make lock`"


def test_pictures_which_the_image_leaves_out_are_not_needed_to_draw() -> None:
    code = "import sys; sys.modules['PIL'] = sys.modules['imageio'] = None; import app.twin.child, viser"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_every_volume_is_declared_and_no_device_is_left_without_a_port() -> None:
    mounted = {volume.split(":")[0] for service in SERVICES.values() for volume in service.get("volumes", [])}
    assert mounted == set(COMPOSE["volumes"])
    assert [str(device["port"]) for device in BENCH] == SERVICES["emulators"]["expose"]
    assert len({device["port"] for device in BENCH}) == len(BENCH)


def test_every_family_is_on_the_bench() -> None:
    assert {device["model"] for device in BENCH} == FAMILIES
    assert set(MODELS) >= FAMILIES
    assert len({device["name"] for device in BENCH}) == len(BENCH)


def test_the_dashboard_is_started_with_options_that_there_are() -> None:
    options = {option for option in SERVICES["dashboard"]["command"] if option.startswith("--")}
    command = next(command for command in cli.registered_commands if command.callback.__name__ == "serve")  # type: ignore[union-attr]
    names = set(command.callback.__annotations__)
    assert {option.removeprefix("--no-").removeprefix("--").replace("-", "_") for option in options} <= names
