"""The command line, as far as nothing has to run for it; `test_serving` starts processes."""

from __future__ import annotations

import gc
import json
import os
import socket
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app import __version__
from app.cli import cli
from app.main import create_app
from app.settings import Settings
from app.store.files import one_server


def test_the_version() -> None:
    assert CliRunner().invoke(cli, ["--version"]).output.strip() == f"stepscope {__version__}"


def test_the_schema_is_printed() -> None:
    printed = json.loads(CliRunner().invoke(cli, ["openapi"]).output)
    assert printed == json.loads(json.dumps(create_app(Settings()).openapi()))


def test_every_command_explains_itself() -> None:
    for command in ("serve", "emulate", "openapi"):
        result = CliRunner().invoke(cli, [command, "--help"])
        assert result.exit_code == 0
        assert "Usage" in result.output


def test_a_taken_port_is_told_and_what_to_do(tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        result = CliRunner().invoke(cli, ["serve", "--port", str(port), "--data-dir", str(tmp_path)])
    assert result.exit_code == 1
    assert f"port {port}" in result.output
    assert "--port" in result.output
    assert gc.isenabled(), "a start that is refused leaves the garbage collector as it was"


def test_a_directory_that_another_server_has_is_told_and_what_to_do(tmp_path: Path) -> None:
    with one_server(tmp_path, "http://127.0.0.1:8765"):
        result = CliRunner().invoke(cli, ["serve", "--port", "0", "--data-dir", str(tmp_path)])
    assert result.exit_code == 1
    for words in (str(tmp_path), "http://127.0.0.1:8765", f"process {os.getpid()}", "--data-dir"):
        assert words in result.output
    with one_server(tmp_path, "http://127.0.0.1:8766"):  # it is free again
        assert "8766" in (tmp_path / "server.lock").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["emulate", "tmc9999", "--tcp", "127.0.0.1:0"], "tmc9999"),
        (["emulate", "tmc428", "--tcp", "nowhere"], "HOST:PORT"),
        (["emulate", "tmc428", "--tcp", "127.0.0.1:0", "--clock-hz", "1e12"], "clock_hz"),
        (["serve", "--port", "99999"], "port"),
        (["serve"], "history_minutes"),
    ],
)
def test_what_cannot_be_served_is_told(monkeypatch: pytest.MonkeyPatch, arguments: list[str], words: str) -> None:
    monkeypatch.setenv("STEPSCOPE_HISTORY_MINUTES", "-1")
    result = CliRunner().invoke(cli, arguments)
    assert result.exit_code in (1, 2)
    assert words in result.output
    assert isinstance(result.exception, SystemExit), "told, not thrown"
