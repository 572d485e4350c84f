"""The server's own token in a file: made once, for its owner alone."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from app.store.files import BadTokenFile, kept_token


def test_it_is_made_at_the_first_start_and_kept(tmp_path: Path) -> None:
    path = tmp_path / "data" / "token"
    assert kept_token(path, "first of all tokens") == "first of all tokens"
    assert kept_token(path, "another one") == "first of all tokens"
    if os.name == "posix":
        assert stat.S_IMODE(path.stat().st_mode) == 0o600


def test_what_cannot_be_kept_or_read_is_told_with_a_way_out(tmp_path: Path) -> None:
    (tmp_path / "file").write_text(" \n")
    with pytest.raises(BadTokenFile, match="has no token in it: delete it"):
        kept_token(tmp_path / "file", "new")
    with pytest.raises(BadTokenFile, match=r"cannot be kept in .*name another file: --token-file"):
        kept_token(tmp_path / "file" / "token", "new")
