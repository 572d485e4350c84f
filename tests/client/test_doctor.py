"""`stepscope doctor`: each thing that can be wrong is made wrong, and told with what helps."""

from __future__ import annotations

import json
import os
import socket
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli import cli
from app.commands import diagnosis

FREE_PORT = "0"


def findings(*options: str, code: int = 0) -> dict[str, dict[str, str]]:
    told = CliRunner().invoke(cli, ["doctor", "--json", "--port", FREE_PORT, *options])
    assert told.exit_code == code, told.output
    return {each["what"]: each for each in json.loads(told.stdout)}


@pytest.fixture(autouse=True)
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    web = tmp_path / "web"
    web.mkdir()
    (web / "index.html").write_text("<!doctype html>")
    monkeypatch.setenv("STEPSCOPE_WEB_DIR", str(web))
    monkeypatch.setattr(diagnosis, "_devices", lambda what, *_: iter([diagnosis.Finding(what, "well", "as it may be")]))
    return web


def test_a_machine_on_which_all_is_well(tmp_path: Path) -> None:
    found = findings("--data-dir", str(tmp_path / "data"))
    assert {
        found[what]["state"] for what in ("version", "packages", "page", "data directory", "compiled parts", "address")
    } == {"well"}
    assert not (tmp_path / "data").exists(), "it only looks"


def test_packages_that_are_missing_too_old_or_broken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def installed(name: str, version: str, *needs: str) -> None:
        folder = tmp_path / f"{name}-{version}.dist-info"
        folder.mkdir()
        lines = ["Metadata-Version: 2.1", f"Name: {name}", f"Version: {version}"]
        (folder / "METADATA").write_text("\n".join([*lines, *(f"Requires-Dist: {one}" for one in needs)]))

    installed("stepscope", "0.1.0", "numba>=0.63", "nothing-like-it>=1", "no-bus>=4; extra == 'can'", "typer>=0.15")
    installed("numba", "0.55.1")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(sys.modules, "serial.tools", None)
    found = findings("--data-dir", str(tmp_path / "data"), code=1)
    told = "numba 0.55.1 is installed, >=0.63 is needed; nothing-like-it is missing"
    assert (found["packages"]["state"], found["packages"]["detail"]) == ("wrong", told)
    assert "pip install --upgrade stepscope" in found["packages"]["remedy"]
    assert found["serial lines"]["state"] == "wrong"
    assert found["data directory"]["state"] == "well", "what does not need it is told all the same"


def test_a_page_that_is_missing(page: Path, tmp_path: Path) -> None:
    (page / "index.html").unlink()
    found = findings("--data-dir", str(tmp_path), code=1)
    assert found["page"]["state"] == "wrong"
    assert "make web" in found["page"]["remedy"]


def test_a_directory_that_is_none(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    found = findings("--data-dir", str(tmp_path / "file" / "data"), code=1)
    assert "cannot be written" in found["data directory"]["detail"]
    assert "--data-dir" in found["data directory"]["remedy"]


def test_a_port_that_is_taken(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        found = findings("--data-dir", str(tmp_path), "--port", str(port))
    assert f"port {port} of 127.0.0.1 is taken" in found["address"]["detail"]


def test_devices_that_may_not_be_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    opened, closed = tmp_path / "tty0", tmp_path / "tty1"
    opened.touch()
    monkeypatch.setattr(os, "access", lambda name, _: name == str(opened))
    wrong, well = diagnosis._devices("serial ports", [str(opened), str(closed)], "dialout", "plug it in")
    assert (wrong.state, well.state) == ("wrong", "well")
    assert "usermod -aG dialout" in wrong.remedy
    (none,) = diagnosis._devices("serial ports", [], "dialout", "plug it in")
    assert (none.state, none.remedy) == ("note", "plug it in")


def test_what_is_for_people_says_the_same(tmp_path: Path) -> None:
    told = CliRunner().invoke(cli, ["doctor", "--port", FREE_PORT, "--data-dir", str(tmp_path)])
    assert told.exit_code == 0
    assert "ok  version: stepscope" in told.stdout
