from __future__ import annotations

import json

from typer.testing import CliRunner

from app import __version__
from app.cli import cli
from app.main import create_app
from app.settings import Settings


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
