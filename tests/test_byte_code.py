"""Where Python keeps byte code of an installation that nobody may write to."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import cache_from_source, find_spec
from pathlib import Path

import pytest

from app.byte_code import IMPORTED_LAST, PREFIX, compile_ahead, keep_byte_code

ROOT = Path(__file__).parents[1]


@pytest.fixture
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A module without byte code, under a Python that keeps it beside sources."""
    monkeypatch.setattr(sys, "pycache_prefix", None)
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    path = tmp_path / "package" / "module.py"
    path.parent.mkdir()
    path.write_text("")
    yield path
    os.environ.pop(PREFIX, None)


def test_without_byte_code_beside_it_the_users_cache_takes_it(source: Path, tmp_path: Path) -> None:
    folder = keep_byte_code(source, tmp_path / "cache")
    assert folder == tmp_path / "cache" / "byte-code"
    assert sys.pycache_prefix == str(folder)
    program = "import json.tool, sys; print(sys.pycache_prefix)"
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == str(folder), "processes that are started keep theirs there too"
    assert list(folder.rglob("tool.*.pyc")), "and find it at their next start"


def test_nothing_changes_where_it_is_beside_the_source(source: Path, tmp_path: Path) -> None:
    beside = Path(cache_from_source(str(source)))
    beside.parent.mkdir()
    beside.write_bytes(b"")
    assert keep_byte_code(source, tmp_path / "cache") is None
    assert sys.pycache_prefix is None


def test_nothing_changes_where_somebody_has_said_what_is_wanted(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    assert keep_byte_code(source, tmp_path / "cache") is None
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(sys, "pycache_prefix", "/elsewhere")
    assert keep_byte_code(source, tmp_path / "cache") is None
    assert not (tmp_path / "cache").exists()


def test_a_cache_that_cannot_be_made_keeps_nobody_from_starting(source: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert keep_byte_code(source, tmp_path / "file") is None
    assert sys.pycache_prefix is None


def test_a_second_process_makes_byte_code_ahead_where_this_one_will_look_for_it(source: Path, tmp_path: Path) -> None:
    working = compile_ahead([source.parent])
    assert working is not None
    working.join(60)
    assert Path(cache_from_source(str(source))).is_file()
    keep_byte_code(tmp_path / "elsewhere.py", tmp_path / "cache")
    working = compile_ahead([source.parent])
    assert working is not None
    working.join(60)
    kept = Path(cache_from_source(str(source)))
    assert kept.is_relative_to(tmp_path / "cache")
    assert kept.is_file()


def test_nothing_is_made_ahead_where_a_start_has_left_it_or_python_keeps_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.byte_code.cache_from_source", lambda source: __file__)
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    assert compile_ahead() is None
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    assert compile_ahead([ROOT]) is None


def test_what_is_made_ahead_is_there() -> None:
    library, *rooms = IMPORTED_LAST
    assert find_spec(library) is not None
    assert all((ROOT / "app" / room).is_dir() for room in rooms)
