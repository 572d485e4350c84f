"""Who may look into the data directory: its owner alone, also where an earlier version let others."""

from __future__ import annotations

import os
import sqlite3
from pathlib import Path

import pytest

from app.store.files import make_private
from tests.api.processes import address, running

pytestmark = pytest.mark.skipif(os.name != "posix", reason="rights as POSIX has them")


def mode(path: Path) -> int:
    return path.stat().st_mode & 0o777


def test_a_new_one_is_its_owner_s_alone(tmp_path: Path) -> None:
    data_dir = tmp_path / "new" / "data"
    assert make_private(data_dir) == []
    assert mode(data_dir) == 0o700
    assert make_private(data_dir) == []


def test_an_open_one_is_closed_and_that_is_told(tmp_path: Path) -> None:
    data_dir = tmp_path / "data"
    (data_dir / "recordings").mkdir(parents=True)
    for path in (data_dir, data_dir / "recordings"):
        path.chmod(0o755)
    for name in ("connections.json", "stepscope.sqlite3", "stepscope.sqlite3-wal", "tokens.json"):
        (data_dir / name).write_text("x")
        (data_dir / name).chmod(0o644)
    told = make_private(data_dir)
    assert mode(data_dir) == mode(data_dir / "recordings") == 0o700
    assert {mode(path) for path in data_dir.iterdir() if path.is_file()} == {0o600}
    assert "stepscope.sqlite3" in told[0]
    assert str(data_dir) in told[1]
    assert make_private(data_dir) == []


def test_a_directory_of_others_is_left_and_our_own_files_are_closed(tmp_path: Path) -> None:
    tmp_path.chmod(0o755)
    (tmp_path / "thesis.tex").write_text("x")
    (tmp_path / "thesis.tex").chmod(0o644)
    (tmp_path / "connections.json").write_text("{}")
    (tmp_path / "connections.json").chmod(0o644)
    outside = tmp_path / "thesis.tex"
    (tmp_path / "tokens.json").symlink_to(outside)
    told = make_private(tmp_path)
    assert (mode(tmp_path), mode(outside), mode(tmp_path / "connections.json")) == (0o755, 0o644, 0o600)
    assert "other things too" in told[-1]


def test_what_the_server_writes_is_its_owner_s_alone(tmp_path: Path) -> None:
    data_dir = tmp_path / "data"
    data_dir.mkdir(mode=0o755)
    with sqlite3.connect(data_dir / "stepscope.sqlite3") as file:
        file.execute("PRAGMA user_version")
    file.close()
    with running("serve", "--port", "0", "--no-demo", "--data-dir", str(data_dir)) as (_, line):
        address(line)
        assert mode(data_dir) == 0o700
        assert {mode(path) for path in data_dir.iterdir() if path.is_file()} == {0o600}
