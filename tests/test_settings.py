"""Flags win over variables, variables over defaults."""

from __future__ import annotations

from pathlib import Path

import pytest
from pydantic import ValidationError

from app.settings import Settings


def test_the_defaults_listen_on_this_machine_only() -> None:
    settings = Settings()
    assert (settings.host, settings.port, settings.demo) == ("127.0.0.1", 8000, None)
    assert settings.data_dir.name == "stepscope"


def test_variables_win_over_defaults_and_arguments_over_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STEPSCOPE_PORT", "8001")
    monkeypatch.setenv("STEPSCOPE_DATA_DIR", "/somewhere")
    monkeypatch.setenv("STEPSCOPE_DEMO", "false")
    assert Settings().port == 8001
    assert Settings().data_dir == Path("/somewhere")
    assert Settings().demo is False
    assert Settings(port=8002).port == 8002


@pytest.mark.parametrize(("name", "value"), [("PORT", "65536"), ("PORT", "x"), ("HISTORY_MINUTES", "0")])
def test_what_cannot_be_is_refused(monkeypatch: pytest.MonkeyPatch, name: str, value: str) -> None:
    monkeypatch.setenv(f"STEPSCOPE_{name}", value)
    with pytest.raises(ValidationError, match=name.lower()):
        Settings()
